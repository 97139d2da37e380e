"""A contact sheet of the Cornell data: images with their rectangles."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from analysis.cornell.surfaces import spread
from analysis.dataset.charts import BLUE, ORANGE
from preshape.cornell.data_set import CornellDataSet
from preshape.cornell.image_files import read_colour
from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.rectangle import GraspRectangle

ACROSS = 4
MARGIN_PX = 20


def contact_sheet(data: CornellDataSet, shown: int) -> Figure:
    """Figure of images around their rectangles, spread over the data set; thick edges are the jaws.

    Raises:
        InputError: if an image cannot be read.
    """
    images = spread(data.images, shown)
    down = -(-len(images) // ACROSS)
    figure = Figure(figsize=(ACROSS * 3.4, down * 2.8 + 0.4), layout="constrained")
    for axes, image in zip(figure.subplots(down, ACROSS, squeeze=False).flat, images, strict=False):
        axes.imshow(read_colour(image.files.colour))
        for rectangles, colour in ((image.negatives, ORANGE), (image.positives, BLUE)):
            for rectangle in rectangles:
                draw_rectangle(axes, rectangle, colour, 0.6)
        show_around(axes, image.positives + image.negatives)
        axes.set_title(f"{image.files.number:04d} {image.subject.category.replace('_', ' ')}", fontsize=9)
    for axes in figure.axes:
        axes.set_axis_off()
    legend = [Patch(color=BLUE, label="positive"), Patch(color=ORANGE, label="negative")]
    figure.legend(handles=legend, loc="outside lower center", ncols=2, frameon=False)
    return figure


def draw_rectangle(axes: Axes, rectangle: GraspRectangle, colour: str, width: float) -> None:
    """Draw a rectangle; the edges that are its jaws are three times as thick."""
    corners = rectangle.corners()
    axes.plot(*corners[[0, 1]].T, *corners[[2, 3]].T, color=colour, linewidth=width)
    axes.plot(*corners[[1, 2]].T, *corners[[3, 0]].T, color=colour, linewidth=3 * width)


def show_around(axes: Axes, rectangles: Sequence[GraspRectangle]) -> None:
    """Show the part of the image with these rectangles, in the proportions of the image."""
    if not rectangles:
        return
    corners = np.concatenate([rectangle.corners() for rectangle in rectangles])
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = (float((high - low).max()) / 2 + MARGIN_PX) * np.array([1.0, HEIGHT / WIDTH])
    half *= max(1.0, float(((high - low) / 2 / half).max()))
    (left, top), (right, bottom) = (low + high) / 2 - half, (low + high) / 2 + half
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
