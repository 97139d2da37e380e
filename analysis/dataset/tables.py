"""The figures of a data set as Markdown."""

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.wording import plain_name

NOT_BOTH = 40
"""Objects without both outcomes are named up to this many."""


def counts_lines(figures: Mapping[str, Any]) -> list[str]:
    """What was planned, executed and lifted, in one table."""
    outcomes = ", ".join(f"{n} {plain_name(name)}" for name, n in figures["outcomes"].items())
    return [
        "| | |",
        "|---|---|",
        f"| objects | {figures['objects']} |",
        f"| scenes | {figures['scenes']:,} |",
        f"| grasps planned | {figures['planned']:,}: {outcomes} |",
        f"| executed | {figures['executed']:,} |",
        f"| lifted | {figures['lifted']:,}: {percent_interval(figures)} |",
        f"| dropped, yet more than 10 cm up at the end | {figures['dropped_but_high']} |",
        f"| objects with both outcomes | {figures['objects_with_both_outcomes']} of {figures['objects']} |",
    ]


def rate_lines(what: Sequence[str], rates: Mapping[str, Mapping[str, float]]) -> list[str]:
    """A row for each group with its rate; a group's name has as many parts as `what` has headings."""
    lines = [
        f"| {' | '.join(what)} | executed | lifted | rate | 95 % interval |",
        f"|{'---|' * len(what)}---:|---:|---:|---:|",
    ]
    for name, rate in rates.items():
        parts = " | ".join(plain_name(part) for part in name.split(", "))
        counts = f"{rate['executed']} | {rate['lifted']}"
        share = f"{100 * rate['rate']:.0f} %" if rate["executed"] else "–"
        interval = f"{100 * rate['low']:.0f}–{100 * rate['high']:.0f} %" if rate["executed"] else "–"
        lines.append(f"| {parts} | {counts} | {share} | {interval} |")
    return lines


def percent_interval(rate: Mapping[str, float]) -> str:
    """`43.1 % [42.0, 44.2]`."""
    if not rate["executed"]:
        return "none"
    return f"{100 * rate['rate']:.1f} % [{100 * rate['low']:.1f}, {100 * rate['high']:.1f}]"


def one_sided_lines(figures: Mapping[str, Any]) -> list[str]:
    """The objects that were never lifted, or always, by name."""
    lines = []
    for key, text in (("objects_never_lifted", "Never lifted"), ("objects_always_lifted", "Always lifted")):
        names = figures[key]
        known = ", ".join(_with_counts(name, figures["object_rates"][name]) for name in names[:NOT_BOTH])
        more = "" if len(names) <= NOT_BOTH else f" and {len(names) - NOT_BOTH} more"
        lines += [f"{text} ({len(names)}): {known}{more}." if names else f"{text}: none.", ""]
    return lines[:-1]


def _with_counts(name: str, rate: Mapping[str, float]) -> str:
    return f"{plain_name(name)} ({rate['lifted']} of {rate['executed']})"


def seconds_lines(figures: Mapping[str, Any]) -> list[str]:
    """Time of an executed trial by part."""
    seconds = figures["seconds"]
    parts = {name: value for name, value in seconds.items() if name not in ("total", "physics_share")}
    total = seconds["total"] or 1.0
    return [
        "| part | seconds of one core per executed trial | share |",
        "|---|---:|---:|",
        *(f"| {name} | {value:.3f} | {100 * value / total:.0f} % |" for name, value in parts.items()),
        f"| all | {seconds['total']:.3f} | |",
    ]


def sensitivity_lines(result: Mapping[str, Any]) -> list[str]:
    """What flipped under which variant, and soft labels where there are some."""
    lines = [
        "| variant | trials | flips | share | 95 % interval | lifted before → after | the same to the bit |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    softened = {}
    for name, flips in result["variants"].items():
        interval = f"{100 * flips['low']:.1f}–{100 * flips['high']:.1f} %"
        after = f"{flips['lifted_before']} → {flips['lifted_after']}"
        share = f"{100 * flips['share']:.1f} %"
        numbers = f"{flips['n']} | {flips['flips']} | {share} | {interval} | {after} | {flips['identical']}"
        lines.append(f"| `{name}` | {numbers} |")
        if flips["soft_labels"] is not None:
            softened[name] = flips["soft_labels"]
    for name, soft in softened.items():
        values = list(soft["lifted"])
        lines += [
            "",
            f"Soft labels under `{name}`, trials by their recorded label:",
            "",
            f"| soft label | {' | '.join(values)} |",
            f"|---|{'---:|' * len(values)}",
            *(
                f"| {plain_name(label)} | {' | '.join(str(n[v]) for v in values)} |"
                for label, n in soft.items()
            ),
        ]
    return lines
