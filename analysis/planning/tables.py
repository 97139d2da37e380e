"""The figures of the planning experiment as Markdown."""

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.paper_figures import ALL, paper_number
from analysis.wording import plain_name, planner_name, table_row

Rows = Sequence[Mapping[str, Any]]


def run_lines(runs: Rows) -> list[str]:
    """A row for each condition and planner, with the paper's rate where it prints one."""
    lines = [
        "| condition | planner | scenes | executed | lifted | rate | paper | lifted of all scenes "
        "| predicted | network evaluations | seconds |",
        "|---|---|---:|---:|---:|---|---:|---|---:|---:|---:|",
    ]
    for run in runs:
        paper = paper_number(run["condition"], run["planner"], ALL).rate
        cells = (
            run["condition"],
            planner_name(run["planner"]),
            run["n"],
            run["executed"],
            run["lifted"],
            share(run) if run["executed"] else "–",
            "–" if paper is None else f"{100 * paper:.0f} %",
            f"{run['scenes']['lifted']} of {run['n']}: {share(run['scenes'])}",
            number(run["predicted"]),
            f"{run['evaluations']:.0f}",
            f"{run['seconds']:.3f}",
        )
        lines.append(table_row(*cells))
    return lines


def test_lines(tests: Rows, of_scenes: Rows) -> list[str]:
    """Paired tests: on the scenes on which both planners executed a grasp, and on all."""
    lines = [
        "| condition | against | scenes | difference | only it / only the other lifted | p "
        "| all scenes: difference | p |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for test, whole in zip(tests, of_scenes, strict=True):
        cells = (
            test["condition"],
            planner_name(test["against"]),
            test["n"],
            points(test["difference"]),
            f"{test['first_only']} / {test['second_only']}",
            probability(test["p"]),
            points(whole["difference"]),
            probability(whole["p"]),
        )
        lines.append(table_row(*cells))
    return lines


def reliability_lines(runs: Rows) -> list[str]:
    """Predicted less executed success of each planner, as planned and after two corrections."""
    lines = [
        "| condition | planner | n | predicted | lifted | predicted less lifted | calibration error "
        "| after temperature scaling | after isotonic regression |",
        "|---|---|---:|---:|---:|---|---:|---|---|",
    ]
    for run in runs:
        said = run["reliability"]
        if said is None:
            continue
        first = said["predicted_as_planned"]
        gap = first["gap"]
        corrected = (
            "–"
            if said[name] is None
            else f"{signed(said[name]['gap']['value'])}, error {said[name]['ece']:.2f}"
            for name in ("temperature", "isotonic")
        )
        cells = (
            run["condition"],
            planner_name(run["planner"]),
            run["executed"],
            number(first["predicted"]),
            number(run["rate"]),
            f"{signed(gap['value'])} [{signed(gap['low'])}, {signed(gap['high'])}]",
            f"{first['ece']:.2f}",
            *corrected,
        )
        lines.append(table_row(*cells))
    return lines


def object_lines(runs: Rows) -> list[str]:
    """Lifted of executed per object and planner in one condition; in brackets the paper's rate."""
    lines = [
        f"| object | {' | '.join(planner_name(run['planner']) for run in runs)} |",
        f"|---|{'---|' * len(runs)}",
    ]
    for name in sorted({name for run in runs for name in run["objects"]}):
        cells = [_object_cell(run, name) for run in runs]
        lines.append(f"| {plain_name(name)} | {' | '.join(cells)} |")
    return lines


def round_lines(rounds: Rows) -> list[str]:
    """A row for each round of improvement and planner."""
    lines = [
        "| added grasps | round | trials of the table | added: lifted of executed | AUC on held-out trials "
        "| planner | executed | lifted | rate | predicted |",
        "|---|---:|---:|---|---|---|---:|---:|---|---:|",
    ]
    for entry in rounds:
        added = entry["added"]
        for name, planner in entry["planners"].items():
            cells = (
                planner_name(entry["acquisition"]),
                entry["round"],
                entry["trials"],
                "–" if added is None else f"{added['lifted']} of {added['executed']}",
                "{} [{}, {}]".format(*(number(entry["auc"][key]) for key in ("value", "low", "high"))),
                planner_name(name),
                planner["executed"],
                planner["lifted"],
                share(planner) if planner["executed"] else "–",
                number(planner["predicted"]),
            )
            lines.append(table_row(*cells))
    return lines


def share(rate: Mapping[str, float]) -> str:
    """`88 % [66, 97]`."""
    return f"{100 * rate['rate']:.0f} % [{100 * rate['low']:.0f}, {100 * rate['high']:.0f}]"


def points(difference: float | None) -> str:
    """A difference of rates in percentage points, `+12`."""
    return "–" if difference is None or difference != difference else f"{100 * difference:+.0f}"


def probability(p: float) -> str:
    """A p-value as it is usually given."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def number(value: float | None) -> str:
    """Two decimals; a dash if it is not known."""
    return "–" if value is None or value != value else f"{value:.2f}"


def signed(value: float) -> str:
    """Two decimals with the sign."""
    return f"{value:+.2f}"


def _object_cell(run: Mapping[str, Any], name: str) -> str:
    rate = run["objects"].get(name)
    if rate is None:
        return "–"
    paper = paper_number(run["condition"], run["planner"], name).rate
    printed = "" if paper is None else f" ({100 * paper:.0f} %)"
    return f"{rate['lifted']} of {rate['executed']}{printed}"
