"""Checks that the chosen parts of a configuration fit together, before any work starts."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.setting_values import check_values
from preshape.errors import InputError
from preshape.paths import project_root


def check_composition(cfg: DictConfig) -> None:
    """Refuse a configuration with values that cannot be, or whose parts do not fit together.

    Only the parts that a configuration has are checked, so every command uses this one function.

    Raises:
        InputError: naming the two choices that clash, or the setting that is missing or wrong.
    """
    _check_nothing_is_missing(cfg)
    check_values(cfg)
    _check_model_fits_robot(cfg)
    _check_dataset_fits_robot(cfg)
    _check_planners_have_a_network(cfg)
    _check_robot_can_execute(cfg)


def missing_keys(content: Any, prefix: str = "") -> Iterator[str]:
    """The keys (`???`) that a user has to give, of an unresolved configuration; references do not count."""
    for key, value in content.items():
        if isinstance(value, dict):
            yield from missing_keys(value, f"{prefix}{key}.")
        elif value == "???":
            yield f"{prefix}{key}"


def _check_nothing_is_missing(cfg: DictConfig) -> None:
    missing = sorted(missing_keys(OmegaConf.to_container(cfg, resolve=False)))
    if missing:
        groups = dict.fromkeys(key.split(".")[0] for key in missing)
        raise InputError(
            f"A value must be given for {', '.join(missing)}",
            where=", ".join(_choice(cfg, group) for group in groups),
            fix="add " + " ".join(f"{key}=..." for key in missing) + " to the command",
        )


def _check_model_fits_robot(cfg: DictConfig) -> None:
    robot_space = OmegaConf.select(cfg, "robot.grasp_space.name")
    model_space = OmegaConf.select(cfg, "model.grasp_space")
    if None in (robot_space, model_space) or robot_space == model_space or not _needs_model(cfg):
        return
    robot, model = _choice(cfg, "robot"), _choice(cfg, "model")
    raise InputError(
        f"{robot} has grasp space {robot_space}{_parameter_count(cfg)}, "
        f"but {model} is built for {model_space}",
        where=f"{robot} with {model}",
        fix=f"choose a model for {robot_space}, or a robot with {model_space}",
    )


def _check_dataset_fits_robot(cfg: DictConfig) -> None:
    robot_name = OmegaConf.select(cfg, "robot.name")
    dataset_robot = OmegaConf.select(cfg, "dataset.robot")
    if None in (robot_name, dataset_robot) or robot_name == dataset_robot:
        return
    robot, dataset = _choice(cfg, "robot"), _choice(cfg, "dataset")
    raise InputError(
        f"{dataset} holds trials of robot {dataset_robot}, but {robot} is {robot_name}",
        where=f"{robot} with {dataset}",
        fix=f"choose the robot {dataset_robot}, or collect trials with `python sim/collect.py {robot}`",
    )


def _check_planners_have_a_network(cfg: DictConfig) -> None:
    needing = [choice for choice, node in _planners(cfg) if OmegaConf.select(node, "needs_model")]
    trains_it = OmegaConf.select(cfg, "trainer") is not None
    if not needing or trains_it:
        return
    planner, weights = needing[0], OmegaConf.select(cfg, "weights")
    train = "train a network with `python src/train.py` and give its file with weights=FILE.safetensors"
    if weights is None:
        raise InputError(
            f"{planner} climbs the success probability of a trained network, but weights is not set",
            where=f"{planner} with weights=null",
            fix=f"{train}, or choose planner=heuristic",
        )
    if not Path(weights).is_file():
        raise InputError(
            f"{planner} needs a trained network, but the weights file does not exist",
            where=weights,
            fix=train,
        )


def _check_robot_can_execute(cfg: DictConfig) -> None:
    if "laboratory" not in cfg or "robot" not in cfg or cfg.robot.description is not None:
        return
    robot = _choice(cfg, "robot")
    raise InputError(
        f"{robot} has no arm, so it cannot execute grasps",
        where=robot,
        fix="choose a robot that can be simulated, such as robot=baxter with camera=overhead",
    )


def _needs_model(cfg: DictConfig) -> bool:
    """Whether the network is used: not by planners none of which asks it."""
    planners = [node for _, node in _planners(cfg)]
    return not planners or any(OmegaConf.select(node, "needs_model") for node in planners)


def _planners(cfg: DictConfig) -> Iterator[tuple[str, Any]]:
    """Every planner of the configuration with how it was chosen: `planner`, and those under `planners`."""
    if OmegaConf.select(cfg, "planner") is not None:
        yield _choice(cfg, "planner"), cfg.planner
    for name in OmegaConf.select(cfg, "planners") or ():
        yield f"planners.{name}", cfg.planners[name]


def chosen_option(group: str, otherwise: str | None = None) -> str | None:
    """Which option of a group the command line, or a default, chose; None outside of a command.

    Args:
        group: folder under `conf/`.
        otherwise: what is said for a command without this group.
    """
    return HydraConfig.get().runtime.choices.get(group, otherwise) if HydraConfig.initialized() else None


def option_or(group: str, option: str, otherwise: str) -> str:
    """An option of a group if there is one of that name, else another one.

    In a list of defaults, this chooses by the name of another part, which need not have a file in the group:
    `learning: ${option_or:learning,${model},config_cnn}`.

    Args:
        group: folder under `conf/`.
        option: name of a file in it, perhaps.
        otherwise: name of a file in it.
    """
    return option if (project_root() / "conf" / group / f"{option}.yaml").is_file() else otherwise


def _choice(cfg: DictConfig, group: str) -> str:
    """How the user chose this part, as on the command line: `robot=lbr4_allegro`."""
    option = chosen_option(group) or OmegaConf.select(cfg, f"{group}.name", throw_on_missing=False)
    return f"{group}={option}" if option else group


def _parameter_count(cfg: DictConfig) -> str:
    joints = OmegaConf.select(cfg, "robot.grasp_space.joint_limits")
    return "" if joints is None else f" ({6 + len(joints)} parameters)"
