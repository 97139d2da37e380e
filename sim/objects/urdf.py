"""Reading an object from a URDF: one rigid link with meshes and a mass."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from lxml import etree
from scipy.spatial.transform import Rotation

from preshape.errors import InputError
from preshape.geometry.pose import make_pose
from sim.objects.colour import LinearColour, linear_rgb


@dataclass(frozen=True, eq=False)
class UrdfMesh:
    """A mesh that a URDF names.

    Args:
        path: where the URDF says that the file lies; it need not be there.
        scale: factors along the mesh's axes.
        T_link_mesh: pose of the mesh in the link.
        colour: linear RGB, if the URDF gives one.
    """

    path: Path
    scale: Float[np.ndarray, "3"]
    T_link_mesh: Float[np.ndarray, "4 4"]
    colour: LinearColour | None


@dataclass(frozen=True, eq=False)
class UrdfObject:
    """The one link of an object's URDF; `mass_kg` is None where none is given."""

    mass_kg: float | None
    collisions: tuple[UrdfMesh, ...]
    visuals: tuple[UrdfMesh, ...]


def read_object_urdf(path: Path) -> UrdfObject:
    """Read the URDF of a rigid object.

    Published URDFs are often not well-formed (YCB's say version="0.0"), so what can be understood is. Nothing
    outside the file is read: no entities, no DTD, no network.

    Raises:
        InputError: if it cannot be read, has no link with meshes, or several.
    """
    parser = etree.XMLParser(recover=True, resolve_entities=False, no_network=True, load_dtd=False)
    try:
        root = etree.fromstring(path.read_bytes(), parser)
    except OSError as error:
        raise _unusable(f"The URDF cannot be read: {error.strerror}", path) from error
    except etree.XMLSyntaxError as error:
        raise _unusable(f"The URDF is not XML: {error.msg}", path) from error
    if root is None:
        raise _unusable("The URDF is not XML", path)
    links = [link for link in root.iter("link") if link.find("visual") is not None or _has_collision(link)]
    if len(links) != 1:
        raise _unusable(f"The URDF has {len(links)} links with a shape, and an object has one", path)
    try:
        return _read_link(links[0], path)
    except (AttributeError, TypeError, ValueError) as error:
        raise _unusable(f"The URDF lacks a number or holds one that is none ({error})", path) from error


def _read_link(link: etree._Element, path: Path) -> UrdfObject:
    mass = link.find("inertial/mass")
    mass_kg = None if mass is None else float(mass.get("value"))
    collisions = tuple(mesh for shape in link.findall("collision") if (mesh := _read_mesh(shape, path)))
    visuals = tuple(mesh for shape in link.findall("visual") if (mesh := _read_mesh(shape, path)))
    if not collisions and not visuals:
        raise _unusable("The URDF names no mesh", path)
    return UrdfObject(mass_kg if mass_kg and mass_kg > 0 else None, collisions, visuals)


def _read_mesh(shape: etree._Element, path: Path) -> UrdfMesh | None:
    mesh = shape.find("geometry/mesh")
    if mesh is None:
        return None
    origin = shape.find("origin")
    xyz, rpy = (
        ("0 0 0", "0 0 0") if origin is None else (origin.get("xyz", "0 0 0"), origin.get("rpy", "0 0 0"))
    )
    rotation = Rotation.from_euler("xyz", _triple(rpy)).as_matrix()
    colour = shape.find("material/color")
    return UrdfMesh(
        path=_mesh_path(mesh.get("filename", ""), path),
        scale=_triple(mesh.get("scale", "1 1 1")),
        T_link_mesh=make_pose(rotation, _triple(xyz)),
        colour=None
        if colour is None
        else linear_rgb(255 * _triple(" ".join(colour.get("rgba").split()[:3]))),
    )


def _mesh_path(filename: str, urdf: Path) -> Path:
    """The file that a URDF means: beside it, or, for package://NAME/REST, REST beside it."""
    scheme, separator, rest = filename.partition("://")
    if not separator:
        return urdf.parent / filename
    return urdf.parent / (rest.partition("/")[2] if scheme == "package" else rest)


def _triple(text: str) -> Float[np.ndarray, "3"]:
    values = np.array([float(word) for word in text.split()])
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(text)
    return values


def _has_collision(link: etree._Element) -> bool:
    return link.find("collision") is not None


def _unusable(what: str, path: Path) -> InputError:
    return InputError(what, where=path, fix="give a URDF with one link whose visual and collision are meshes")
