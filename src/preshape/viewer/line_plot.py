"""A small plot in the viewer's panel, with a mark where the slider stands."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from viser import GuiApi, GuiUplotHandle, uplot

MARK_COLOUR = "#111111"


@dataclass(frozen=True)
class Line:
    """A line of a plot.

    Args:
        label: what it shows.
        colour: as in CSS.
        dash: lengths of dashes and gaps (pixels); empty for a solid line.
    """

    label: str
    colour: str
    dash: tuple[float, ...] = ()


class LinePlot:
    """Lines over a common axis.

    Args:
        gui: the viewer's panel.
        x_label: what is to the right.
        lines: what is upwards; the mark is on the first.
        y_range: limits of the upward axis; None for those of the values.
    """

    def __init__(
        self, gui: GuiApi, x_label: str, lines: Sequence[Line], y_range: tuple[float, float] | None = None
    ) -> None:
        self._x: Float[np.ndarray, "n"] = np.zeros(1)
        self._values: Float[np.ndarray, "k n"] = np.full((len(lines), 1), np.nan)
        scales: dict[str, uplot.Scale] = {"x": uplot.Scale(time=False)}
        if y_range is not None:
            scales["y"] = uplot.Scale(range=y_range)
        series = [
            uplot.Series(label=line.label, stroke=line.colour, width=2, dash=line.dash) for line in lines
        ]
        dot = uplot.Series_Points(show=True, size=10, fill=MARK_COLOUR)
        mark = uplot.Series(label="here", stroke=MARK_COLOUR, points=dot)
        self._handle: GuiUplotHandle = gui.add_uplot(
            self._data(0),
            (uplot.Series(label=x_label), *series, mark),
            scales=scales,
            legend=uplot.Legend(show=len(lines) > 1),
            height=150,
        )

    @property
    def data(self) -> tuple[np.ndarray, ...]:
        """What is plotted: the axis, each line, and the mark, which is NaN but at one place."""
        return self._handle.data

    def show(self, x: Float[np.ndarray, "n"], values: Float[np.ndarray, "k n"]) -> None:
        """Show other lines, with the mark at their beginning."""
        self._x, self._values = x, values
        self.mark(0)

    def mark(self, place: int) -> None:
        """Move the mark."""
        self._handle.data = self._data(place)

    def _data(self, place: int) -> tuple[np.ndarray, ...]:
        mark = np.full(len(self._x), np.nan)
        mark[place] = self._values[0, place]
        return self._x, *self._values, mark
