"""Whatever a file holds, its reader reads it or says what is wrong with it, and nothing in it is executed.

`FUZZ_EXAMPLES=2000 pytest tests/unit/test_reader_fuzzing.py` tries more.
"""

import hashlib
import json
import os
import struct
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import trimesh
from file_damage import damaged_bytes, damaged_json, damaged_json_text, damaged_table, with_metadata
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from synthetic_cornell import write_cornell
from synthetic_evaluation import write_evaluation
from synthetic_finished_scenes import finished_scene
from synthetic_folds import write_fold
from synthetic_scenes import BoxRenderer, allegro_space, make_scene, write_data_set

from analysis.dataset.grasps import read_families
from analysis.evaluation_folder import read_evaluation
from analysis.learning.charts import training_curves
from analysis.learning.fold_record import FoldRecord
from analysis.learning.runs import read_runs
from analysis.training_metrics import read_training_metrics
from preshape.cornell.image_files import read_colour, read_range
from preshape.cornell.object_list import read_object_list
from preshape.cornell.point_cloud_files import read_point_cloud
from preshape.cornell.rectangle_files import read_rectangles
from preshape.data.tables import read_data_set
from preshape.errors import InputError
from preshape.files import write_json
from preshape.models.checkpoints import load_weights, save_weights, sidecar_path
from preshape.models.success_model import GraspNetwork
from preshape.perception.camera_files import read_camera
from preshape.perception.view_choice import load_chosen_view
from preshape.perception.view_files import save_view
from preshape.planning.mixture_density_network import MixtureDensityNetwork
from preshape.planning.plan_files import read_plan
from preshape.planning.prior import GraspPrior
from preshape.planning.prior_choice import read_prior
from sim.finished_scenes import SceneBlock
from sim.objects.mesh_files import read_mesh_file
from sim.objects.urdf import read_object_urdf

SPACE = allegro_space()
URDF = (
    b'<robot name="thing"><link name="base"><inertial><mass value=".25"/></inertial><visual>'
    b'<origin xyz="0 0 0.01" rpy="0 0 1"/><geometry><mesh filename="a.obj" scale="1 1 1"/></geometry>'
    b'<material name="red"><color rgba="1 0 0 1"/></material></visual></link></robot>'
)


class OneLayer(GraspNetwork):
    """The smallest network whose weights can be kept."""

    def __init__(self) -> None:
        super().__init__("one_layer", SPACE.name, SPACE.dim)
        self.layer = torch.nn.Linear(SPACE.dim, 1)


Damage = Callable[[bytes], st.SearchStrategy[bytes]]
"""Makes the strategy of damaged contents from the good one."""


@dataclass(frozen=True)
class Reader:
    """A reader of files.

    Args:
        file: the file that is damaged, below the folder of good files.
        read: reads the folder.
        damage: how it is damaged.
        known: damage that was once not refused.
    """

    file: str
    read: Callable[[Path], Any]
    damage: Damage = damaged_bytes
    known: tuple[Callable[[bytes], bytes], ...] = ()


def use_plan(path: Path) -> None:
    plan = read_plan(path, SPACE)
    assert plan.result.theta[plan.result.best].shape == (SPACE.dim,)


def use_evaluation(folder: Path) -> None:
    assert read_evaluation(folder / "evaluation", SPACE).lifted


def use_fold_record(folder: Path) -> None:
    runs = read_runs(FoldRecord(folder / "record"), ["paper"])
    training_curves(runs)
    for run in runs:
        assert run.figures()["n"] == len(run.predictions()[0])


def damaged_safetensors(content: bytes) -> st.SearchStrategy[bytes]:
    """As bytes, or with a changed head."""
    (length,) = struct.unpack("<Q", content[:8])
    head, body = json.loads(content[8 : 8 + length]), content[8 + length :]

    def with_head(changed: Any) -> bytes:
        text = json.dumps(changed).encode()
        return struct.pack("<Q", len(text)) + text + body

    return st.one_of(damaged_json(head).map(with_head), damaged_bytes(content))


def read_weights(folder: Path) -> None:
    load_weights(folder / "model.safetensors", OneLayer())


def read_weights_whatever_their_digest(folder: Path) -> None:
    weights = folder / "model.safetensors"
    about = json.loads(sidecar_path(weights).read_text())
    about["weights_sha256"] = hashlib.sha256(weights.read_bytes()).hexdigest()
    sidecar_path(weights).write_text(json.dumps(about))
    load_weights(weights, OneLayer())


def of_file(
    file: str,
    read: Callable[[Path], Any],
    damage: Damage = damaged_bytes,
    known: tuple[Callable[[bytes], bytes], ...] = (),
) -> Reader:
    """A reader of a single file."""
    return Reader(file, lambda folder: read(folder / file), damage, known)


