"""How names and rows of the tables read on a page."""

from preshape.data.trial import TrialOutcome

PLANNERS = {
    "max_eval": "Max-eval",
    "cem": "Cross-entropy method",
    "lbfgs": "L-BFGS-B",
    "paper": "Inference with the paper's steps",
    "paper_constrained": "The paper's steps, kept off table and object",
    "map_mixture": "MAP, Gaussian mixture",
    "map_network": "MAP, mixture density network",
    "planner_optimum": "Own optima",
}
MARKS = {
    TrialOutcome.LIFTED: "✓",
    TrialOutcome.DROPPED: "▼",
    TrialOutcome.MISSED: "○",
}
"""Outcomes are told by a mark and a word; colour only repeats it."""


def table_row(*cells: object) -> str:
    """A row of a Markdown table."""
    return f"| {' | '.join(map(str, cells))} |"


def plain_name(name: str) -> str:
    """`aunt_jemima_original_syrup` as `aunt jemima original syrup`."""
    return name.replace("_", " ")


def planner_name(planner: str) -> str:
    """`inference` as `Inference`."""
    return PLANNERS.get(planner, plain_name(planner).capitalize())


def outcome_mark(outcome: TrialOutcome) -> str:
    """Mark of an outcome; all that is not a tried grasp has the same."""
    return MARKS.get(outcome, "–")
