"""One image with its labels in the layout of the Cornell grasp data set."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from PIL import Image

from preshape.cornell.layout import CLOUD, COLOUR, NEGATIVES, POSITIVES
from preshape.cornell.rectangle import GraspRectangle
from preshape.files import atomic_path
from preshape.geometry.pose import transform_points
from preshape.perception.observation import Observation

HEAD = """# .PCD v.7 - Point Cloud Data file format
FIELDS x y z rgb index
SIZE 4 4 4 4 4
TYPE F F F F U
COUNT 1 1 1 1 1
WIDTH {n}
HEIGHT 1
POINTS {n}
DATA ascii"""
MILLIMETRES = 1000


def image_paths(folder: Path, number: int) -> dict[str, Path]:
    """The files of an image by the ends of their names; the last of them is written last."""
    kinds = (COLOUR, CLOUD, NEGATIVES, POSITIVES)
    return {kind: folder / f"pcd{number:04d}{kind}" for kind in kinds}


def write_image(
    folder: Path,
    number: int,
    view: Observation,
    positives: Sequence[GraspRectangle],
    negatives: Sequence[GraspRectangle],
    T_base_world: Float[np.ndarray, "4 4"],
    shown: Bool[np.ndarray, "h w"],
) -> None:
    """Write an image, each file atomically.

    Args:
        folder: where.
        number: of the image, at most 9999.
        view: what the camera saw.
        positives, negatives: rectangles that lifted and that did not.
        T_base_world: the frame in which points are written.
        shown: pixels whose points are written, where their depth is known.

    Raises:
        InputError: if the place cannot be written to.
    """
    paths = image_paths(folder, number)
    with atomic_path(paths[COLOUR]) as temporary:
        Image.fromarray(view.rgb).save(temporary, format="PNG")
    with atomic_path(paths[CLOUD]) as temporary:
        _write_cloud(temporary, view, T_base_world, shown)
    for kind, rectangles in ((NEGATIVES, negatives), (POSITIVES, positives)):
        with atomic_path(paths[kind]) as temporary:
            temporary.write_text("".join(map(_lines, rectangles)), encoding="ascii")


def _write_cloud(
    path: Path, view: Observation, T_base_world: Float[np.ndarray, "4 4"], shown: Bool[np.ndarray, "h w"]
) -> None:
    known = np.flatnonzero(shown & np.isfinite(view.depth))
    points = view.camera.unproject(view.depth.astype(np.float64)).reshape(-1, 3)[known]
    in_base = transform_points(T_base_world @ view.camera.T_world_camera, points)
    rows = np.column_stack((MILLIMETRES * in_base, np.zeros(len(known)), known))
    np.savetxt(path, rows, fmt="%.2f %.2f %.2f %d %d", header=HEAD.format(n=len(known)), comments="")


def _lines(rectangle: GraspRectangle) -> str:
    return "".join(f"{u:.3f} {v:.3f} \n" for u, v in rectangle.corners())
