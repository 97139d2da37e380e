"""Lifted and executed trials per object, as a section of the results page."""

from dataclasses import dataclass
from pathlib import Path

from analysis.dataset.film_strip import save_film_strip
from analysis.lift_rates import LiftRate, lift_rate, of_object
from analysis.results_page import put_section
from analysis.wording import plain_name
from preshape.data.tables import read_data_set
from preshape.data.trial import TrialOutcome
from preshape.data.trial_table import TrialTable
from preshape.grasps.space import GraspSpace
from preshape.provenance import git_revision, lasting_command

SHOWN = (TrialOutcome.LIFTED, TrialOutcome.DROPPED)
"""Outcomes of which one trial is shown in pictures."""


@dataclass(frozen=True, eq=False)
class ObjectTable:
    """The section of a set of objects in the results page.

    Args:
        data: folder with the tables of the trials.
        animations: folder with films of trials, `<trial_id>.webp`; None for no pictures.
        page: the Markdown page; the section is replaced there or put at its end.
        section: name of the section.
        title: its heading.
        space: what theta means.
    """

    data: str
    animations: str | None
    page: str
    section: str
    title: str
    space: GraspSpace

    def write(self) -> str:
        """Write the section and say what came out.

        Raises:
            InputError: if the tables cannot be used, or the page cannot be written.
        """
        trials = read_data_set(self.data, self.space)[1]
        lines = [
            f"## {self.title}",
            "",
            f"{len(trials)} grasps planned, {len(trials.executed)} executed; intervals are 95 % Wilson.",
            f"Made by `{lasting_command()}` at revision `{git_revision()}`.",
            "",
            *table_lines(trials),
            *self._picture_lines(trials),
        ]
        put_section(Path(self.page), self.section, "\n".join(lines))
        rate = lift_rate(trials)
        return f"Lifted {rate.lifted} of {rate.executed} executed trials. Page: {self.page}"

    def _picture_lines(self, trials: TrialTable) -> list[str]:
        lines = []
        for outcome in SHOWN if self.animations is not None else ():
            film = self._first_film(trials, outcome)
            if film is None:
                continue
            trial_id, object_id, path = film
            picture = Path(self.page).parent / "pictures" / f"{self.section}_{outcome.value}.png"
            save_film_strip(path, picture)
            text = f"Trial {trial_id}, {plain_name(object_id)}: {outcome.value}"
            lines += ["", f"{text}.", "", f"![{text}](pictures/{picture.name})"]
        return lines

    def _first_film(self, trials: TrialTable, outcome: TrialOutcome) -> tuple[int, str, Path] | None:
        rows = trials.rows[trials.rows["outcome"] == outcome.value]
        for trial_id, object_id in zip(rows["trial_id"], rows["object_id"], strict=True):
            path = Path(self.animations or "") / f"{trial_id}.webp"
            if path.is_file():
                return int(trial_id), str(object_id), path
        return None


def table_lines(trials: TrialTable) -> list[str]:
    """Markdown table with one row per object and one for all."""
    lines = [
        "| object | executed | lifted | rate | interval | not executed |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for object_id in sorted(set(trials.object_ids)):
        own = of_object(trials, object_id)
        lines.append(_row(plain_name(object_id), lift_rate(own), len(own)))
    return [*lines, _row("**all**", lift_rate(trials), len(trials))]


def _row(name: str, rate: LiftRate, planned: int) -> str:
    share = f"{rate.rate:.2f}" if rate.executed else "–"
    interval = f"{rate.low:.2f}–{rate.high:.2f}" if rate.executed else "–"
    return f"| {name} | {rate.executed} | {rate.lifted} | {share} | {interval} | {planned - rate.executed} |"
