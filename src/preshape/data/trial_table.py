"""Trial and scene tables in memory."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
import pandas as pd
from jaxtyping import Bool, Float, Int

from preshape.data.scene import Scene
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.grasps.space import GraspSpace

THETAS = ("initial", "planned", "reached")
"""The fields of a `Trial` that are grasp configurations."""
SCALARS = tuple(entry.name for entry in fields(Trial) if entry.name not in THETAS)
"""The other fields of a `Trial`, in order: the columns of `TrialTable.rows`."""


@dataclass(frozen=True)
class TableOrigin:
    """What a table was collected with, by name: `robot=`, `objects=` and `camera=` of the configuration."""

    robot: str
    object_set: str
    camera: str

    @property
    def choices(self) -> str:
        """The same as on the command line."""
        return f"robot={self.robot} objects={self.object_set} camera={self.camera}"


@dataclass(frozen=True, eq=False)
class SceneTable:
    """Scenes that were collected together.

    Args:
        origin: what they were collected with.
        scenes: the scenes, each with its own number.
    """

    origin: TableOrigin
    scenes: tuple[Scene, ...]

    @cached_property
    def by_id(self) -> dict[int, Scene]:
        """The scenes by their numbers."""
        return {scene.scene_id: scene for scene in self.scenes}

    def __len__(self) -> int:
        return len(self.scenes)


@dataclass(frozen=True, eq=False)
class TrialTable:
    """Trials as columns.

    Args:
        origin: what they were collected with.
        space: grasp space of theta.
        rows: one row per trial with the columns `SCALARS`; `face` and `outcome` as their text values.
        initial, planned, reached: grasp configurations, as in `Trial`.
    """

    origin: TableOrigin
    space: GraspSpace
    rows: pd.DataFrame
    initial: Float[np.ndarray, "n d"]
    planned: Float[np.ndarray, "n d"]
    reached: Float[np.ndarray, "n d"]

    @classmethod
    def from_trials(cls, trials: Sequence[Trial], space: GraspSpace, origin: TableOrigin) -> "TrialTable":
        """Table of trials, in their order."""
        rows = pd.DataFrame(
            {name: [getattr(trial, name) for trial in trials] for name in SCALARS}, columns=list(SCALARS)
        )
        rows = rows.assign(
            face=[trial.face.value for trial in trials], outcome=[trial.outcome.value for trial in trials]
        )
        thetas = (
            np.array([getattr(trial, name) for trial in trials], dtype=float).reshape(len(trials), space.dim)
            for name in THETAS
        )
        return cls(origin, space, rows, *thetas)

    def to_trials(self) -> list[Trial]:
        """The trials, one by one."""
        return [
            Trial(
                **{str(name): value for name, value in row.items() if name not in ("face", "outcome")},
                face=Face(row["face"]),
                outcome=TrialOutcome(row["outcome"]),
                initial=self.initial[i],
                planned=self.planned[i],
                reached=self.reached[i],
            )
            for i, row in enumerate(self.rows.to_dict("records"))
        ]

    def __len__(self) -> int:
        return len(self.rows)

    def where(self, mask: Bool[np.ndarray, "n"]) -> "TrialTable":
        """The trials for which the mask holds, in the same order."""
        rows = self.rows[mask].reset_index(drop=True)
        thetas = (getattr(self, name)[mask] for name in THETAS)
        return TrialTable(self.origin, self.space, rows, *thetas)

    @property
    def executed(self) -> "TrialTable":
        """The trials in which the hand really tried: the labelled examples."""
        outcomes = [outcome.value for outcome in TrialOutcome if outcome.executed]
        return self.where(self.rows["outcome"].isin(outcomes).to_numpy(dtype=bool))

    @property
    def lifted(self) -> Bool[np.ndarray, "n"]:
        """The label Y of each trial: whether it ended LIFTED."""
        return (self.rows["outcome"] == TrialOutcome.LIFTED.value).to_numpy(dtype=bool, copy=True)

    @property
    def soft_labels(self) -> Float[np.ndarray, "n"]:
        """Share of LIFTED among the repetitions of each trial; NaN where it was not repeated."""
        return self.rows["soft_label"].to_numpy(dtype=float)

    @property
    def scene_ids(self) -> Int[np.ndarray, "n"]:
        """Number of each trial's scene."""
        return self.rows["scene_id"].to_numpy(dtype=np.int64)

    @property
    def object_ids(self) -> list[str]:
        """Object of each trial."""
        return self.rows["object_id"].tolist()
