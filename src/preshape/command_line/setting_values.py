"""Checks of the values that a user gives to settings, before any work starts."""

import math
from collections.abc import Iterator
from numbers import Real
from typing import Any

from hydra import compose
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import DictConfig, ListConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from preshape.errors import InputError

LEAST = {
    **dict.fromkeys(("seed", "acquired_seed", "fold", "shard", "min_positives", "max_iterations"), 0),
    **dict.fromkeys(("explored", "repeats", "filmed_scenes", "margin_px", "max_halvings"), 0),
    **dict.fromkeys(("workers", "trials", "trials_learned", "scenes", "block", "poses_per_object"), 1),
    **dict.fromkeys(
        ("kills", "kills_per_table", "iterations", "batch_size", "batches_per_epoch", "members"), 1
    ),
    **dict.fromkeys(("components", "rounds", "acquired_scenes", "grasps", "every", "columns", "devices"), 1),
    **dict.fromkeys(("width", "width_px", "height_px", "solver_iterations", "quality"), 1),
    **dict.fromkeys(("max_scenes", "shown", "compared", "samples_per_start", "samples_per_round"), 1),
}
"""The least value of settings that are whole numbers, by the last part of their names."""
MOST = {"quality": 100}
"""The greatest value of some of them."""
POSITIVE = (
    *("scene_limit_s", "timestep_s", "control_period_s", "learning_rate", "max_gigabytes", "scale", "focal"),
    *("frames_per_s", "max_time_s", "base_height_m"),
)
"""Settings that are numbers greater than 0, by the last part of their names."""
NOT_NEGATIVE = ("friction", "density", "weight_decay", "position_m", "rotation_rad")
"""Settings that are numbers of at least 0, by the last part of their names."""
SHARES = ("validation_fraction",)
"""Settings that are numbers from 0 to below 1, by the last part of their names."""
ONE_OF = {
    "schedule": ("steps", "one_cycle"),
    "accelerator": ("auto", "cpu", "gpu"),
    "precision": ("32-true", "16-mixed", "bf16-mixed"),
}
"""Settings that have few values, by the last part of their names."""
NEEDED_PATHS = (
    *("output", "table", "folder", "data", "result", "results", "page", "card", "evaluation", "metrics"),
    *("effort", "runs", "record"),
)
"""Settings that are files or folders and cannot be null, by the last part of their names."""
PATHS = (
    *NEEDED_PATHS,
    *("view", "rgb_file", "depth_file", "camera_file", "weights", "root", "first_training", "families"),
)
"""Settings that are files or folders, by the last part of their names."""
OR_NULL = (
    *("workers", "data.trials", "trials_learned", "poses_per_object", "shard", "density"),
    *("report.runs", "report.metrics"),
)
"""Those that may be null, by the end of their names."""
KINDS: tuple[tuple[tuple[type, ...], str], ...] = (
    ((bool,), "true or false"),
    ((int, float), "a number"),
    ((ListConfig,), "a list in brackets, such as [1,2]"),
)
"""Kinds of values that a default can have, and what they are called; a text may be anything."""


def check_values(cfg: DictConfig) -> None:
    """Refuse values of the wrong kind, and counts, sizes and the like that cannot be.

    Raises:
        InputError: naming the setting.
    """
    for key, value in _leaves(cfg):
        name = key.rpartition(".")[2]
        if value is None and key.endswith(OR_NULL):
            continue
        if name in LEAST and not (_is(value, int) and value >= LEAST[name]):
            raise _not_possible(key, value, f"a whole number from {LEAST[name]} on")
        if name in MOST and value > MOST[name]:
            raise _not_possible(key, value, f"a whole number up to {MOST[name]}")
        if name in POSITIVE and not (_is(value, Real) and 0 < value < math.inf):
            raise _not_possible(key, value, "a number greater than 0")
        if name in NOT_NEGATIVE and not (_is(value, Real) and 0 <= value < math.inf):
            raise _not_possible(key, value, "a number that is not negative")
        if name in SHARES and not (_is(value, Real) and 0 <= value < 1):
            raise _not_possible(key, value, "a number from 0 to below 1")
        if name in ONE_OF and value not in ONE_OF[name]:
            raise _not_possible(key, value, f"one of {', '.join(ONE_OF[name])}")
        if name in NEEDED_PATHS and value is None:
            raise _not_possible(key, value, "a path")
        if name == "method" and value is None:
            raise _not_possible(key, value, "a method, as the files under conf/planner do")
        if name in PATHS and not isinstance(value, str | None):
            raise _not_possible(key, value, f"a path, such as ./{value}")
    if HydraConfig.initialized():
        _check_kinds(cfg)


def _leaves(node: DictConfig, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Full names and values of all settings but lists, references to others, and what is not given yet."""
    for key in map(str, node):
        if OmegaConf.is_missing(node, key) or OmegaConf.is_interpolation(node, key):
            continue
        value = node[key]
        if isinstance(value, DictConfig):
            yield from _leaves(value, f"{prefix}{key}.")
        elif not isinstance(value, ListConfig):
            yield f"{prefix}{key}", value


def _check_kinds(cfg: DictConfig) -> None:
    """Refuse values whose kind is not that of the value that they replace."""
    hydra = HydraConfig.get()
    overrides = OverridesParser.create().parse_overrides(list(hydra.overrides.task))
    values = [
        own
        for own in overrides
        if not own.is_add() and not own.is_delete() and own.get_key_element() not in hydra.runtime.choices
    ]
    if not values:
        return
    before = compose(hydra.job.config_name, [str(own.input_line) for own in overrides if own not in values])
    for own in values:
        key = own.key_or_group
        default, value = (_found(node, key) for node in (before, cfg))
        if value is None and _must_be_given(before, key):
            raise _not_possible(key, value, "a value")
        kinds, said = next(((kinds, said) for kinds, said in KINDS if _is(default, kinds)), ((object,), ""))
        if value is not None and not _is(value, kinds):
            raise _not_possible(key, value, said)
        if isinstance(value, ListConfig) and _numbers(default) and not _numbers(value):
            raise _not_possible(key, value, "a list in which each is a number, as in its default")


def _found(node: DictConfig, key: str) -> Any:
    try:
        return OmegaConf.select(node, key)
    except OmegaConfBaseException:
        return None


def _must_be_given(node: DictConfig, key: str) -> bool:
    parent, _, name = key.rpartition(".")
    inner = OmegaConf.select(node, parent) if parent else node
    return isinstance(inner, DictConfig) and OmegaConf.is_missing(inner, name)


def _numbers(values: Any) -> bool:
    """Whether this is a list of numbers, and of at least one."""
    return isinstance(values, ListConfig) and len(values) > 0 and all(_is(one, Real) for one in values)


def _is(value: Any, kinds: type | tuple[type, ...]) -> bool:
    """Whether a value is of a kind; true and false are no numbers."""
    return isinstance(value, kinds) and (kinds == (bool,) or not isinstance(value, bool))


def _not_possible(key: str, value: Any, wanted: str) -> InputError:
    shown = "null" if value is None else value
    return InputError(f"{key} cannot be {shown}", where=f"{key}={shown}", fix=f"give {wanted}")