READERS = (
    Reader("view/rgb.png", lambda folder: load_chosen_view(folder / "view")),
    Reader("view/depth.png", lambda folder: load_chosen_view(folder / "view")),
    Reader(
        "depth.npy",
        lambda folder: load_chosen_view(folder / "view", depth_file=folder / "depth.npy"),
        known=(lambda good: good.replace(b"}", b" ", 1), lambda good: good.replace(b"'", b"\0", 1)),
    ),
    of_file("view/camera.json", read_camera, damaged_json_text),
    *(
        Reader(
            f"table/{name}.parquet",
            lambda folder: read_data_set(folder / "table", SPACE),
            damaged_table,
            known=(lambda good: with_metadata(good, [1, 2]),),
        )
        for name in ("scenes", "trials")
    ),
    Reader(
        "model.safetensors.json",
        read_weights,
        damaged_json_text,
        known=(lambda good: good.replace(b'"image_mean": [', b'"image_mean": ["x",'),),
    ),
    Reader("model.safetensors", read_weights_whatever_their_digest, damaged_safetensors),
    of_file("prior.json", read_prior, damaged_json_text),
    of_file("prior.safetensors", read_prior, damaged_safetensors),
    of_file("plan.json", use_plan, damaged_json_text),
    Reader("evaluation/evaluation.json", use_evaluation, damaged_json_text),
    of_file("metrics.json", read_training_metrics, damaged_json_text),
    Reader("record/paper/seen_fold0/metrics.json", use_fold_record, damaged_json_text),
    Reader("record/paper/seen_fold0/curves.json", use_fold_record, damaged_json_text),
    Reader("record/paper/seen_fold0/predictions.parquet", use_fold_record),
    of_file("families.csv", read_families, known=(lambda good: good[:-5] + b"\nlonely",)),
    of_file("cornell/01/pcd0100r.png", read_colour),
    of_file("cornell/01/pcd0100d.tiff", read_range),
    of_file("cornell/01/pcd0100cpos.txt", read_rectangles),
    of_file("cornell/01/pcd0100.txt", read_point_cloud),
    of_file("cornell/processedData/z.txt", read_object_list),
    of_file("scenes.jsonl", lambda path: SceneBlock(path, range(8)).read()),
    of_file("thing.urdf", read_object_urdf, known=(lambda good: good.replace(b" rgba", b" rgb"),)),
    of_file("box.obj", read_mesh_file),
    of_file("box.ply", read_mesh_file, known=(lambda good: good[:-1] + b"\x7f",)),
    of_file("box.stl", read_mesh_file),
)


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one good file of each kind."""
    folder = tmp_path_factory.mktemp("good")
    view = BoxRenderer()(make_scene(0))
    save_view(folder / "view", view)
    np.save(folder / "depth.npy", view.depth.astype(np.float16))
    write_data_set(folder / "table", 2)
    save_weights(folder / "model.safetensors", OneLayer(), data_hash="", git_revision="", metrics={"auc": {}})
    features = 9 + len(SPACE.joint_names)
    parts = (torch.zeros(1), torch.zeros(1, features), torch.eye(features)[None])
    prior = GraspPrior(SPACE.name, *(part.double() for part in parts))
    prior.write(folder / "prior.json")
    MixtureDensityNetwork.beginning_with(prior, torch.Generator()).write(folder / "prior.safetensors")
    write_evaluation(folder / "evaluation", 1)
    (folder / "plan.json").write_bytes((folder / "evaluation/plans/0_inference.json").read_bytes())
    write_json(folder / "metrics.json", {"auc": {"value": 0.8, "low": 0.7, "high": 0.9}, "n": 9})
    for fold in (0, 1):
        write_fold(folder / "record" / "paper" / f"seen_fold{fold}")
    (folder / "families.csv").write_text("name,family\nbox_0,box\nbox_1,a_carton\n")
    write_cornell(folder / "cornell", n=1)
    block = SceneBlock(folder / "scenes.jsonl", range(8))
    assert block.claim()
    block.add(finished_scene(0))
    block.release()
    (folder / "thing.urdf").write_bytes(URDF)
    for kind in ("obj", "ply", "stl"):
        trimesh.creation.box((0.05, 0.06, 0.1)).export(folder / f"box.{kind}")
    return folder


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.file)
def test_damage_is_refused_or_read(reader: Reader, good: Path) -> None:
    path = good / reader.file
    content = path.read_bytes()
    reader.read(good)

    def is_refused_or_read(damaged: bytes) -> None:
        path.write_bytes(damaged)
        with suppress(InputError):
            reader.read(good)

    @settings(
        max_examples=int(os.environ.get("FUZZ_EXAMPLES", "12")),
        derandomize="FUZZ_EXAMPLES" not in os.environ,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(reader.damage(content))
    def all_are_refused_or_read(damaged: bytes) -> None:
        is_refused_or_read(damaged)

    try:
        for known in reader.known:
            assert known(content) != content
            is_refused_or_read(known(content))
        all_are_refused_or_read()
    finally:
        path.write_bytes(content)
