"""The 8-channel image that the networks see (paper, section 3)."""

import numpy as np
from jaxtyping import Float32

from preshape.perception.observation import Observation
from preshape.perception.surface import normals_and_curvature

CHANNEL_NAMES = ("red", "green", "blue", "depth", "normal_x", "normal_y", "normal_z", "curvature")
DEPTH = CHANNEL_NAMES.index("depth")
NORMALS = slice(DEPTH + 1, DEPTH + 4)


def eight_channel_image(observation: Observation) -> Float32[np.ndarray, "8 h w"]:
    """Colour (0-1), depth (m), surface normals (camera frame) and curvature, in the order of `CHANNEL_NAMES`.

    Depth, normals and curvature are 0 where they are unknown.
    """
    image = np.empty((len(CHANNEL_NAMES), *observation.depth.shape), dtype=np.float32)
    normals, curvature = normals_and_curvature(observation)
    image[:3] = np.moveaxis(observation.rgb, -1, 0)
    image[:3] /= 255
    image[3], image[4:7], image[7] = observation.depth, np.moveaxis(normals, -1, 0), curvature
    surface = image[3:]
    np.copyto(surface, 0, where=np.isnan(surface))
    return image
