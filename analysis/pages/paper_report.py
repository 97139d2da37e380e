"""One self-contained page: every table and figure of the paper's experiments beside ours."""

import io
import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from analysis.learning.tables import PAPER_AUC
from analysis.pages.classification_section import Network, classification_section, mean_of_folds
from analysis.pages.collection_section import collection_section
from analysis.pages.embedding import embedded_vector
from analysis.pages.further_section import further_section
from analysis.pages.page_template import page_template
from analysis.pages.report_blocks import Chart, Section
from analysis.pages.report_charts import look
from analysis.pages.robot_sections import gripper_section, hand_section
from analysis.pages.simulation_section import simulation_section
from analysis.paper_figures import ALL, paper_number
from analysis.result_files import ResultFiles
from preshape.files import atomic_path
from preshape.provenance import provenance

log = logging.getLogger(__name__)

FIGURES = "figures"
"""Folder of the PDFs, beside the page."""


@dataclass(frozen=True)
class Tile:
    """A figure of the summary, with its interval and the paper's figure; numbers of ours may be None."""

    title: str
    figure: str
    explanation: str
    value: float | None
    low: float | None
    high: float | None
    paper: float | None


@dataclass(frozen=True)
class PaperReport:
    """The report of everything that was measured.

    It needs the result files alone: no trial is read, nothing is trained, planned or rendered.

    Args:
        results: folder of the result files; what has none is shown as not measured yet.
        networks: networks of the paper's cross validation and ours.
        default: group of the network that stands in the summary.
        pictures: folder of the shipped pictures.
        output: the page; figures as PDF lie in the folder `figures` beside it.
    """

    results: str
    networks: Sequence[Mapping[str, str]]
    default: str
    pictures: str
    output: str

    def write(self) -> str:
        """Write the page and its figures, and say what came out.

        Raises:
            InputError: if there is no result file, one cannot be used, or nothing can be written.
        """
        begin = time.monotonic()
        results, output = ResultFiles(self.results), Path(self.output)
        with look():
            sections = self._sections(results)
            charts = [block for section in sections for block in section.blocks if isinstance(block, Chart)]
            drawn = {chart.name: _vector(chart.figure) for chart in charts}
            for chart in charts:
                _save_pdf(chart.figure, output.parent / FIGURES / f"{chart.name}.pdf")
        page = page_template("report.html").render(
            tiles=self._tiles(results),
            sections=sections,
            drawn=drawn,
            results=list(results),
            missing=[(section, block) for section in sections for block in section.missing],
            made=provenance(0),
            figures=FIGURES,
        )
        with atomic_path(output) as temporary:
            temporary.write_text(page, encoding="utf-8")
        missing = sum(len(section.missing) for section in sections)
        log.info("Drawn in %.1f s from %d result files", time.monotonic() - begin, len(list(results)))
        return f"{len(charts)} figures, {missing} parts not measured yet. Page: {output}"

    def _sections(self, results: ResultFiles) -> list[Section]:
        networks = [Network(**network) for network in self.networks]
        pictures = Path(self.pictures)
        return [
            collection_section(results, pictures),
            classification_section(results, networks),
            simulation_section(results),
            hand_section(results, pictures),
            gripper_section(results),
            further_section(results),
        ]

    def _tiles(self, results: ResultFiles) -> list[Tile]:
        tiles = [_rate_tile(results, "planning", split, f"Inference, {split} objects") for split in PAPER_AUC]
        tiles.append(_rate_tile(results, "two_finger", "two_finger", "Inference, two fingers"))
        learning = results.find("cross_validation") or {"runs": ()}
        for split, printed in PAPER_AUC.items():
            paper = float(printed.split()[1])
            runs = [r for r in learning["runs"] if (r["group"], r["split"]) == (self.default, split)]
            title = f"AUC, {split} objects"
            if not runs:
                tiles.append(
                    Tile(title, "–", f"not measured yet; paper {paper:.2f}", None, None, None, paper)
                )
                continue
            rate = mean_of_folds(runs[0]["auc"]["folds"])
            about = f"{runs[0]['n']:,} held-out trials, {len(runs[0]['folds'])} folds; paper {paper:.2f}"
            tiles.append(Tile(title, f"{rate.value:.3f}", about, rate.value, rate.low, rate.high, paper))
        return tiles


def _rate_tile(results: ResultFiles, name: str, condition: str, title: str) -> Tile:
    """Lifted of executed by inference, beside the paper's share."""
    paper = paper_number(condition, "inference", ALL).rate
    printed = "–" if paper is None else f"{100 * paper:.0f}\u00a0%"
    runs = [
        run
        for run in (results.find(name) or {"runs": ()})["runs"]
        if run["planner"] == "inference" and (name == "two_finger" or run["condition"] == condition)
    ]
    if not runs or not runs[0]["executed"]:
        return Tile(title, "–", f"not measured yet; paper {printed}", None, None, None, paper)
    run = runs[0]
    about = f"{run['lifted']} of {run['executed']} executed grasps lifted; paper {printed}"
    return Tile(title, f"{100 * run['rate']:.0f} %", about, run["rate"], run["low"], run["high"], paper)


def _vector(figure: Figure) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    figure.set_layout_engine("none")  # it is laid out now; doing so again for the PDF takes as long
    return embedded_vector(buffer.getvalue())


def _save_pdf(figure: Figure, path: Path) -> None:
    with atomic_path(path) as temporary:
        figure.savefig(temporary, metadata={"CreationDate": None})
