"""What the camera saw."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from preshape.geometry.camera import Camera


@dataclass(frozen=True, eq=False)
class Observation:
    """One RGB-D view z.

    Args:
        rgb: colour, 0-255.
        depth: distance along the optical axis in metres; NaN where the sensor saw nothing.
        mask: the object's pixels where they are known, else None.
        camera: the camera that took it.
    """

    rgb: UInt8[np.ndarray, "h w 3"]
    depth: Float32[np.ndarray, "h w"]
    mask: Bool[np.ndarray, "h w"] | None
    camera: Camera
