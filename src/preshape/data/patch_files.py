"""Object patches as small files that are quick to read.

A file is a CRC-32 of the rest, in 4 bytes, the pose of the object's box in 16 doubles, and then an LZ4 frame:
the three colour channels in bytes, and the low and then the high bytes of the other channels in half
precision. Apart, the high bytes compress well. LZ4 takes a little more space than Zstandard and half of its
time.
"""

import struct
import zlib

import numpy as np
import pyarrow as pa

from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.patch import PATCH_SIZE, ObjectPatch

SHAPE = (len(CHANNEL_NAMES), PATCH_SIZE, PATCH_SIZE)
COLOURS = 3
TYPICAL_BYTES = 1_050_000
"""Size of the file of a noisy view."""
_CHECKSUM = struct.Struct("<I")
_POSE = struct.Struct("<16d")
_HEADER = _CHECKSUM.size + _POSE.size
_CODEC = pa.Codec("lz4")
_PIXELS = PATCH_SIZE**2
_N_COLOUR, _N_OTHER = COLOURS * _PIXELS, (SHAPE[0] - COLOURS) * _PIXELS
_HALVES = (np.arange(256, dtype=np.float32) / 255).astype(np.float16)
"""Brightness of each colour byte."""


def encode(patch: ObjectPatch) -> bytes:
    """Content of the file of a patch; what is read back is the patch in half precision, to the bit."""
    colours = np.rint(patch.channels[:COLOURS] * 255).astype(np.uint8)
    others = patch.channels[COLOURS:].astype("<f2").view(np.uint8).reshape(_N_OTHER, 2)
    raw = np.concatenate((colours.ravel(), others.T.ravel())).tobytes()
    content: bytes = _POSE.pack(*patch.T_camera_box.ravel()) + _CODEC.compress(raw, asbytes=True)
    return _CHECKSUM.pack(zlib.crc32(content)) + content


def decode(content: bytes) -> ObjectPatch | None:
    """The patch in a file's content, in half precision; None if that was altered or cut off."""
    checked = memoryview(content)[_CHECKSUM.size :]
    if len(content) <= _HEADER or _CHECKSUM.unpack_from(content)[0] != zlib.crc32(checked):
        return None
    pose = np.array(_POSE.unpack_from(checked)).reshape(4, 4)
    frame = checked[_POSE.size :]
    read = np.frombuffer(_CODEC.decompress(frame, _N_COLOUR + 2 * _N_OTHER), dtype=np.uint8)
    low, high = read[_N_COLOUR:].reshape(2, _N_OTHER)
    patch = np.empty(SHAPE, dtype=np.float16)
    np.take(_HALVES, read[:_N_COLOUR], out=patch[:COLOURS].reshape(-1), mode="clip")
    others = patch[COLOURS:].reshape(-1).view(np.uint16)
    np.left_shift(high, 8, out=others, dtype=np.uint16)
    others |= low
    return ObjectPatch(patch, pose)
