"""The real images, where someone has them."""

from pathlib import Path

import pytest

SAMPLE = Path(__file__).parents[4] / "shared" / "data" / "cornell"


@pytest.fixture
def cornell_sample() -> Path:
    """Folder with a part of the data set; it is not part of the project."""
    if not SAMPLE.is_dir():
        pytest.skip(f"needs images of the Cornell grasp data set in {SAMPLE}")
    return SAMPLE
