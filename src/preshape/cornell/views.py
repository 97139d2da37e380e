"""Images of the data set as RGB-D views."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from preshape.cornell.cameras import fit_camera, nominal_camera
from preshape.cornell.image_files import depth_from_range, read_colour, read_range
from preshape.cornell.layout import ORIGIN, ImageFiles
from preshape.cornell.point_cloud_files import read_point_cloud
from preshape.errors import InputError
from preshape.perception.observation import Observation


class Surface(StrEnum):
    """Where a view's depth comes from."""

    MEASURED = "measured"
    """From the measured points, to rounding."""
    APPROXIMATE = "approximate"
    """From the range image, whose holes are filled, by the nominal camera."""


@dataclass(frozen=True, eq=False)
class CornellView:
    """An image as the networks see it through `preshape.perception.image.eight_channel_image`.

    Args:
        observation: colours, depth and camera; the camera's world is the frame of the robot's base.
        surface: where its depth comes from.
    """

    observation: Observation
    surface: Surface


def load_cornell_view(files: ImageFiles) -> CornellView:
    """Read the view of an image: from its measured points if they are there, else from its range image.

    Raises:
        InputError: if a file is missing, truncated or damaged.
    """
    surface = Surface.APPROXIMATE if files.cloud is None else Surface.MEASURED
    return CornellView(load_surface(files, surface), surface)


def load_surface(files: ImageFiles, surface: Surface) -> Observation:
    """Read the view of an image with the depth from one of its files.

    Raises:
        InputError: if a file is missing, truncated or damaged.
    """
    path = files.cloud if surface is Surface.MEASURED else files.range_image
    if path is None:
        raise InputError(
            f"Image {files.number:04d} has no {surface} surface",
            where=files.colour.parent,
            fix=f"see {ORIGIN}",
        )
    if surface is Surface.MEASURED:
        camera, depth = fit_camera(read_point_cloud(path), path)
    else:
        camera = nominal_camera()
        depth = depth_from_range(read_range(path), camera)
    return Observation(read_colour(files.colour), depth.astype(np.float32), None, camera)
