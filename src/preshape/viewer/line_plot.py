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
        self._y_range = y_range
        series = [
            uplot.Series(label=line.label, stroke=line.colour, width=2, dash=line.dash) for line in lines
        ]
        dot = uplot.Series_Points(show=True, size=10, fill=MARK_COLOUR)
        mark = uplot.Series(label="here", stroke=MARK_COLOUR, points=dot)
        self._handle: GuiUplotHandle = gui.add_uplot(
            self._data(0),
            (uplot.Series(label=x_label), *series, mark),
            scales=self._scales(),
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
        self._handle.scales = self._scales()
        self.mark(0)

    def mark(self, place: int) -> None:
        """Move the mark."""
        self._handle.data = self._data(place)

    def _scales(self) -> dict[str, uplot.Scale]:
        """The axes' limits. Left to itself, uPlot finds none where a value is NaN."""
        known = self._values[np.isfinite(self._values)]
        low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        margin = max(0.05 * (high - low), 0.5)
        y_range = self._y_range or (low - margin, high + margin)
        first, last = float(self._x[0]), float(self._x[-1])
        x_range = (first, last if last > first else first + 1)
        return {"x": uplot.Scale(time=False, range=x_range), "y": uplot.Scale(range=y_range)}

    def _data(self, place: int) -> tuple[np.ndarray, ...]:
        mark = np.full(len(self._x), np.nan)
        mark[place] = self._values[0, place]
        return self._x, *self._values, mark
