"""The report's section about the trials, beside those of the paper."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.pages.report_blocks import Block, Cell, Missing, Picture, Section, Table
from analysis.planning.tables import share
from analysis.result_files import ResultFiles
from analysis.wording import plain_name
from preshape.evaluation.intervals import wilson

PAPER_EXECUTED, PAPER_LIFTED, PAPER_OBJECTS = 1507, 159, 125
NO_DATASET = Missing(
    "The trials",
    ["python sim/collect.py collect.trials=10000", "python analysis/report.py report=dataset"],
    "1,507 executed grasps on 125 objects, 159 of them lifted (section 4.1).",
)


def collection_section(results: ResultFiles, pictures: Path) -> Section:
    """What was collected, at which rates, and how sure the labels are.

    Args:
        results: the result files; `dataset` and `collection` are used.
        pictures: folder of the shipped pictures.
    """
    blocks: list[Block] = [_counts(results), *_faces(results)]
    blocks.append(
        Picture(
            "objects",
            "The 125 generated grocery items as the simulator draws them",
            pictures / "objects.webp",
            "A sheet of 125 small pictures of packages, bottles, cans, jars and fruit, each with its name",
            "python sim/contact_sheet.py objects=grocery",
            paper="Fig. 3 shows colours and depth of one BigBIRD scan",
        )
    )
    lead = [
        "The paper collected grasps of 125 scanned objects in Gazebo. Here 125 generated items "
        "stand for them "
        "in SAPIEN; only executed grasps count as tries, and only an object that is still in the hand at the "
        "end of the lift counts as lifted."
    ]
    return Section("collection", "Data", lead, blocks, "Section 4.1")


def _counts(results: ResultFiles) -> Block:
    dataset, collection = results.find("dataset"), results.find("collection")
    if dataset is None:
        return NO_DATASET
    low, high = wilson(PAPER_LIFTED, PAPER_EXECUTED)
    paper = {"rate": PAPER_LIFTED / PAPER_EXECUTED, "low": low, "high": high}
    rows = [
        ("objects", f"{dataset['objects']}, generated", Cell("125, BigBIRD scans", "paper")),
        ("scenes", f"{dataset['scenes']:,}", Cell("–", "paper")),
        ("grasps executed", f"{dataset['executed']:,}", Cell(f"{PAPER_EXECUTED:,}", "paper")),
        (
            "executed per object",
            f"{dataset['executed'] / dataset['objects']:.0f}",
            Cell(f"{PAPER_EXECUTED / PAPER_OBJECTS:.0f}", "paper"),
        ),
        ("lifted", f"{dataset['lifted']:,}", Cell(f"{PAPER_LIFTED}", "paper")),
        ("lifted of executed", share(dataset), Cell(share(paper), "paper")),
        (
            "objects lifted sometimes, not always",
            str(dataset["objects_with_both_outcomes"]),
            Cell("–", "paper"),
        ),
    ]
    if collection is not None:
        rows += _labelling(collection)
    return Table(
        "trials",
        "The trials",
        ("", "ours", "paper"),
        rows,
        ["dataset", "collection"] if collection is not None else ["dataset"],
        "Section 4.1, text",
        "Intervals are 95 % Wilson; the paper gives counts, from which its interval was computed.",
    )


def _labelling(collection: Mapping[str, Any]) -> list[tuple[str, str, Cell]]:
    """How fast trials are labelled, and how sure the labels are."""
    looked = f"{collection['label_disagreements']} of {collection['labels_looked_at']}"
    again = f"{collection['flips_under_repeated_seeds']} of {collection['repeated_with_the_same_seed']}"
    speed = collection["speed"]
    return [
        (
            f"executed trials an hour, {speed['workers']} workers",
            f"{speed['executed_per_hour']:,.0f} (n = {speed['executed']})",
            Cell("–", "paper"),
        ),
        ("pictures that contradict their label", looked, Cell("–", "paper")),
        ("labels that differ when repeated with their seed", again, Cell("–", "paper")),
    ]


def _faces(results: ResultFiles) -> list[Block]:
    dataset = results.find("dataset")
    if dataset is None:
        return []
    rows = [
        (f"{group}: {plain_name(name)}", f"{rate['executed']:,}", f"{rate['lifted']:,}", share(rate))
        for group, key in (("grasp", "faces"), ("chosen by", "planners"))
        for name, rate in dataset[key].items()
    ]
    header = ("executed grasps", "executed", "lifted", "rate")
    note = "The rates of single objects stand in docs/data_card.md."
    return [Table("faces", "Where the lifted grasps are", header, rows, ["dataset"], note=note)]
