"""The report of a data set: result file, charts, and sections of the data card and the results page."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from analysis.chart_files import save_chart
from analysis.dataset import charts, tables
from analysis.dataset.grasps import grasp_frame, read_families
from analysis.dataset.rates import rates_by
from analysis.dataset.summary import summary
from analysis.results_page import put_section
from analysis.wording import plain_name
from preshape.data.tables import data_hash, read_data_set
from preshape.data.trial import GraspType
from preshape.evaluation.measured_files import read_figures
from preshape.files import write_json
from preshape.grasps.space import GraspSpace
from preshape.provenance import git_revision, lasting_command, provenance

PALM_AXES = {
    "centre_x_m": "object before the palm (m)",
    "centre_y_m": "object to the thumb's side (m)",
    "centre_z_m": "object along the fingers (m)",
    "shift_m": "palm shifted (m)",
    "tilt_rad": "palm tilted (rad)",
}
PICTURES = {
    "objects": "Lift rate of each object by shape family, with 95 % Wilson intervals",
    "families": "Lift rate of each shape family, overhead and side grasps apart",
    "outcomes": "Outcomes of the planned grasps by planner and face",
    "preshape": "Lift rate over the joints of the preshape",
    "palm": "Lift rate over the object's place before the palm, and over how far explored palms stray",
    "table": "Shares of executed and of lifted grasps over the object's place on the table",
    "durations": "How long the physics of a trial takes",
}

LABEL_CHECK = ("n", "seed", "disagreements", "how", "git_revision", "repeated_differently")
SENSITIVITY = ("command", "git_revision", "seed", "variants")
"""What the report takes from the result files."""


@dataclass(frozen=True, eq=False)
class DatasetReport:
    """The report of a data set.

    Args:
        data: folder with its tables.
        families: CSV table with the columns `name` and `family` of its objects; None for none.
        sensitivity: result file of `sim/sensitivity.py`; None leaves it out.
        label_check: result file of `sim/last_frames.py`; None leaves it out.
        output: the result file.
        card: data card, a Markdown page whose sections are replaced; pictures lie in `pictures` beside it.
        page: results page, where a summary is put.
        seed: seed of the collection, for the result file.
        space: what theta means.
    """

    data: str
    families: str | None
    sensitivity: str | None
    label_check: str | None
    output: str
    card: str
    page: str
    seed: int
    space: GraspSpace

    def write(self) -> str:
        """Write everything and say what came out.

        Raises:
            InputError: if an input cannot be used, or a file cannot be written.
        """
        scenes, trials = read_data_set(self.data, self.space)
        grasps = grasp_frame(scenes, trials, read_families(self.families))
        check = None if self.label_check is None else read_figures(self.label_check, *LABEL_CHECK)
        flips = None if self.sensitivity is None else read_figures(self.sensitivity, *SENSITIVITY)
        figures = {"data": data_hash(self.data), **summary(grasps)}
        if check is not None:
            figures["label_check"] = {key: check[key] for key in ("n", "seed", "disagreements", "how")}
            put_section(Path(self.card), "label_check", "\n".join(_label_check(check)))
        write_json(self.output, provenance(self.seed) | figures)
        pictures = Path(self.card).parent / "pictures"
        for name, figure in self._figures(grasps).items():
            save_chart(figure, pictures / f"dataset_{name}.png")
        put_section(Path(self.card), "balance", "\n".join(self._balance(figures)))
        if flips is not None:
            put_section(Path(self.card), "sensitivity", "\n".join(_sensitivity(flips)))
        put_section(Path(self.page), "dataset", "\n".join(self._summary(figures)))
        lifted, executed = figures["lifted"], figures["executed"]
        return f"Lifted {lifted} of {executed} executed trials. Card: {self.card}, figures: {self.output}"

    def _figures(self, grasps: pd.DataFrame) -> dict[str, Figure]:
        objects = [(str(name), rates_by(own, "object_id")) for name, own in grasps.groupby("family")]
        types = [
            (f"{kind.value} grasps", rates_by(grasps[grasps["grasp_type"] == kind.value], "family"))
            for kind in GraspType
        ]
        joints = {name: f"{plain_name(name)} (rad)" for name in self.space.joint_names}
        moving = {name: text for name, text in joints.items() if grasps[name].nunique() > 1}
        drawn = (
            charts.rate_rows(charts.in_columns(objects, 2), width_in=11),
            charts.rate_rows([[group] for group in types], width_in=9),
            charts.outcome_bars(grasps, ["planner", "face"]),
            charts.rates_over(grasps, moving, across=4),
            charts.rates_over(grasps, PALM_AXES, across=3),
            charts.table_maps(grasps),
            charts.duration_histogram(grasps),
        )
        return dict(zip(PICTURES, drawn, strict=True))

    def _balance(self, figures: Mapping[str, Any]) -> list[str]:
        parts = [
            _made_by(),
            tables.counts_lines(figures),
            tables.rate_lines(["planner", "face"], figures["planners_and_faces"]),
            [_picture("outcomes")],
            tables.one_sided_lines(figures),
            [_picture("objects")],
            [_picture("families")],
            ["Preshape joints that are the same in all trials are left out."],
            [_picture("preshape")],
            [_picture("palm")],
            [_picture("table")],
            tables.seconds_lines(figures),
            [_picture("durations")],
        ]
        return _joined(parts)

    def _summary(self, figures: Mapping[str, Any]) -> list[str]:
        card = Path(self.card).name
        parts = [
            ["## The data set"],
            _made_by(),
            tables.counts_lines(figures),
            tables.rate_lines(["planner"], figures["planners"]),
            tables.rate_lines(["face"], figures["faces"]),
            [f"Balance, sensitivity of the labels and limits: [data card]({card})."],
        ]
        return _joined(parts)


def _made_by() -> list[str]:
    return [f"Made by `{lasting_command()}` at revision `{git_revision()}`; intervals are 95 % Wilson."]


def _sensitivity(result: Mapping[str, Any]) -> list[str]:
    made = f"Made by `{result['command']}` at revision `{result['git_revision']}`, seed {result['seed']}."
    return _joined([[made], tables.sensitivity_lines(result)])


def _label_check(check: Mapping[str, Any]) -> list[str]:
    made = f"Made by `python sim/last_frames.py` at revision `{check['git_revision']}`, seed {check['seed']}."
    repeated = (
        f"{check['n']} random executed trials, half of them lifted, were repeated with their seeds: "
        f"{check['repeated_differently']} ended otherwise than recorded."
    )
    looked = f"Pictures that contradict their label: **{check['disagreements']}**. Looked at: {check['how']}."
    sheets = (
        f"![How {name} trials ended, with their labels](pictures/last_frames_{name}.webp)"
        for name in ("lifted", "failed")
    )
    return _joined([[made], [f"{repeated} {looked}"], *([sheet] for sheet in sheets)])


def _picture(name: str) -> str:
    return f"![{PICTURES[name]}](pictures/dataset_{name}.png)"


def _joined(parts: list[list[str]]) -> list[str]:
    """The parts with an empty line between each two."""
    return [line for part in parts for line in (*part, "")][:-1]
