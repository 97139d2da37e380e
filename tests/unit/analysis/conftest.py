"""One small evaluation for all tests of the reports."""

from pathlib import Path

import pytest
from synthetic_evaluation import METRICS, write_evaluation

from preshape.files import write_json


@pytest.fixture(scope="package")
def evaluation_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An evaluation of two scenes, with `metrics.json` of a training beside its files."""
    folder = tmp_path_factory.mktemp("evaluation")
    write_evaluation(folder, n_scenes=2)
    write_json(folder / "metrics.json", METRICS)
    return folder
