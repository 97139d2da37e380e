"""Object views as small files that are quick to read, in part or whole.

A file has two parts, each after its CRC-32 in 4 bytes. The first, of fixed size, is the cloud: pose of the
box in 16 doubles, table in 4, points in single precision. The second is an LZ4 frame with the patch: the
three colour channels in bytes, and the low and then the high bytes of the other channels in half precision.
Apart, the high bytes compress well. LZ4 takes a little more space than Zstandard and half of its time.
"""

import struct
import zlib

import numpy as np
import pyarrow as pa
from jaxtyping import Float, Float16

from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.object_view import CLOUD_SIZE, PATCH_SIZE, ObjectCloud, ObjectView

SHAPE = (len(CHANNEL_NAMES), PATCH_SIZE, PATCH_SIZE)
COLOURS = 3
TYPICAL_BYTES = 1_050_000
"""Size of the file of a noisy view."""
_CHECKSUM = struct.Struct("<I")
_POSE_AND_TABLE, _POINTS = 20, 3 * CLOUD_SIZE
CLOUD_BYTES = _CHECKSUM.size + 8 * _POSE_AND_TABLE + 4 * _POINTS
"""Size of the first part, which is enough to read the cloud."""
_CODEC = pa.Codec("lz4")
_PIXELS = PATCH_SIZE**2
_N_COLOUR, _N_OTHER = COLOURS * _PIXELS, (SHAPE[0] - COLOURS) * _PIXELS
_HALVES = (np.arange(256, dtype=np.float32) / 255).astype(np.float16)
"""Brightness of each colour byte."""


def encode(view: ObjectView) -> bytes:
    """Content of the file of a view; what is read back is its patch in half precision, to the bit."""
    cloud = view.cloud
    head = np.concatenate((cloud.T_camera_box.ravel(), cloud.table)).astype("<f8").tobytes()
    return _checked(head + cloud.points.astype("<f4").tobytes()) + _checked(_encode_patch(view.channels))


def decode_cloud(content: bytes) -> ObjectCloud | None:
    """The cloud in the first `CLOUD_BYTES` of a file; None if they were altered or cut off."""
    head = _check(memoryview(content)[:CLOUD_BYTES])
    if head is None or len(content) < CLOUD_BYTES:
        return None
    numbers = np.frombuffer(head, dtype="<f8", count=_POSE_AND_TABLE)
    points = np.frombuffer(head, dtype="<f4", count=_POINTS, offset=numbers.nbytes)
    return ObjectCloud(points.reshape(-1, 3), numbers[16:], numbers[:16].reshape(4, 4))


def decode(content: bytes) -> ObjectView | None:
    """The view in a file's content, its patch in half precision; None if that was altered or cut off."""
    cloud, frame = decode_cloud(content), _check(memoryview(content)[CLOUD_BYTES:])
    return None if cloud is None or frame is None else ObjectView(_decode_patch(frame), cloud)


def _checked(part: bytes) -> bytes:
    return _CHECKSUM.pack(zlib.crc32(part)) + part


def _check(part: memoryview) -> memoryview | None:
    """What stands after a checksum; None if it is not that of the rest."""
    rest = part[_CHECKSUM.size :]
    return rest if len(rest) and _CHECKSUM.unpack_from(part)[0] == zlib.crc32(rest) else None


def _encode_patch(channels: Float[np.ndarray, "8 h w"]) -> bytes:
    colours = np.rint(channels[:COLOURS] * 255).astype(np.uint8)
    others = channels[COLOURS:].astype("<f2").view(np.uint8).reshape(_N_OTHER, 2)
    frame: bytes = _CODEC.compress(
        np.concatenate((colours.ravel(), others.T.ravel())).tobytes(), asbytes=True
    )
    return frame


def _decode_patch(frame: memoryview) -> Float16[np.ndarray, "8 h w"]:
    read = np.frombuffer(_CODEC.decompress(frame, _N_COLOUR + 2 * _N_OTHER), dtype=np.uint8)
    low, high = read[_N_COLOUR:].reshape(2, _N_OTHER)
    patch = np.empty(SHAPE, dtype=np.float16)
    np.take(_HALVES, read[:_N_COLOUR], out=patch[:COLOURS].reshape(-1), mode="clip")
    others = patch[COLOURS:].reshape(-1).view(np.uint16)
    np.left_shift(high, 8, out=others, dtype=np.uint16)
    others |= low
    return patch
