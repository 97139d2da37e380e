"""What C's allocator does with memory that is freed."""

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Parameters of glibc's `mallopt`, from its malloc.h."""
_LARGE = 2**30


def keep_freed_memory() -> None:
    """Let this process keep what it frees, for what it allocates next; elsewhere than under glibc do nothing.

    Otherwise large tensors are new pages in every training step, which the system first fills with zeros.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, _LARGE)
        mallopt(M_TRIM_THRESHOLD, 2 * _LARGE - 1)
