"""The result file of the protocols, which several commands write."""

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from preshape.cornell.result_file import merge_rows

PROTOCOLS = ("image_wise", "object_wise")


def rows(data: str, folds: str, value: float) -> list[dict[str, object]]:
    return [{"data": data, "folds": folds, "metric": "recognition_auc", "value": value}]


def kept(path: Path) -> dict[tuple[str, str], float]:
    return {(row["data"], row["folds"]): row["value"] for row in json.loads(path.read_text())["runs"]}


def test_rows_of_the_same_data_and_protocol_are_replaced_and_all_others_stay(tmp_path: Path) -> None:
    path = tmp_path / "cornell.json"
    for value, folds in ((0.1, "image_wise"), (0.2, "object_wise"), (0.3, "image_wise")):
        merge_rows(path, rows("cornell", folds, value), 0)
    assert kept(path) == {("cornell", "image_wise"): 0.3, ("cornell", "object_wise"): 0.2}


def test_commands_that_write_at_the_same_time_lose_no_row(tmp_path: Path) -> None:
    path = tmp_path / "cornell.json"
    wanted = {(f"data{number}", folds): float(number) for number in range(6) for folds in PROTOCOLS}
    with ThreadPoolExecutor(len(wanted)) as threads:
        list(threads.map(lambda key: merge_rows(path, rows(*key, wanted[key]), 0), wanted))
    assert kept(path) == wanted
