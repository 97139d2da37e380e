"""What C's allocator does with memory that is freed."""

import platform
import subprocess
import sys

import pytest

COUNT = """
import resource, torch
from preshape.command_line.allocator import keep_freed_memory
{call}
for _ in range(12):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    torch.zeros(8, 8, 400, 400)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def new_pages(call: str) -> int:
    """How many pages another large tensor takes from the system."""
    ran = subprocess.run([sys.executable, "-c", COUNT.format(call=call)], capture_output=True, check=True)
    return int(ran.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="glibc's parameters")
def test_large_tensors_take_pages_that_were_freed() -> None:
    assert new_pages("") > 10  # huge pages of 2 MB at the least
    assert new_pages("keep_freed_memory()") == 0
