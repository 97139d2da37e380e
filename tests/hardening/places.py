"""Good and bad input for every command, made once in a folder."""

import json
import os
import pickle
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import torch
import trimesh
from synthetic_cornell import write_cornell
from synthetic_evaluation import write_evaluation
from synthetic_scenes import BoxRenderer, allegro_space, make_scene, write_data_set
from trained_folds import write_record, write_rectangle_folds, write_sweep

from preshape.data.tables import SCENES_FILE, TRIALS_FILE
from preshape.files import read_json, write_json
from preshape.models.checkpoints import save_weights
from preshape.models.config_cnn import ConfigCNN
from preshape.models.palm_points import PalmPoints
from preshape.paths import project_root
from preshape.perception.view_files import save_view
from preshape.planning.mixture_density_network import MixtureDensityNetwork
from preshape.planning.prior import GraspPrior

DAMAGES = ("missing", "a folder", "empty", "cut off", "noise", "a pickle", "another kind")
DAMAGES_OF_MORE = ("missing", "cut off", "another kind")
"""For the smaller files of a folder."""


class Payload:
    """An object whose pickle makes a file when it is loaded."""

    def __init__(self, mark: Path) -> None:
        self._mark = mark

    def __reduce__(self) -> tuple[Callable[[str], int], tuple[str]]:
        return os.system, (f"touch {self._mark}",)


def make_inputs(place: Path) -> None:
    """Write the good inputs: view, depth, weights, tables, priors, evaluation, meshes, images, folds."""
    torch.manual_seed(0)
    space = allegro_space()
    view = BoxRenderer()(make_scene(0))
    save_view(place / "view", view)
    np.save(place / "depth.npy", view.depth)
    for name, network in (
        ("palm_points", PalmPoints("palm_points", space.name, space.dim)),
        ("config_cnn", ConfigCNN("config_cnn", space.name, space.dim)),
    ):
        save_weights(
            place / f"{name}.safetensors", network, data_hash="none", git_revision="none", metrics={}
        )
    write_data_set(place / "table", 15)
    _write_priors(place)
    write_evaluation(place / "evaluation", 3)
    _write_rounds(place / "improvement.json")
    effort = {"executed": 330, "seconds": 3600.0, "workers": 2, "executed_per_hour": 330.0}
    write_json(place / "effort.json", effort)
    write_json(
        place / "metrics.json", {"auc": {"value": 0.8, "low": 0.7, "high": 0.9}, "n": 9, "positives": 3}
    )
    write_cornell(place / "cornell", n=5, cloud=True)
    write_rectangle_folds(place / "folds", place / "cornell")
    write_sweep(place / "sweep")
    write_record(place / "record", place / "sweep")
    _write_rectangles(place / "rectangles")
    (place / "meshes").mkdir()
    trimesh.creation.box((0.05, 0.06, 0.1)).export(place / "meshes" / "box.obj")
    (place / "grocery.csv").write_text("name,family\nbox_0,box\n")


def _write_priors(place: Path) -> None:
    features = 9 + 8
    prior = GraspPrior(
        "allegro_palm14",
        torch.zeros(1, dtype=torch.float64),
        torch.zeros(1, features, dtype=torch.float64),
        torch.eye(features, dtype=torch.float64)[None],
    )
    prior.write(place / "prior.json")
    network = MixtureDensityNetwork.beginning_with(prior, torch.Generator().manual_seed(0))
    network.write(place / "prior.safetensors")


def _write_rounds(path: Path) -> None:
    """The shipped first rounds of learning from planned grasps, as `sim/improve.py` leaves them."""
    rounds = read_json(project_root() / "results" / "planning.json")["rounds"][:2]
    for entry in rounds:
        acquisition = entry.pop("acquisition")
    write_json(path, {"acquisition": acquisition, "rounds": rounds})


def _write_rectangles(place: Path) -> None:
    """The first two scenes of the shipped table of rectangles in which something lifted."""
    place.mkdir()
    shipped = project_root() / "data" / "sim_cornell"
    trials = pq.read_table(shipped / TRIALS_FILE)
    lifted = trials.filter(pc.field("outcome") == "lifted")["scene_id"].unique()[:2]
    for name in (SCENES_FILE, TRIALS_FILE):
        own = pq.read_table(shipped / name).filter(pc.field("scene_id").isin(lifted))
        pq.write_table(own, place / name)


def damaged(good: Path, how: str, place: Path, mark: Path, file: str | None = None) -> Path:
    """A damaged copy in `place` of a file, or of a folder in which a file is damaged.

    Args:
        good: what is copied.
        how: one of `DAMAGES`.
        place: a folder that is made for it.
        mark: the file that a pickle makes when it is executed.
        file: which file of a folder; None for the largest.
    """
    place.mkdir(parents=True)
    if good.is_dir():
        copy = place / good.name
        shutil.copytree(good, copy)
        files = (path for path in copy.rglob("*") if path.is_file())
        wrong = copy / file if file else max(files, key=lambda path: path.stat().st_size)
        _damage(wrong, how, mark)
        return copy
    for path in (good, good.with_name(f"{good.name}.json")):  # a sidecar goes with its weights
        if path.is_file():
            shutil.copy(path, place)
    _damage(place / good.name, how, mark)
    return place / good.name


def _damage(path: Path, how: str, mark: Path) -> None:
    content = path.read_bytes()
    path.unlink()
    if how == "a folder":
        path.mkdir()
    elif how == "empty":
        path.touch()
    elif how == "cut off":
        path.write_bytes(content[: len(content) // 2])
    elif how == "noise":
        path.write_bytes(np.random.default_rng(0).bytes(len(content)))
    elif how == "a pickle":
        path.write_bytes(pickle.dumps(Payload(mark)))
    elif how == "another kind":
        _another_kind(path)


def _another_kind(path: Path) -> None:
    if path.suffix == ".json":
        path.write_text(json.dumps({"_target_": "os.system", "command": "true"}))
    elif path.suffix == ".parquet":
        pq.write_table(pa.table({"x": [1, 2]}), path)
    elif path.suffix == ".npy":
        np.save(path, np.zeros(3))
    else:
        path.write_text("name,value\none,2\n")
