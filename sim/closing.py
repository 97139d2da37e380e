"""Closing the hand: constant velocity, every finger stops by itself (paper, section 4.1)."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from jaxtyping import Float

from preshape.data.trial import GraspType

THUMB = "thumb"

# Joints of a finger that close, numbered from the palm: (other fingers, thumb).
CLOSING_JOINTS = {
    GraspType.SIDE: ((1, 2, 3), (2, 3)),
    GraspType.OVERHEAD: ((1,), (2,)),
}


class Closing(Protocol):
    """How a hand closes. Lengths of travel are in the unit of its joints, rad or m."""

    @property
    def lead(self) -> float:
        """How far a target may run ahead of its joint; times the drive's stiffness it is the force."""

    @property
    def stopped_travel(self) -> float:
        """A finger has stopped when none of its closing joints has travelled farther than this ..."""

    @property
    def stopped_time_s(self) -> float:
        """... for so long."""

    @property
    def max_time_s(self) -> float:
        """When to give up waiting for fingers that never stop."""

    def rule(self, finger: str, grasp_type: GraspType) -> tuple[tuple[int, ...], float]:
        """Which joints of a finger close, numbered from the palm, and how fast (rad/s or m/s)."""


@dataclass(frozen=True)
class ClosingSettings:
    """How the Allegro hand closes (paper, section 4.1).

    Args:
        finger_speed_rad_s, thumb_speed_rad_s: closing speeds.
        lead_rad: how far a position target may run ahead of its joint; with the drive's stiffness it sets the
            torque of the grasp, up to the joint's limit.
        stopped_travel_rad, stopped_time_s: a finger has stopped when none of its closing joints has travelled
            farther than this for so long.
        max_time_s: when to give up waiting for fingers that never stop.
    """

    finger_speed_rad_s: float = 1.0
    thumb_speed_rad_s: float = 1.25
    lead_rad: float = 0.045
    stopped_travel_rad: float = 0.02
    stopped_time_s: float = 0.2
    max_time_s: float = 2.1

    @property
    def lead(self) -> float:
        """See `Closing`."""
        return self.lead_rad

    @property
    def stopped_travel(self) -> float:
        """See `Closing`."""
        return self.stopped_travel_rad

    def rule(self, finger: str, grasp_type: GraspType) -> tuple[tuple[int, ...], float]:
        """The joints that the paper names for a grasp of this type."""
        finger_joints, thumb_joints = CLOSING_JOINTS[grasp_type]
        if finger == THUMB:
            return thumb_joints, self.thumb_speed_rad_s
        return finger_joints, self.finger_speed_rad_s


@dataclass(frozen=True)
class GripperClosing:
    """How a gripper closes whose fingers slide, each on one joint.

    Args:
        speed_m_s: of each finger.
        lead_m, stopped_travel_m, stopped_time_s, max_time_s: see `Closing`.
    """

    speed_m_s: float = 0.1
    lead_m: float = 0.01
    stopped_travel_m: float = 0.0005
    stopped_time_s: float = 0.1
    max_time_s: float = 1.0

    @property
    def lead(self) -> float:
        """See `Closing`."""
        return self.lead_m

    @property
    def stopped_travel(self) -> float:
        """See `Closing`."""
        return self.stopped_travel_m

    def rule(self, finger: str, grasp_type: GraspType) -> tuple[tuple[int, ...], float]:
        """The one joint of the finger, whatever the grasp."""
        return (0,), self.speed_m_s


@dataclass
class _Finger:
    joints: list[int]
    speed: float
    still_at: Float[np.ndarray, "_"]
    still_s: float = 0.0
    stopped: bool = False


@dataclass
class ClosingController:
    """Position targets of the hand's joints while it closes.

    Args:
        fingers: name of a finger to the hand-joint numbers of its joints, palm first.
        grasp_type: which of the paper's two closing rules applies.
        preshape: joint positions (rad or m) at which closing starts.
        upper: upper joint limits (rad or m); closing is the positive direction.
        settings: joints, speeds and thresholds.
    """

    fingers: dict[str, tuple[int, ...]]
    grasp_type: GraspType
    preshape: Float[np.ndarray, "h"]
    upper: Float[np.ndarray, "h"]
    settings: Closing
    targets: Float[np.ndarray, "h"] = field(init=False)
    elapsed_s: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self.targets = self.preshape.copy()
        self._fingers = [
            self._finger(joints, *self.settings.rule(name, self.grasp_type))
            for name, joints in self.fingers.items()
        ]

    def _finger(self, joints: tuple[int, ...], rule: tuple[int, ...], speed: float) -> _Finger:
        closing = [joints[k] for k in rule]
        return _Finger(closing, speed, self.preshape[closing])

    @property
    def done(self) -> bool:
        """Whether every finger has stopped, or the time is over."""
        return self.elapsed_s >= self.settings.max_time_s or all(f.stopped for f in self._fingers)

    def update(
        self,
        positions: Float[np.ndarray, "h"],
        period_s: float,
    ) -> Float[np.ndarray, "h"]:
        """Targets for the next control period, from measured joint positions (rad or m)."""
        self.elapsed_s += period_s
        for finger in self._fingers:
            if not finger.stopped:
                self._advance(finger, positions, period_s)
                self._detect_stop(finger, positions, period_s)
        return self.targets

    def _advance(self, finger: _Finger, positions: Float[np.ndarray, "h"], period_s: float) -> None:
        joints = finger.joints
        wanted = self.targets[joints] + finger.speed * period_s
        farthest = np.minimum(positions[joints] + self.settings.lead, self.upper[joints])
        self.targets[joints] = np.minimum(wanted, farthest)

    def _detect_stop(self, finger: _Finger, positions: Float[np.ndarray, "h"], period_s: float) -> None:
        angles = positions[finger.joints]
        if np.any(np.abs(angles - finger.still_at) > self.settings.stopped_travel):
            finger.still_at, finger.still_s = angles, 0.0
        else:
            finger.still_s += period_s
        finger.stopped = finger.still_s >= self.settings.stopped_time_s
