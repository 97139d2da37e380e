"""Files of figures and predictions that are others than they should be are refused."""

from pathlib import Path

import pandas as pd
import pytest

from preshape.errors import InputError
from preshape.evaluation.measured_files import read_figures, read_predictions
from preshape.files import write_json


def test_what_a_file_does_not_say_is_named(tmp_path: Path) -> None:
    write_json(tmp_path / "figures.json", {"n": 3})
    assert read_figures(tmp_path / "figures.json", "n") == {"n": 3}
    with pytest.raises(InputError, match="does not say auc, ap"):
        read_figures(tmp_path / "figures.json", "auc", "n", "ap")


def test_only_tables_of_predictions_are_read(tmp_path: Path) -> None:
    path = tmp_path / "predictions.parquet"
    for columns in ({"lifted": [True], "success_prob": [0.5]}, {"theta_predicted": [[0.1, 0.2]]}):
        pd.DataFrame(columns).to_parquet(path)
        assert set(read_predictions(path)) == set(columns)
    pd.DataFrame({"x": [1]}).to_parquet(path)
    with pytest.raises(InputError, match="holds no predictions"):
        read_predictions(path)
    path.write_bytes(path.read_bytes()[:20])
    with pytest.raises(InputError, match="cannot be read"):
        read_predictions(path)
