"""What `make bench` measured, as a section of the results page."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.results_page import put_section
from analysis.wording import table_row
from preshape.errors import InputError
from preshape.files import read_json

SECTION = "benchmarks"
READING = """Ours and the other way run in turns in one process, medians. The bound is the time below which
ours cannot come: its arithmetic at the rate of large matrix products, for a trial the time that PhysX
itself takes, for a view the picture alone. Log probabilities are means over the initial grasps."""


@dataclass(frozen=True)
class BenchmarkTable:
    """The table of the benchmarks.

    Args:
        results: result file of `make bench`.
        page: the results page.
    """

    results: str
    page: str

    def write(self) -> str:
        """Write the section and say what came out.

        Raises:
            InputError: if the result file is missing or not one of benchmarks, or the page cannot be written.
        """
        content = read_json(self.results)
        try:
            lines = _lines(content)
        except (KeyError, TypeError) as error:
            raise InputError(
                f"The file lacks what a benchmark has ({error})",
                where=self.results,
                fix="make it again with `make bench`",
            ) from error
        put_section(Path(self.page), SECTION, "\n".join(lines))
        return f"{len(content['rows'])} comparisons, page: {self.page}"


def _lines(content: Mapping[str, Any]) -> list[str]:
    machine = content["machine"]
    return [
        "## Speed",
        "",
        f"Made by `python analysis/report.py report=benchmarks` from `make bench` at revision "
        f"`{content['git_revision']}` on {machine['cores']} cores ({machine['processor']}), which multiply "
        f"large matrices at {machine['matrix_product_gflop_per_s']:.0f} GFLOP/s.",
        READING,
        "",
        "| what | ms | against | ms | times faster | bound's share | evaluations | log probability |",
        "|---|---:|---|---:|---:|---:|---:|---:|",
        *(_row(row) for row in content["rows"]),
    ]


def _row(row: Mapping[str, Any]) -> str:
    share = f"{100 * row['bound_share']:.0f} %"
    times = (_ms(row["ours"]), row["peer_name"], _ms(row["peer"]), f"{row['ratio']:.1f}")
    return table_row(
        row["name"], *times, share, _both(row, "evaluations", ",d"), _both(row, "log_prob", ".3f")
    )


def _ms(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def _both(row: Mapping[str, Any], key: str, form: str) -> str:
    if f"ours_{key}" not in row:
        return ""
    return f"{row[f'ours_{key}']:{form}} / {row[f'peer_{key}']:{form}}"
