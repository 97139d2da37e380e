"""What a copy of the Cornell grasp data set holds: counts, folds, surfaces and a contact sheet."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.cornell_protocols import detection_sheet, recognition_roc
from analysis.cornell_sheet import contact_sheet
from analysis.cornell_surfaces import surface_figures
from analysis.cornell_tables import page
from preshape.cornell.data_set import CornellDataSet, read_cornell
from preshape.cornell.folds import image_folds, object_folds
from preshape.cornell.rectangle_metric import is_correct
from preshape.drawing.picture_files import save_picture
from preshape.evaluation.intervals import wilson
from preshape.files import atomic_path, read_json, write_json
from preshape.provenance import provenance


@dataclass(frozen=True)
class CornellReport:
    """The report of a copy of the data set.

    Args:
        root: folder of the data set.
        output: folder for `cornell.json`, `cornell.md` and pictures.
        shown: how many images the contact sheet has.
        compared: of how many images both surfaces are compared where both are there.
        seed: of the folds.
        results: result file of `src/detect.py`.
        runs: folder of the sweep that was detected with; None for no pictures of it.
        name: of the rows in the result file that are about this data.
    """

    root: str
    output: str
    shown: int
    compared: int
    seed: int
    results: str
    runs: str | None = None
    name: str = "cornell"

    def write(self) -> str:
        """Write everything and say what came out.

        Raises:
            InputError: if the data set is not complete or damaged, or a file cannot be written.
        """
        data = read_cornell(self.root)
        figures = counts(data) | {
            "folds": fold_sizes(data, self.seed),
            "metric": metric_figures(data),
            "surfaces": surface_figures(data, self.compared),
            "protocols": read_json(self.results)["runs"] if Path(self.results).is_file() else [],
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


def metric_figures(data: CornellDataSet) -> dict[str, dict[str, float]]:
    """How often the rectangle metric accepts a label, by the other positives of its image.

    Positives are what a perfect detector could return, negatives what it must not.
    """
    accepted: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    for image in data.images:
        for i, positive in enumerate(image.positives):
            others = image.positives[:i] + image.positives[i + 1 :]
            tried["positives"] += bool(others)
            accepted["positives"] += is_correct(positive, others)
        tried["negatives"] += len(image.negatives)
        accepted["negatives"] += sum(is_correct(own, image.positives) for own in image.negatives)
    figures = {}
    for name in ("positives", "negatives"):
        low, high = wilson(accepted[name], tried[name])
        rate = accepted[name] / tried[name] if tried[name] else float("nan")
        figures[name] = {"n": tried[name], "accepted": accepted[name], "rate": rate, "low": low, "high": high}
    return figures
