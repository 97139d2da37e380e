"""Plans as JSON files: for a robot that executes them, and for the report that shows them."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.grasps.rectangle_pose import JawPose
from preshape.grasps.space import GraspSpace
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.result import PlanResult, PlanStatus

FORMAT = "preshape-plan/2"
"""Name and version of the format; raised whenever old files could be misread."""
THETAS = ("theta", "initial_theta")
SCALARS = (
    "success_prob",
    "initial_success_prob",
    "log_posterior",
    "initial_log_posterior",
    "violation_m",
)


def write_plan(path: str | Path, plan: GraspPlan) -> None:
    """Write a plan as JSON, atomically: what holds for all grasps, then the grasps, the best first.

    Numbers that are not known (no network: no probability) are null.

    Raises:
        InputError: if the place cannot be written to.
    """
    space, result = plan.space, plan.result
    content = {
        "format": FORMAT,
        "planner": plan.planner,
        "grasp_space": space.name,
        "names": space.names,
        "units": space.units,
        "frame": space.frame,
        "T_world_camera": plan.T_world_camera,
        "T_table_camera": plan.T_table_camera,
        "evaluations": result.evaluations,
        "runtime_s": result.runtime_s,
        "grasps": [_grasp(plan, int(start)) for start in result.ranking],
    }
    write_json(path, content)


def read_plan(path: str | Path, space: GraspSpace) -> GraspPlan:
    """Read a plan in the given grasp space.

    Raises:
        InputError: if the file is missing, not JSON, of another version or grasp space, or incomplete.
    """
    content = read_json(path)
    again = "plan again with `python src/plan.py`"
    if content.get("format") != FORMAT:
        raise InputError(f"The file is no plan in the format {FORMAT}", where=path, fix=again)
    if content.get("grasp_space") != space.name or content.get("names") != list(space.names):
        raise InputError(
            f"The plan is for grasp space {content.get('grasp_space')!r}, not for {space.name!r}",
            where=path,
            fix=f"choose the robot that it was made for, or {again}",
        )
    try:
        return _plan(content, space)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"The plan is incomplete or damaged ({error})", where=path, fix=again) from error


def _grasp(plan: GraspPlan, start: int) -> dict[str, Any]:
    result, space = plan.result, plan.space
    theta = result.theta[start]
    return {
        "start": start,
        "face": plan.faces[start].value,
        "grasp_type": plan.faces[start].grasp_type.value,
        "status": result.status[start].value,
        **{name: getattr(result, name)[start] for name in SCALARS},
        **_palm_poses(plan, start),
        **(_opening(plan.jaws[start]) if plan.jaws else {}),
        "joints": dict(zip(space.joint_names, space.joints(theta).tolist(), strict=True)),
        **{name: getattr(result, name)[start] for name in THETAS},
        "climb": result.climb[start],
    }


def _palm_poses(plan: GraspPlan, start: int) -> dict[str, Any]:
    """Where the palm is to be."""
    return {
        "T_camera_palm": plan.palm_pose(start),
        "T_table_palm": plan.palm_pose_over_table(start),
        "T_world_palm": plan.palm_pose_in_world(start),
    }


def _opening(jaws: JawPose) -> dict[str, float]:
    """What else a gripper is told at a rectangle."""
    return {"opening_m": jaws.opening_m, "advance_m": jaws.advance_m}


def _jaws(grasp: dict[str, Any]) -> JawPose:
    pose = _numbers(grasp["T_camera_palm"]).reshape(4, 4)
    return JawPose(pose, float(grasp["opening_m"]), float(grasp["advance_m"]))


def _plan(content: dict[str, Any], space: GraspSpace) -> GraspPlan:
    grasps: list[dict[str, Any]] = content["grasps"]
    ranking = np.array([grasp["start"] for grasp in grasps])
    if sorted(ranking) != list(range(len(grasps))) or not grasps:
        raise ValueError("its starts are not numbered from 0")
    by_start = sorted(grasps, key=lambda grasp: grasp["start"])
    thetas = {name: _numbers([grasp[name] for grasp in by_start]) for name in THETAS}
    if any(theta.shape != (len(grasps), space.dim) for theta in thetas.values()):
        raise ValueError("a theta has the wrong length")
    result = PlanResult(
        **thetas,
        **{name: _numbers([grasp[name] for grasp in by_start]) for name in SCALARS},
        ranking=ranking,
        status=tuple(PlanStatus(grasp["status"]) for grasp in by_start),
        iterations=np.array([len(grasp["climb"]) - 1 for grasp in by_start]),
        evaluations=int(content["evaluations"]),
        runtime_s=float(content["runtime_s"]),
        climb=tuple(tuple(_numbers(grasp["climb"]).tolist()) for grasp in by_start),
        path=(),
    )
    return GraspPlan(
        planner=str(content["planner"]),
        space=space,
        faces=tuple(Face(grasp["face"]) for grasp in by_start),
        result=result,
        T_world_camera=_numbers(content["T_world_camera"]).reshape(4, 4),
        T_table_camera=_numbers(content["T_table_camera"]).reshape(4, 4),
        jaws=() if space.frame == "camera" else tuple(map(_jaws, by_start)),
    )


def _numbers(values: list[Any]) -> Float64[np.ndarray, "..."]:
    """Numbers that came from JSON, where null stands for NaN."""
    return np.array(values, dtype=np.float64)
