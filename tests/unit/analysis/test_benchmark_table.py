"""The section on speed says what the result file says."""

from pathlib import Path

import pytest

from analysis.benchmark_table import BenchmarkTable
from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.paths import project_root

RESULTS = project_root() / "results" / "benchmarks.json"


def test_every_comparison_has_its_row(tmp_path: Path) -> None:
    page = tmp_path / "results.md"
    BenchmarkTable(str(RESULTS), str(page)).write()
    text, content = page.read_text(), read_json(RESULTS)
    for row in content["rows"]:
        line = next(line for line in text.splitlines() if line.startswith(f"| {row['name']} |"))
        assert line.split(" | ")[4] == f"{row['ratio']:.1f}"
        assert line.count("|") == 9
    assert content["git_revision"] in text


def test_another_file_is_refused(tmp_path: Path) -> None:
    write_json(tmp_path / "other.json", {"rows": [{"name": "a"}], "machine": {}, "git_revision": "0"})
    with pytest.raises(InputError, match="lacks what a benchmark has"):
        BenchmarkTable(str(tmp_path / "other.json"), str(tmp_path / "results.md")).write()
    assert not (tmp_path / "results.md").exists()
