"""The figures of a collection in one result file: how much, how fast, how sure."""

from dataclasses import dataclass
from typing import Any

from preshape.errors import InputError
from preshape.evaluation.measured_files import read_figures
from preshape.files import write_json
from preshape.provenance import provenance

ABOUT_TRIALS = ("objects", "scenes", "planned", "executed", "lifted", "rate", "low", "high", "seconds")
"""What is taken over from the figures of the data set; `seconds` are those of one core per executed trial."""


@dataclass(frozen=True)
class CollectionFigures:
    """What a collection holds, and what was measured about it.

    Args:
        dataset: result file of `report=dataset`.
        effort: result file of a collection that ran undisturbed, `sim/collect.py`.
        crash_test: result file of `sim/crash_test.py`.
        sensitivity: result file of `sim/sensitivity.py`.
        label_check: result file of `sim/last_frames.py`.
        output: the result file.
    """

    dataset: str
    effort: str
    crash_test: str
    sensitivity: str
    label_check: str
    output: str

    def write(self) -> str:
        """Write the result file and say what came out.

        Raises:
            InputError: if an input cannot be used, is about other trials, or the file cannot be written.
        """
        dataset = read_figures(self.dataset, "data", "seed", *ABOUT_TRIALS)
        effort = read_figures(self.effort, "executed", "seconds", "workers", "executed_per_hour")
        crashes = read_figures(self.crash_test, "kills", "tables", "differing_rows")
        sensitivity = read_figures(self.sensitivity, "data", "variants")
        check = read_figures(self.label_check, "data", "n", "disagreements")
        for path, about in ((self.sensitivity, sensitivity["data"]), (self.label_check, check["data"])):
            if about != dataset["data"]:
                raise InputError("The figures are about another table", where=path, fix="make them again")
        repeated, early = (sensitivity["variants"][name] for name in ("unchanged", "no_early_stop"))
        figures: dict[str, Any] = {
            "data": dataset["data"],
            **{name: dataset[name] for name in ABOUT_TRIALS},
            "speed": effort,
            "repeated_with_the_same_seed": repeated["n"],
            "flips_under_repeated_seeds": repeated["flips"],
            "repeated_without_early_stop": early["n"],
            "flips_without_early_stop": early["flips"],
            "kill_tests": crashes["kills"],
            "differing_rows_after_kills": crashes["differing_rows"],
            "labels_looked_at": check["n"],
            "label_disagreements": check["disagreements"],
        }
        write_json(self.output, provenance(int(dataset["seed"])) | figures)
        return (
            f"{figures['executed']} executed, {figures['lifted']} lifted, "
            f"{effort['executed_per_hour']:.0f} an hour with {effort['workers']} workers: {self.output}"
        )
