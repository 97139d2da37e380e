"""Inertias of links in URDFs."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float
from lxml import etree
from lxml.builder import E


def inertial_element(
    mass: float, centre: Float[np.ndarray, "3"], inertia: Float[np.ndarray, "3 3"]
) -> etree._Element:
    """URDF's <inertial> of a mass (kg) at `centre` (m) with an inertia about it (kg m^2)."""
    entries = {f"i{'xyz'[i]}{'xyz'[j]}": f"{inertia[i, j]:.6g}" for i in range(3) for j in range(i, 3)}
    return E.inertial(E.origin(xyz=numbers(centre)), E.mass(value=f"{mass:.6g}"), E.inertia(entries))


def spread_over_boxes(
    mass: float, centres: Float[np.ndarray, "n 3"], sizes: Float[np.ndarray, "n 3"]
) -> etree._Element:
    """URDF's <inertial> of a mass (kg) spread evenly over boxes (m)."""
    shares = mass * sizes.prod(axis=1) / sizes.prod(axis=1).sum()
    centre = shares @ centres / mass
    inertia = np.zeros((3, 3))
    for share, size, offset in zip(shares, sizes, centres - centre, strict=True):
        inertia += share / 12 * (size @ size * np.eye(3) - np.diag(size**2))
        inertia += share * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return inertial_element(mass, centre, inertia)


def cylinder_inertial(mass: float, radius: float, length: float, middle: float) -> etree._Element:
    """URDF's <inertial> of a solid cylinder (kg, m) along z around z = `middle`."""
    across, along = mass * (3 * radius**2 + length**2) / 12, mass * radius**2 / 2
    return inertial_element(mass, np.array([0.0, 0.0, middle]), np.diag([across, across, along]))


def numbers(vector: Iterable[float]) -> str:
    """A vector as URDF writes it."""
    return " ".join(f"{number:.6g}" for number in vector)
