"""The report of all trainings: result file, charts, and the section of the results page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.chart_files import save_chart
from analysis.learning import charts, tables
from analysis.learning.ablation_differences import AblationDifference, ablation_differences, difference_lines
from analysis.learning.fold_record import FoldRecord
from analysis.learning.runs import LearningRun, measured_folds, read_runs
from analysis.results_page import put_section
from preshape.evaluation.average_roc import average_roc_figure
from preshape.evaluation.fold_summary import split_roc
from preshape.files import write_json
from preshape.provenance import git_revision, lasting_command, provenance

Key = tuple[str, str]
"""Group and split of a run."""


@dataclass(frozen=True)
class LearningReport:
    """The report of all folds that were finished, here or elsewhere. Groups that are not named are left out.

    Args:
        runs: folder with the groups of the sweeps, as `src/train.py --multirun` makes it; it may be missing.
            None: only the record is read.
        record: folder with what the report needs of finished folds, wherever they were trained. Those of
            `runs` are put into it, in the place of recorded ones with the same name, or with other settings
            or data.
        paper: groups of the paper's networks, trained as in the paper, by `config_cnn`, `patches_cnn` and
            `regression`.
        default: group of the default model.
        ablations: tables by their headings; each has groups by what is written beside them.
        calibrated: groups whose probabilities are shown before and after temperature scaling.
        learning_curves: sweeps over the number of trials by what is written beside them: the group with all
            trials, and the beginning of the names of the groups with fewer.
        output: the result file.
        page: results page; pictures lie in `pictures` beside it.
        seed: seed of the trainings, for the result file.
    """

    runs: str | None
    record: str
    paper: Mapping[str, str]
    default: str
    ablations: Mapping[str, Mapping[str, str]]
    calibrated: Sequence[str]
    learning_curves: Mapping[str, Mapping[str, str]]
    output: str
    page: str
    seed: int

    def write(self) -> str:
        """Write everything and say what came out.

        Raises:
            InputError: if there is no fold, a file cannot be read, or one cannot be written.
        """
        record = FoldRecord(Path(self.record))
        with record.locked():
            measured = {} if self.runs is None else measured_folds(self.runs, self._groups())
            for group, folds in measured.items():
                record.take(group, folds)
            return self._write(read_runs(record, self._groups()))

    def _groups(self) -> set[str]:
        """Names of all groups that the report shows."""
        compared = (group for groups in self.ablations.values() for group in groups.values())
        curves = (group for sweep in self.learning_curves.values() for group in tables.curve_groups(sweep))
        return {*self.paper.values(), self.default, *self.calibrated, *compared, *curves}

    def _write(self, found: Sequence[LearningRun]) -> str:
        runs = {(run.group, run.split): run for run in found}
        figures = [run.figures() for run in runs.values()]
        differences = {
            heading: ablation_differences(runs, groups, self.seed)
            for heading, groups in self.ablations.items()
        }
        compared = [own.to_dict() for found in differences.values() for own in found]
        write_json(self.output, {**provenance(self.seed), "runs": figures, "differences": compared})
        parts = [
            ["## Learning"],
            [
                f"Made by `{lasting_command()}` at revision `{git_revision()}` from sweeps of "
                "`src/train.py`; mean ± standard deviation over folds, or the figure of a single fold. "
                "What says *not run* has not been measured."
            ],
            *self._classification(runs),
            *self._regression(runs),
            *self._ablations(runs, differences),
            ["### Temperature scaling"],
            tables.calibration_lines(runs, self.calibrated),
            *self._learning_curves(runs),
        ]
        text = "\n".join(line for part in parts for line in (*part, ""))
        put_section(Path(self.page), "learning", text.rstrip("\n"))
        return f"{len(figures)} runs of sweeps. Result file: {self.output}, page: {self.page}"

    def _classification(self, runs: Mapping[Key, LearningRun]) -> list[list[str]]:
        parts = [["### Classification"], tables.classification_lines(runs, self._networks())]
        for name, group, references in (
            ("config_cnn", self.paper["config_cnn"], tables.PAPER_AUC),
            ("default", self.default, {}),
        ):
            splits = {split: run for (own, split), run in runs.items() if own == group}
            curves = {split: split_roc(run.folds) for split, run in splits.items()}
            known = {split: curve for split, curve in curves.items() if curve is not None}
            if known:
                path = self._picture(f"roc_{name}")
                save_chart(average_roc_figure(known, f"{group}: average of the folds", references), path)
                parts.append([_shown(path, f"Average ROC curves of {group}")])
        shown = [run for run in runs.values() if run.group in (self.paper["config_cnn"], self.default)]
        if shown:
            for name, figure in (
                ("reliability", charts.reliability_charts(shown)),
                ("training_curves", charts.training_curves(shown)),
            ):
                save_chart(figure, self._picture(name))
                parts.append([_shown(self._picture(name), charts.CAPTIONS[name])])
        return parts

    def _networks(self) -> dict[str, str]:
        return {
            "config-CNN, as in the paper": self.paper["config_cnn"],
            "patches-CNN, as in the paper": self.paper["patches_cnn"],
            "default model": self.default,
        }

    def _regression(self, runs: Mapping[Key, LearningRun]) -> list[list[str]]:
        return [["### Regression"], tables.regression_lines(runs, self.paper["regression"])]

    def _ablations(
        self, runs: Mapping[Key, LearningRun], differences: Mapping[str, Sequence[AblationDifference]]
    ) -> list[list[str]]:
        parts = []
        for heading, groups in self.ablations.items():
            parts += [[f"### {heading}"], tables.comparison_lines(runs, groups)]
            if differences[heading]:
                parts.append(difference_lines(differences[heading]))
        return parts

    def _learning_curves(self, runs: Mapping[Key, LearningRun]) -> list[list[str]]:
        parts = [["### Number of trials"], tables.learning_curve_lines(runs, self.learning_curves)]
        figure = charts.learning_curves(runs, self.learning_curves)
        if figure is not None:
            save_chart(figure, self._picture("learning_curves"))
            parts.append([_shown(self._picture("learning_curves"), charts.CAPTIONS["learning_curves"])])
        return parts

    def _picture(self, name: str) -> Path:
        return Path(self.page).parent / "pictures" / f"learning_{name}.png"


def _shown(path: Path, caption: str) -> str:
    return f"![{caption}](pictures/{path.name})"
