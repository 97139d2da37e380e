"""Object views as small files that are quick to read: one with the cloud, one with the patch.

Each begins with the CRC-32 of the rest in 4 bytes. A cloud is the pose of the box in 16 doubles, the table
in 4, and the points in single precision. A patch is an LZ4 frame with the three colour channels in bytes, and
the low and then the high bytes of the other channels in half precision. Apart, the high bytes compress well.
LZ4 takes a little more space than Zstandard and half of its time.
"""

import struct
import zlib

import numpy as np
import pyarrow as pa
from jaxtyping import Float16

from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.object_view import CLOUD_SIZE, PATCH_SIZE, ObjectCloud

SHAPE = (len(CHANNEL_NAMES), PATCH_SIZE, PATCH_SIZE)
COLOURS = 3
TYPICAL_PATCH_BYTES = 1_050_000
"""Size of the file of a noisy view's patch."""
_CHECKSUM = struct.Struct("<I")
_POSE_AND_TABLE, _POINTS = 20, 3 * CLOUD_SIZE
CLOUD_BYTES = _CHECKSUM.size + 8 * _POSE_AND_TABLE + 4 * _POINTS
"""Size of the file of a cloud."""
_CODEC = pa.Codec("lz4")
_PIXELS = PATCH_SIZE**2
_N_COLOUR, _N_OTHER = COLOURS * _PIXELS, (SHAPE[0] - COLOURS) * _PIXELS
_HALVES = (np.arange(256, dtype=np.float32) / 255).astype(np.float16)
"""Brightness of each colour byte."""


def encode_cloud(cloud: ObjectCloud) -> bytes:
    """Content of the file of a cloud."""
    head = np.concatenate((cloud.T_camera_box.ravel(), cloud.table)).astype("<f8").tobytes()
    return _checked(head + cloud.points.astype("<f4").tobytes())


def decode_cloud(content: bytes) -> ObjectCloud | None:
    """The cloud in a file's content; None if that was altered or cut off."""
    known = _check(content)
    if known is None:
        return None
    numbers = np.frombuffer(known, dtype="<f8", count=_POSE_AND_TABLE)
    points = np.frombuffer(known, dtype="<f4", count=_POINTS, offset=numbers.nbytes)
    return ObjectCloud(points.reshape(-1, 3), numbers[16:], numbers[:16].reshape(4, 4))


def encode_patch(patch: Float16[np.ndarray, "8 h w"]) -> bytes:
    """Content of the file of a patch, which is read back to the bit."""
    colours = np.rint(patch[:COLOURS].astype(np.float32) * 255).astype(np.uint8)
    others = patch[COLOURS:].astype("<f2").view(np.uint8).reshape(_N_OTHER, 2)
    frame: bytes = _CODEC.compress(
        np.concatenate((colours.ravel(), others.T.ravel())).tobytes(), asbytes=True
    )
    return _checked(frame)


def decode_patch(content: bytes) -> Float16[np.ndarray, "8 h w"] | None:
    """The patch in a file's content; None if that was altered or cut off."""
    frame = _check(content)
    if frame is None:
        return None
    read = np.frombuffer(_CODEC.decompress(frame, _N_COLOUR + 2 * _N_OTHER), dtype=np.uint8)
    low, high = read[_N_COLOUR:].reshape(2, _N_OTHER)
    patch = np.empty(SHAPE, dtype=np.float16)
    np.take(_HALVES, read[:_N_COLOUR], out=patch[:COLOURS].reshape(-1), mode="clip")
    others = patch[COLOURS:].reshape(-1).view(np.uint16)
    np.left_shift(high, 8, out=others, dtype=np.uint16)
    others |= low
    return patch


def _checked(content: bytes) -> bytes:
    return _CHECKSUM.pack(zlib.crc32(content)) + content


def _check(content: bytes) -> memoryview | None:
    """What stands after a checksum; None if it is not that of the rest."""
    rest = memoryview(content)[_CHECKSUM.size :]
    return rest if len(rest) and _CHECKSUM.unpack_from(content)[0] == zlib.crc32(rest) else None
