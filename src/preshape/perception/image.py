"""The 8-channel image that the networks see (paper, section 3)."""

import numpy as np
from jaxtyping import Float32

from preshape.perception.observation import Observation
from preshape.perception.surface import normals_and_curvature

CHANNEL_NAMES = ("red", "green", "blue", "depth", "normal_x", "normal_y", "normal_z", "curvature")


def eight_channel_image(observation: Observation) -> Float32[np.ndarray, "8 h w"]:
    """Colour (0-1), depth (m), surface normals (camera frame) and curvature, in the order of `CHANNEL_NAMES`.

    Depth, normals and curvature are 0 where they are unknown.
    """
    normals, curvature = normals_and_curvature(observation)
    colour = observation.rgb.astype(np.float32) / 255
    channels = np.dstack((colour, observation.depth, normals, curvature))
    return np.asarray(np.nan_to_num(np.ascontiguousarray(np.moveaxis(channels, -1, 0))))
