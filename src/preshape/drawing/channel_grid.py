"""The eight channels of the image side by side."""

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from preshape.perception.image import CHANNEL_NAMES

Range = tuple[float | None, float | None]


def channel_grid(image: Float[np.ndarray, "8 h w"]) -> Figure:
    """Figure of the eight channels, each with its name and its scale; pixels of unknown depth are grey.

    The scale of depth leaves out the farthest fifth, which is floor and background.
    """
    figure = Figure(figsize=(12.0, 5.4), layout="constrained")
    unknown = image[CHANNEL_NAMES.index("depth")] == 0
    for axes, name, channel in zip(figure.subplots(2, 4).flat, CHANNEL_NAMES, image, strict=True):
        colours, (low, high), label = _scale(name)
        known = np.ma.masked_array(channel, mask=unknown & (label is not None))
        if name == "depth" and known.count():
            low, high = np.quantile(known.compressed(), (0.0, 0.8))
        axes.set_facecolor("0.6")
        shown = axes.imshow(known, cmap=colours, vmin=low, vmax=high, interpolation="nearest")
        axes.set_title(name.replace("_", " "), fontsize=11)
        axes.set_xticks([])
        axes.set_yticks([])
        if label is not None:
            figure.colorbar(shown, ax=axes, location="bottom", shrink=0.9, aspect=30, label=label)
    return figure


def _scale(name: str) -> tuple[str, Range, str | None]:
    """Colour map, range and label of a channel; colours themselves need no scale."""
    if name == "depth":
        return "viridis", (None, None), "m"
    if name.startswith("normal"):
        return "PuOr", (-1.0, 1.0), "camera frame"
    if name == "curvature":
        return "magma", (0.0, 0.1), "share of variance"
    return "gray", (0.0, 1.0), None
