"""Folders of a sweep are the same whenever it is started again, and tell settings apart."""

from preshape.sweeps.sweep_folders import LONGEST, sweep_group


def test_a_group_is_the_run_and_what_else_was_chosen() -> None:
    fold = ["model=config_cnn", "split=seen", "fold=3", "paths.data=/data", "experiment=paper"]
    assert sweep_group("paper_config_cnn", fold) == "paper_config_cnn"
    assert sweep_group("config_cnn", [*fold, "retrain_after_code_changes=false"]) == "config_cnn"
    assert sweep_group("config_cnn", [*fold, "dataset.data.trials=500"]) == "config_cnn,trials=500"
    assert sweep_group("config_cnn", [*fold, "model.members=1"]) == "config_cnn,members=1"
    assert sweep_group("mine", [*fold, "run_name=mine"]) == "mine,model=config_cnn"
    assert "/" not in sweep_group("config_cnn", ["weights=a/b"])


def test_settings_are_told_apart_whatever_their_order_and_length() -> None:
    long = [f"a.key{number}={number}" for number in range(20)]
    first, again = sweep_group("run", long), sweep_group("run", long[::-1])
    assert first == again
    assert len(first) <= LONGEST
    assert sweep_group("run", [*long[1:], "a.key0=1"]) != first
    assert sweep_group("run", ["a.seed=1", "b.seed=2"]) != sweep_group("run", ["a.seed=2", "b.seed=1"])
