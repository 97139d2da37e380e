"""The report's section about what the paper did not measure."""

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.pages.report_blocks import Block, Chart, Missing, Row, Section, Table
from analysis.pages.report_charts import (
    SERIES,
    Panel,
    Rate,
    Series,
    lines_with_intervals,
    rate_panels,
    reliability_panels,
)
from analysis.planning.charts import object_figure
from analysis.planning.tables import number, share, signed
from analysis.result_files import ResultFiles
from analysis.wording import plain_name, planner_name

Run = Mapping[str, Any]
CONDITIONS = {"others": "twenty other unseen objects", "scans": "eight scanned objects"}
MEASURE = {
    "planning": (
        "Other objects, calibration of planned grasps",
        ["python sim/evaluate.py experiment=planning", "python analysis/report.py report=planning"],
    ),
    "sensitivity": ("Labels under other physics", ["python sim/sensitivity.py"]),
    "benchmarks": ("Speed against other ways", ["make bench"]),
}


def further_section(results: ResultFiles) -> Section:
    """Other objects, calibration, learning from the planner's optima, labels under other physics, speed."""
    blocks: list[Block] = []
    for name, draw in (("planning", _planning), ("sensitivity", _labels), ("benchmarks", _speed)):
        content = results.find(name)
        if content is None:
            title, commands = MEASURE[name]
            blocks.append(Missing(title, commands, "Not in the paper."))
        else:
            blocks += draw(content)
    lead = ["What the paper did not ask, or could not on its five poses of each object."]
    return Section("further", "Beyond the paper", lead, blocks)


def _planning(content: Mapping[str, Any]) -> list[Block]:
    runs = [run for run in content["runs"] if run["condition"] in CONDITIONS]
    blocks: list[Block] = []
    if runs:
        rows = list(dict.fromkeys(planner_name(run["planner"]) for run in runs))
        panels = [Panel(title, rows, [_of(runs, name)]) for name, title in CONDITIONS.items()]
        figure = rate_panels(panels, "share of executed grasps that lifted, 95 % Wilson intervals")
        words = "Share of executed grasps that lifted, by planner, on other objects"
        blocks.append(Chart("others", "Other objects", figure, words, ["planning"], note=_numbers(runs)))
        blocks.append(
            Chart(
                "others_objects",
                "Other objects, one by one",
                object_figure(runs, "rate"),
                "Share of executed grasps that lifted for each of the other objects and each planner",
                ["planning"],
            )
        )
    return [*blocks, *_calibration(content["runs"]), *_rounds(content["rounds"])]


def _of(runs: Sequence[Run], condition: str) -> Series:
    own = [run for run in runs if run["condition"] == condition and run["executed"]]
    rates = {planner_name(run["planner"]): Rate(run["rate"], run["low"], run["high"]) for run in own}
    return Series("default network", SERIES[0], rates)


def _numbers(runs: Sequence[Run]) -> str:
    """The same figures in words, as a chart alone cannot be quoted."""
    said = (
        f"{planner_name(run['planner'])}, {run['condition']}: {run['lifted']} of {run['executed']}, "
        f"{share(run)}"
        for run in runs
    )
    return "; ".join(said) + "."


def _calibration(runs: Sequence[Run]) -> list[Block]:
    inferred = [run for run in runs if run["planner"] == "inference" and run["reliability"] is not None]
    if not inferred:
        return []
    panels = {f"{run['condition']}, n = {run['executed']}": run["reliability"] for run in inferred}
    note = (
        "Predicted probability at the planned grasp against the share that lifted, in ten bins; the area of "
        "a mark is its share of the grasps. The paper found its network “over confident” with the gripper."
    )
    words = "Reliability diagrams of inference in each condition"
    return [
        Chart(
            "reliability", "How sure inference is", reliability_panels(panels), words, ["planning"], note=note
        ),
        _gaps(inferred),
    ]


def _gaps(inferred: Sequence[Run]) -> Table:
    rows: list[Row] = []
    for run in inferred:
        said = run["reliability"]["predicted_as_planned"]
        gap = said["gap"]
        corrected = run["reliability"]["temperature"]
        rows.append(
            [
                run["condition"],
                str(run["executed"]),
                number(said["predicted"]),
                number(run["rate"]),
                f"{signed(gap['value'])} [{signed(gap['low'])}, {signed(gap['high'])}]",
                f"{said['ece']:.2f}",
                "–" if corrected is None else f"{corrected['ece']:.2f}",
            ]
        )
    header = (
        *("objects", "n", "predicted", "lifted", "predicted less lifted"),
        *("calibration error", "after temperature scaling"),
    )
    table_note = (
        "Intervals are 95 % bootstrap over grasps; the temperature was fitted to the other half of the "
        "scenes."
    )
    return Table("gaps", "The same in numbers", header, rows, ["planning"], note=table_note)


def _rounds(rounds: Sequence[Mapping[str, Any]]) -> list[Block]:
    if not rounds:
        return []
    panels: dict[str, dict[str, dict[float, Rate]]] = {}
    for entry in rounds:
        lines = panels.setdefault(f"added: {planner_name(entry['acquisition']).lower()}", {})
        for name, rate in entry["planners"].items():
            point = Rate(rate["rate"], rate["low"], rate["high"])
            lines.setdefault(planner_name(name), {})[float(entry["round"])] = point
    figure = lines_with_intervals(panels, "round", "lifted of executed")
    words = "Share of executed grasps that lifted after each round of learning from the planner's own optima"
    said = "; ".join(
        f"round {entry['round']}, {planner_name(name).lower()}: {rate['lifted']} of {rate['executed']}"
        for entry in rounds
        for name, rate in entry["planners"].items()
    )
    title = "Learning from the planner's own optima"
    note = f"Made by python sim/improve.py; 95 % Wilson intervals. {said}."
    return [Chart("rounds", title, figure, words, ["planning"], note=note)]


def _labels(content: Mapping[str, Any]) -> list[Block]:
    variants = content["variants"]
    rates = {plain_name(name): Rate(one["share"], one["low"], one["high"]) for name, one in variants.items()}
    series = Series("share of labels that flip", SERIES[0], rates)
    counts = {plain_name(name): f"{one['flips']} of {one['n']}" for name, one in variants.items()}
    panel = Panel("", list(rates), [series], span=(0.0, 0.4))
    figure = rate_panels([panel], "labels that flip, 95 % Wilson intervals")
    (axes,) = figure.axes
    for y, said in enumerate(counts.values()):
        axes.text(0.4, y, said, ha="right", va="center", fontsize=7.5)
    words = "; ".join(f"{name}: {said} labels flip" for name, said in counts.items())
    note = "Trials were repeated with one setting of the physics changed; half of them had lifted."
    return [Chart("labels", "Labels under other physics", figure, words, ["sensitivity"], note=note)]


def _speed(content: Mapping[str, Any]) -> list[Block]:
    rows: list[Row] = [
        [
            row["name"],
            f"{_three_digits(row['ours'])} {row['unit']}",
            row["peer_name"],
            f"{_three_digits(row['peer'])} {row['unit']}",
            f"{row['ratio']:.1f}",
            str(row["runs"]),
        ]
        for row in content["rows"]
    ]
    header = ("what", "ours", "against", "time", "times faster", "runs")
    machine = content["machine"]
    note = f"Medians, measured in turns in one process on {machine['cores']} cores ({machine['processor']})."
    return [Table("speed", "Speed against other ways", header, rows, ["benchmarks"], note=note)]


def _three_digits(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"
