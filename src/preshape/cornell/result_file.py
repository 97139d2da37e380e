"""The result file of the protocols, `results/cornell.json`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from preshape.files import exclusive, read_json, write_json
from preshape.provenance import provenance

HEADLINES = ("recognition_accuracy", "detection_inference_4")


def merge_rows(path: Path, rows: Sequence[dict[str, Any]], seed: int) -> None:
    """Put rows into the file, in place of those of the same data and protocol; all others stay.

    Every row names the command and the revision that made it, because several commands write the file,
    perhaps at the same time.

    Raises:
        InputError: if the file cannot be read or written.
    """
    made = provenance(seed)
    named = [row | {"command": made["command"], "git_revision": made["git_revision"]} for row in rows]
    replaced = {(row["data"], row["folds"]) for row in rows}
    with exclusive(path.parent / f".{path.name}.lock"):
        before = read_json(path).get("runs", []) if path.is_file() else []
        kept = [row for row in before if (row["data"], row["folds"]) not in replaced]
        write_json(path, {**made, "runs": [*kept, *named]})


def summary(rows: Sequence[dict[str, Any]]) -> str:
    """The figures of the paper in words."""
    said = (
        f"{row['folds'].replace('_', '-')} {row['metric'].replace('_', ' ')} {row['value']:.3f} "
        f"[{row['low']:.3f}, {row['high']:.3f}]"
        for row in rows
        if row["metric"] in HEADLINES
    )
    return ", ".join(said)
