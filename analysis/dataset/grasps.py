"""The trials of a data set with what they are counted by: shape family, place, palm and preshape."""

import csv
from pathlib import Path

import numpy as np
import pandas as pd
import torch
from jaxtyping import Float

from preshape.data.trial import Face, TrialOutcome
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.geometry.pose import rotation_from_euler_xyz

HEURISTIC = "heuristic"
"""The planner whose palm the others' distance is measured from."""
OTHER_FAMILY = "other"
GRASP_TYPES = ("overhead", "side")


def grasp_frame(scenes: SceneTable, trials: TrialTable, families: dict[str, str]) -> pd.DataFrame:
    """One row per trial: the table's own columns and those that follow from them.

    Columns:
        lifted, executed: booleans.
        family, grasp_type: of the object, of the face.
        object_x_m, object_y_m: the object's origin on the table, from the middle of all of them (world).
        centre_x_m, centre_y_m, centre_z_m: the object's origin in the frame of the planned palm.
        shift_m, tilt_rad: how far the planned palm is moved, and its normal tilted, from the heuristic one of
            the same scene and face; NaN for the heuristic ones themselves, and where there is none.
        one for each preshape joint of the grasp space (rad).

    Args:
        scenes, trials: the data set.
        families: object -> shape family; others are of the family `other`.
    """
    rows = trials.rows.copy()
    executed = [outcome.value for outcome in TrialOutcome if outcome.executed]
    rows["lifted"], rows["executed"] = trials.lifted, rows["outcome"].isin(executed)
    rows["family"] = rows["object_id"].map(lambda name: families.get(name, OTHER_FAMILY))
    rows["grasp_type"] = rows["face"].map(lambda face: Face(face).grasp_type.value)
    rows[list(trials.space.joint_names)] = trials.planned[:, 6:]
    own = [scenes.by_id[int(number)] for number in trials.scene_ids]
    objects = np.array([scene.T_world_object[:3, 3] for scene in own]).reshape(-1, 3)
    cameras = np.array([scene.camera.T_world_camera for scene in own]).reshape(-1, 4, 4)
    rows[["object_x_m", "object_y_m"]] = objects[:, :2] - (objects[:, :2].mean(axis=0) if own else 0.0)
    rotations, positions = _palms(cameras, trials.planned)
    centres = np.einsum("nji,nj->ni", rotations, objects - positions)
    rows[["centre_x_m", "centre_y_m", "centre_z_m"]] = centres
    rows[["shift_m", "tilt_rad"]] = _strayed(rows, rotations, positions)
    return rows


def read_families(path: str | Path | None) -> dict[str, str]:
    """Shape family of each object from a CSV table with the columns `name` and `family`; none for None.

    Raises:
        InputError: if the table cannot be read or lacks these columns.
    """
    if path is None:
        return {}
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            return {row["name"]: row["family"].replace("_", " ") for row in csv.DictReader(file)}
    except (OSError, KeyError, ValueError, AttributeError, csv.Error) as error:  # a short row has None
        raise InputError(
            f"The table of shape families cannot be read ({error!r})",
            where=path,
            fix="give a CSV with the columns name and family, or report.families=null",
        ) from error


def _palms(
    cameras: Float[np.ndarray, "n 4 4"], theta: Float[np.ndarray, "n d"]
) -> tuple[Float[np.ndarray, "n 3 3"], Float[np.ndarray, "n 3"]]:
    """Rotations and positions of palms in the world."""
    in_camera = rotation_from_euler_xyz(torch.as_tensor(theta[:, 3:6])).numpy()
    positions = np.einsum("nij,nj->ni", cameras[:, :3, :3], theta[:, :3]) + cameras[:, :3, 3]
    return cameras[:, :3, :3] @ in_camera, positions


def _strayed(
    rows: pd.DataFrame, rotations: Float[np.ndarray, "n 3 3"], positions: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 2"]:
    keys = list(zip(rows["scene_id"], rows["face"], strict=True))
    heuristic = (rows["planner"] == HEURISTIC).to_numpy(dtype=bool)
    reference = {key: i for i, key in enumerate(keys) if heuristic[i]}
    strayed = np.full((len(rows), 2), np.nan)
    for i, key in enumerate(keys):
        j = reference.get(key)
        if j is None or heuristic[i]:
            continue
        cosine = rotations[j][:, 0] @ rotations[i][:, 0]
        strayed[i] = np.linalg.norm(positions[i] - positions[j]), np.arccos(np.clip(cosine, -1, 1))
    return strayed
