"""Numbers from HDF5 files of others: plain arrays that lie in the file itself, and nothing else."""

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from jaxtyping import Shaped

from preshape.errors import InputError

Shape = tuple[int | None, ...]
MOST_NUMBERS = 2**24
"""No array may be larger, whatever a damaged file claims."""


def read_hdf5(
    path: Path, shapes: Mapping[str, Shape], optional: Collection[str] = ()
) -> dict[str, Shaped[np.ndarray, "..."]]:
    """Arrays of integers or floats at the root of an HDF5 file.

    Objects, references, strings and whatever lies outside of the file (external links and storage, virtual
    data sets) are refused unread, so that a file is nothing but data.

    Args:
        path: the file.
        shapes: name of each array -> its shape; None stands for any length, and (1,) also
            for a bare number.
        optional: names of arrays that may be missing.

    Raises:
        InputError: the file is missing, truncated, damaged or not HDF5, or an array is missing, of another
            shape, or not of numbers.
    """
    try:
        # Nothing is written, and network folders often cannot lock.
        with h5py.File(path, "r", locking=False) as file:
            wanted = [name for name in shapes if name in file or name not in optional]
            return {name: _read(file, name, shapes[name], path) for name in wanted}
    except InputError:
        raise
    except FileNotFoundError as error:
        raise InputError("The file does not exist", where=path, fix="check the path") from error
    except Exception as error:  # damage surfaces as whatever the HDF5 library trips over
        raise _unusable("cannot be read: it is truncated, damaged or not HDF5", path) from error


def _read(file: Any, name: str, shape: Shape, path: Path) -> Shaped[np.ndarray, "..."]:
    if name not in file:
        raise _unusable(f"lacks {name}", path)
    if not isinstance(file.get(name, getlink=True), h5py.HardLink):
        raise _unusable(f"only points to where {name} should be", path)
    data = file[name]
    if not isinstance(data, h5py.Dataset) or data.dtype.kind not in "uif":
        raise _unusable(f"does not hold numbers in {name}", path)
    if data.is_virtual or data.external:
        raise _unusable(f"keeps {name} in another file", path)
    if not _fits(data.shape, shape) or not 0 < data.size <= MOST_NUMBERS:
        raise _unusable(f"holds {name} in the shape {data.shape}", path)
    values = np.asarray(data[...])
    return values.reshape(1) if shape == (1,) else values


def _fits(found: tuple[int, ...], wanted: Shape) -> bool:
    if wanted == (1,):
        return math.prod(found) == 1
    return len(found) == len(wanted) and all(
        length in (None, there) for there, length in zip(found, wanted, strict=True)
    )


def _unusable(what: str, path: Path) -> InputError:
    return InputError(f"The HDF5 file {what}", where=path, fix="extract or download it again")
