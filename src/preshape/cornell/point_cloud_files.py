"""The measured points of an image: `pcdNNNN.txt`, ASCII in the format PCD."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.text_files import damaged, read_lines

MILLIMETRE = 0.001
NEEDED_FIELDS = ("x", "y", "z", "index")


def read_point_cloud(path: Path) -> Float64[np.ndarray, "h w 3"]:
    """Points of the pixels (m, frame of the robot's base); NaN where there are none.

    The file holds millimetres for the pixels that were measured. Its field `index` counts pixels row by row.

    Raises:
        InputError: if the file cannot be read, is truncated or is no such file.
    """
    lines = read_lines(path)
    start = next((i for i, line in enumerate(lines) if line.split()[0] == "DATA"), None)
    if start is None or lines[start].split() != ["DATA", "ascii"]:
        raise damaged(path, "it has no line `DATA ascii`, which ends the head of a PCD file")
    fields, count = _head(path, lines[:start])
    rows = lines[start + 1 :]
    if len(rows) != count:
        raise damaged(path, f"it has {len(rows)} of {count} points")
    try:
        values = np.loadtxt(rows, dtype=np.float64, ndmin=2, comments=None)
    except ValueError as error:
        raise damaged(path, f"a point is not written in numbers ({error})") from error
    if values.shape != (count, len(fields)):
        raise damaged(path, f"its points have {values.shape[-1]} numbers, its head names {len(fields)}")
    x, y, z, index = (values[:, fields.index(name)] for name in NEEDED_FIELDS)
    whole = (index >= 0) & (index < WIDTH * HEIGHT) & (index == np.floor(index))
    if not whole.all() or len(np.unique(index)) != count:
        raise damaged(path, "the indices of its points are not different pixels of the image")
    cloud = np.full((HEIGHT * WIDTH, 3), np.nan)
    cloud[index.astype(int)] = np.stack((x, y, z), axis=1) * MILLIMETRE
    cloud[~np.isfinite(cloud).all(axis=1)] = np.nan
    return cloud.reshape(HEIGHT, WIDTH, 3)


def _head(path: Path, lines: Sequence[str]) -> tuple[list[str], int]:
    """Names of the fields, and how many points there are."""
    head = {key: values for key, *values in map(str.split, lines)}
    fields, points = head.get("FIELDS", []), head.get("POINTS", [])
    if not set(NEEDED_FIELDS) <= set(fields) or len(set(fields)) != len(fields):
        raise damaged(path, f"its fields are {' '.join(fields)[:60] or 'not named'}, not x y z rgb index")
    if len(points) != 1 or not points[0].isdecimal() or not 0 < int(points[0]) <= WIDTH * HEIGHT:
        raise damaged(path, f"it does not say how many points it has, up to {WIDTH * HEIGHT}")
    return fields, int(points[0])
