"""What a copy of the Cornell grasp data set holds: counts, folds, surfaces and a contact sheet."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.cornell.protocols import detection_sheet, recognition_roc
from analysis.cornell.results import SECTION, results_section
from analysis.cornell.sheet import contact_sheet
from analysis.cornell.surfaces import surface_figures
from analysis.cornell.tables import page
from analysis.results_page import put_section
from preshape.cornell.data_set import CornellDataSet, read_cornell
from preshape.cornell.folds import image_folds, object_folds
from preshape.cornell.label_agreement import label_agreement
from preshape.drawing.picture_files import save_picture
from preshape.evaluation.measured_files import read_figures
from preshape.files import atomic_path, write_json
from preshape.provenance import provenance


@dataclass(frozen=True)
class CornellReport:
    """The report of a copy of the data set.

    Args:
        root: folder of the data set; None to write nothing but the section of the results page.
        output: folder for `cornell.json`, `cornell.md` and pictures.
        shown: how many images the contact sheet has.
        compared: of how many images both surfaces are compared where both are there.
        seed: of the folds.
        results: result file of `src/detect.py`.
        page: the results page.
        runs: folder of the sweep that was detected with; None for no pictures of it.
        name: of the rows in the result file that are about this data.
    """

    root: str | None
    output: str
    shown: int
    compared: int
    seed: int
    results: str
    page: str
    runs: str | None = None
    name: str = "cornell"

    def write(self) -> str:
        """Write everything and say what came out.

        Raises:
            InputError: if the data set is not complete or damaged, or a file cannot be read or written.
        """
        protocols = (
            read_figures(self.results, "runs")["runs"]
            if self.root is None or Path(self.results).is_file()
            else []
        )
        if protocols:
            put_section(Path(self.page), SECTION, results_section(protocols, self.results))
        if self.root is None:
            return f"Recognition and detection in images of {self.results}: {self.page}"
        data = read_cornell(self.root)
        figures = counts(data) | {
            "folds": fold_sizes(data, self.seed),
            "metric": label_agreement(data.images),
            "surfaces": surface_figures(data, self.compared),
            "protocols": protocols,
        }
        folder = Path(self.output)
        write_json(folder / "cornell.json", provenance(self.seed) | figures)
        save_picture(folder / "contact_sheet.png", contact_sheet(data, self.shown))
        pictures = self._pictures(data, folder)
        with atomic_path(folder / "cornell.md") as temporary:
            temporary.write_text(page(figures, self.name, pictures), encoding="utf-8")
        return (
            f"{figures['images']} images of {figures['objects']} objects, {figures['positives']} positive "
            f"and {figures['negatives']} negative rectangles, {sum(figures['dropped'].values())} dropped: "
            f"{folder / 'cornell.md'}"
        )

    def _pictures(self, data: CornellDataSet, folder: Path) -> dict[str, str]:
        """Pictures of recognition and detection as far as there are runs: captions by file."""
        if self.runs is None:
            return {}
        runs = Path(self.runs)
        figures = {
            "roc.png": ("Receiver operating characteristic of recognition", recognition_roc(runs)),
            "detections.png": (
                "Labels (blue), the best of four initial rectangles (orange), inference from these (green)",
                detection_sheet(data, runs, self.shown),
            ),
        }
        for name, (_, figure) in figures.items():
            if figure is not None:
                save_picture(folder / name, figure)
        return {name: caption for name, (caption, figure) in figures.items() if figure is not None}


def counts(data: CornellDataSet) -> dict[str, Any]:
    """How many images, objects, categories, backgrounds and rectangles there are."""
    subjects = [image.subject for image in data.images]
    return {
        "images": len(data.images),
        "objects": len({subject.object_id for subject in subjects}),
        "categories": len({subject.category for subject in subjects}),
        "backgrounds": len({subject.background for subject in subjects}),
        "positives": sum(len(image.positives) for image in data.images),
        "negatives": sum(len(image.negatives) for image in data.images),
        "dropped": {flaw.value: count for flaw, count in data.dropped.items()},
    }


def fold_sizes(data: CornellDataSet, seed: int) -> dict[str, list[dict[str, int]]]:
    """Images, objects and rectangles of each fold, image-wise and object-wise."""
    sizes = {}
    for name, deal in (("image_wise", image_folds), ("object_wise", object_folds)):
        fold_of = deal(data.objects, seed)
        parts = [
            [image for image in data.images if fold_of[image.files.number] == fold]
            for fold in sorted(set(fold_of.values()))
        ]
        sizes[name] = [
            {
                "images": len(part),
                "objects": len({image.subject.object_id for image in part}),
                "positives": sum(len(image.positives) for image in part),
                "negatives": sum(len(image.negatives) for image in part),
            }
            for part in parts
        ]
    return sizes
