"""Trial and scene tables as files: the whole labelled data set, without its images.

A data set is a folder with `scenes.parquet` and `trials.parquet`. Their columns are the fields of `Scene`
and `Trial`; theta and poses are vectors of doubles, so that every number comes back to the bit. The files'
metadata names the robot, the object set, the camera and the grasp space.
"""

import hashlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from preshape.data.parquet import (
    TableFormat,
    check_columns,
    read_table,
    to_vectors,
    vector_type,
    vectors,
    write_table,
)
from preshape.data.scene import Scene
from preshape.data.trial import Face, TrialOutcome
from preshape.data.trial_table import SCALARS, THETAS, SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.files import file_hash
from preshape.geometry.camera import Camera
from preshape.grasps.space import GraspSpace

COLLECT = "python sim/collect.py"
SCENES = TableFormat("scenes", version=1, maker=COLLECT)
TRIALS = TableFormat("trials", version=2, maker=COLLECT)
SCENES_FILE, TRIALS_FILE = "scenes.parquet", "trials.parquet"

CAMERA_COLUMNS = {
    "width": pa.int64(),
    "height": pa.int64(),
    "fx": pa.float64(),
    "fy": pa.float64(),
    "cx": pa.float64(),
    "cy": pa.float64(),
}
SCENE_COLUMNS = {
    "scene_id": pa.int64(),
    "object_id": pa.string(),
    "T_world_object": vector_type(16),
    **CAMERA_COLUMNS,
    "T_world_camera": vector_type(16),
    "seed": pa.uint64(),
}
_TRIAL_TYPES = {
    "trial_id": pa.int64(),
    "scene_id": pa.int64(),
    "object_id": pa.string(),
    "planner": pa.string(),
    "face": pa.string(),
    "outcome": pa.string(),
    "seed": pa.uint64(),
}


def write_scenes(path: str | Path, table: SceneTable) -> None:
    """Write a table of scenes atomically; raises InputError if the place cannot be written to."""
    scenes = table.scenes
    columns = {
        "scene_id": [scene.scene_id for scene in scenes],
        "object_id": [scene.object_id for scene in scenes],
        "T_world_object": _poses([scene.T_world_object for scene in scenes]),
        **{name: [getattr(scene.camera, name) for scene in scenes] for name in CAMERA_COLUMNS},
        "T_world_camera": _poses([scene.camera.T_world_camera for scene in scenes]),
        "seed": [scene.seed for scene in scenes],
    }
    arrays = {name: pa.array(values, SCENE_COLUMNS[name]) for name, values in columns.items()}
    write_table(path, SCENES, arrays, {"origin": asdict(table.origin)})


def read_scenes(path: str | Path) -> SceneTable:
    """Read a table of scenes.

    Raises:
        InputError: if the file is missing, unreadable, of another kind or version, or inconsistent.
    """
    table, about = read_table(path, SCENES)
    check_columns(table, SCENE_COLUMNS, path, SCENES)
    poses = {name: to_vectors(table[name]).reshape(-1, 4, 4) for name in ("T_world_object", "T_world_camera")}
    scenes = tuple(
        Scene(
            row["scene_id"],
            row["object_id"],
            poses["T_world_object"][i],
            Camera(**{name: row[name] for name in CAMERA_COLUMNS}, T_world_camera=poses["T_world_camera"][i]),
            row["seed"],
        )
        for i, row in enumerate(table.drop_columns(list(poses)).to_pylist())
    )
    _check_unique([scene.scene_id for scene in scenes], "scene", path)
    if not all(np.isfinite(values).all() for values in poses.values()):
        raise InputError("A pose in the table of scenes is not finite", where=path, fix=f"run `{COLLECT}`")
    return SceneTable(_origin(about, path), scenes)


def write_trials(path: str | Path, table: TrialTable) -> None:
    """Write a table of trials atomically; raises InputError if the place cannot be written to."""
    types = _trial_columns(table.space)
    arrays = {name: pa.array(table.rows[name].tolist(), types[name]) for name in SCALARS}
    arrays |= {f"theta_{name}": vectors(getattr(table, name)) for name in THETAS}
    about = {"origin": asdict(table.origin), "grasp_space": _describe(table.space)}
    write_table(path, TRIALS, arrays, about)


def read_trials(path: str | Path, space: GraspSpace) -> TrialTable:
    """Read a table of trials in the given grasp space.

    Raises:
        InputError: if the file is missing, unreadable, of another kind or version, in another grasp space, or
            inconsistent.
    """
    table, about = read_table(path, TRIALS)
    _check_space(about.get("grasp_space"), space, path)
    check_columns(table, _trial_columns(space), path, TRIALS)
    thetas = (to_vectors(table[f"theta_{name}"]) for name in THETAS)
    rows = table.select(list(SCALARS)).to_pandas()
    trials = TrialTable(_origin(about, path), space, rows, *thetas)
    _check_unique(rows["trial_id"].tolist(), "trial", path)
    _check_values(trials, path)
    return trials


