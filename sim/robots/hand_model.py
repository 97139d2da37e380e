"""A hand as an arm carries it: its URDF and the meaning of its joints and links."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from lxml import etree


@dataclass(frozen=True, eq=False)
class HandModel:
    """A hand whose joints close towards their upper limits.

    Args:
        name: of the hand; its mount is called after it.
        urdf: links and joints, the palm first; mesh paths are absolute.
        palm_link: its root.
        flange_to_palm_link_m: from the plate that carries it to the palm link, along both their z.
        fingers: finger -> its joints from the palm to the tip.
        fingertip_links: finger -> the link at its tip.
        finger_base_links: first link of each finger; it may touch the palm.
        overlapping_pairs: links that are not checked for collisions although neither carries the other.
        R_link_palm: axes of the palm frame in the palm link; x is the direction in which it approaches.
    """

    name: str
    urdf: etree._Element
    palm_link: str
    flange_to_palm_link_m: float
    fingers: dict[str, tuple[str, ...]]
    fingertip_links: dict[str, str]
    finger_base_links: tuple[str, ...]
    overlapping_pairs: tuple[tuple[str, str], ...]
    R_link_palm: Float[np.ndarray, "3 3"]
