"""The figures of the first whole pass as a result file."""

from dataclasses import dataclass
from typing import Any

from sklearn.metrics import roc_auc_score

from analysis.evaluation_folder import read_evaluation
from analysis.lift_rates import lift_rate
from analysis.training_metrics import read_training_metrics
from preshape.data.tables import read_data_set
from preshape.data.trial import Face
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError
from preshape.files import write_json
from preshape.grasps.space import GraspSpace
from preshape.provenance import provenance

PARTS = ("scene", "planning", "physics", "rendering")
"""Parts of a trial's time; each has its column."""


@dataclass(frozen=True, eq=False)
class FirstPass:
    """What was collected, learned and planned.

    Args:
        data: folder of the trials that the network learned from.
        metrics: `metrics.json` of its training.
        evaluation: folder of the planners' comparison.
        output: the result file.
        space: what theta means.
    """

    data: str
    metrics: str | None
    evaluation: str
    output: str
    space: GraspSpace

    def write(self) -> str:
        """Write the result file and say what came out.

        Raises:
            InputError: if one of the inputs cannot be used, or the file cannot be written.
        """
        if self.metrics is None:
            raise InputError(
                "The first pass has no training", where="report.metrics=null", fix="give its metrics.json"
            )
        trials = read_data_set(self.data, self.space)[1]
        auc = read_training_metrics(self.metrics)
        evaluation = read_evaluation(self.evaluation, self.space)
        content: dict[str, Any] = {
            **provenance(int(evaluation.summary["seed"])),
            "trials": len(trials),
            **lift_rate(trials).to_dict(),
            "faces": {face.value: lift_rate(of_face(trials, face)).to_dict() for face in Face},
            "auc_of_grasp_type": auc_of_grasp_type(trials),
            "auc": {**auc["auc"], "n": auc["n"], "positives": auc["positives"]},
            "evaluation_scenes": len(evaluation.scenes),
            "planners": evaluation.planners,
            "seconds_per_trial": seconds_per_trial(trials),
        }
        write_json(self.output, content)
        value = auc["auc"]["value"]
        known = "not defined" if value is None else f"{value:.2f}"
        return f"AUC {known}; lifted: {evaluation.lifted}. Result file: {self.output}"


def of_face(trials: TrialTable, face: Face) -> TrialTable:
    """The trials that aimed at one face."""
    return trials.where((trials.rows["face"] == face.value).to_numpy(dtype=bool))


def auc_of_grasp_type(trials: TrialTable) -> float:
    """AUC of knowing only overhead or side: the least that a network has to beat. NaN for one class."""
    executed = trials.executed
    if executed.lifted.all() or not executed.lifted.any():
        return float("nan")
    from_side = (executed.rows["face"] != Face.TOP.value).to_numpy(dtype=bool)
    return float(roc_auc_score(executed.lifted, from_side))


def seconds_per_trial(trials: TrialTable) -> dict[str, float]:
    """Mean wall-clock seconds of the parts of an executed trial."""
    return {part: float(trials.executed.rows[f"{part}_s"].mean()) for part in PARTS}