def read_data_set(
    folder: str | Path, space: GraspSpace, origin: TableOrigin | None = None
) -> tuple[SceneTable, TrialTable]:
    """Read the scenes and trials of a data set, and check that they belong together.

    Args:
        folder: where its two files lie.
        space: grasp space of theta.
        origin: what it must have been collected with; None for anything.

    Raises:
        InputError: as `read_scenes` and `read_trials`, and if a trial's scene is missing, or the data set has
            another origin.
    """
    folder = Path(folder)
    scenes, trials = read_scenes(folder / SCENES_FILE), read_trials(folder / TRIALS_FILE, space)
    objects = {scene.scene_id: scene.object_id for scene in scenes.scenes}
    pairs = zip(trials.scene_ids.tolist(), trials.object_ids, strict=True)
    strangers = [scene_id for scene_id, object_id in pairs if objects.get(scene_id) != object_id]
    if strangers or scenes.origin != trials.origin:
        raise InputError(
            f"{SCENES_FILE} and {TRIALS_FILE} do not match: {len(strangers)} trials lack their scene",
            where=folder,
            fix=f"take both files from one run of `{COLLECT}`",
        )
    if origin is not None and trials.origin != origin:
        raise InputError(
            f"The trials were collected with {trials.origin.choices}, "
            f"but the configuration chose {origin.choices}",
            where=folder,
            fix=f"choose {trials.origin.choices}, or another dataset",
        )
    return scenes, trials


def write_data_set(folder: str | Path, scenes: SceneTable, trials: TrialTable) -> None:
    """Write the scenes and trials of a data set, each atomically.

    Raises:
        InputError: if the folder cannot be written to.
    """
    write_scenes(Path(folder) / SCENES_FILE, scenes)
    write_trials(Path(folder) / TRIALS_FILE, trials)


def data_hash(*folders: str | Path) -> str:
    """Digest of the two files of each data set, by which a trained network names its data.

    Raises:
        InputError: if one cannot be read.
    """
    digest = hashlib.sha256()
    for folder in folders:
        for name in (SCENES_FILE, TRIALS_FILE):
            digest.update(bytes.fromhex(file_hash(Path(folder) / name)))
    return digest.hexdigest()


def _trial_columns(space: GraspSpace) -> dict[str, pa.DataType]:
    scalars = {name: _TRIAL_TYPES.get(name, pa.float64()) for name in SCALARS}
    return scalars | {f"theta_{name}": vector_type(space.dim) for name in THETAS}


def _poses(poses: list[np.ndarray]) -> pa.Array:
    return vectors(np.array(poses, dtype=float).reshape(-1, 16))


def _describe(space: GraspSpace) -> dict[str, Any]:
    """What must agree for theta to mean the same. Limits may differ: they are the robot's, not the data's."""
    return {
        "name": space.name,
        "names": list(space.names),
        "units": list(space.units),
        "frame": space.frame,
    }


def _origin(about: Mapping[str, Any], path: str | Path) -> TableOrigin:
    origin = about.get("origin")
    expected = {"robot", "object_set", "camera"}
    if not isinstance(origin, dict) or set(origin) != expected:
        raise InputError("The table does not say where it comes from", where=path, fix=f"run `{COLLECT}`")
    return TableOrigin(**{name: str(value) for name, value in origin.items()})


def _check_space(found: Any, space: GraspSpace, path: str | Path) -> None:
    if found != _describe(space):
        name = found.get("name") if isinstance(found, dict) else None
        raise InputError(
            f"The trials are in grasp space `{name}`, which is not `{space.name}` of the chosen robot, "
            "or not with the same parameters",
            where=path,
            fix="choose the robot that they were collected with",
        )


def _check_unique(ids: list[int], what: str, path: str | Path) -> None:
    repeated = [number for number, count in Counter(ids).items() if count > 1]
    if repeated:
        raise InputError(f"{what}_id {repeated[0]} occurs more than once", where=path, fix=f"run `{COLLECT}`")


def _check_values(trials: TrialTable, path: str | Path) -> None:
    for name, known in (("outcome", set(TrialOutcome)), ("face", set(Face))):
        strange = sorted(set(trials.rows[name]) - {str(value) for value in known})
        if strange:
            raise InputError(f"{strange[0]!r} is no {name} of a trial", where=path, fix=f"run `{COLLECT}`")
    if not np.isfinite(trials.executed.reached).all():
        raise InputError(
            "An executed trial does not say which grasp was reached", where=path, fix=f"run `{COLLECT}`"
        )
