"""Closing the hand: constant velocity, every finger stops by itself (paper, section 4.1)."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from preshape.data.trial import GraspType

THUMB = "thumb"

# Joints of a finger that close, numbered from the palm: (other fingers, thumb).
CLOSING_JOINTS = {
    GraspType.SIDE: ((1, 2, 3), (2, 3)),
    GraspType.OVERHEAD: ((1,), (2,)),
}


@dataclass(frozen=True)
class ClosingSettings:
    """How the hand closes.

    Args:
        finger_speed_rad_s, thumb_speed_rad_s: closing speeds.
        lead_rad: how far a position target may run ahead of its joint; with the drive's stiffness it sets the
            torque of the grasp, up to the joint's limit.
        stopped_speed_rad_s: a joint slower than this counts as stopped.
        stopped_time_s: how long all closing joints of a finger must be stopped until the finger is.
        max_time_s: when to give up waiting for fingers that never stop.
    """

    finger_speed_rad_s: float = 0.6
    thumb_speed_rad_s: float = 0.75
    lead_rad: float = 0.15
    stopped_speed_rad_s: float = 0.04
    stopped_time_s: float = 0.2
    max_time_s: float = 3.5


@dataclass
class _Finger:
    joints: list[int]
    speed: float
    still_s: float = 0.0
    stopped: bool = False


@dataclass
class ClosingController:
    """Position targets of the hand's joints while it closes.

    Args:
        fingers: name of a finger to the hand-joint numbers of its four joints, palm first.
        grasp_type: which of the paper's two closing rules applies.
        preshape: joint angles (rad) at which closing starts.
        upper: upper joint limits (rad); closing is the positive direction.
        settings: speeds and thresholds.
    """

    fingers: dict[str, tuple[int, ...]]
    grasp_type: GraspType
    preshape: Float[np.ndarray, "16"]
    upper: Float[np.ndarray, "16"]
    settings: ClosingSettings
    targets: Float[np.ndarray, "16"] = field(init=False)
    elapsed_s: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self.targets = self.preshape.copy()
        finger_rule, thumb_rule = CLOSING_JOINTS[self.grasp_type]
        self._fingers = [
            _Finger(
                [joints[k] for k in (thumb_rule if name == THUMB else finger_rule)],
                self.settings.thumb_speed_rad_s if name == THUMB else self.settings.finger_speed_rad_s,
            )
            for name, joints in self.fingers.items()
        ]

    @property
    def done(self) -> bool:
        """Whether every finger has stopped, or the time is over."""
        return self.elapsed_s >= self.settings.max_time_s or all(f.stopped for f in self._fingers)

    def update(
        self,
        positions: Float[np.ndarray, "16"],
        velocities: Float[np.ndarray, "16"],
        period_s: float,
    ) -> Float[np.ndarray, "16"]:
        """Targets for the next control period, from measured joint angles (rad) and velocities (rad/s)."""
        self.elapsed_s += period_s
        for finger in self._fingers:
            if not finger.stopped:
                self._advance(finger, positions, period_s)
                self._detect_stop(finger, velocities, period_s)
        return self.targets

    def _advance(self, finger: _Finger, positions: Float[np.ndarray, "16"], period_s: float) -> None:
        joints = finger.joints
        wanted = self.targets[joints] + finger.speed * period_s
        farthest = np.minimum(positions[joints] + self.settings.lead_rad, self.upper[joints])
        self.targets[joints] = np.minimum(wanted, farthest)

    def _detect_stop(self, finger: _Finger, velocities: Float[np.ndarray, "16"], period_s: float) -> None:
        still = np.all(np.abs(velocities[finger.joints]) < self.settings.stopped_speed_rad_s)
        finger.still_s = finger.still_s + period_s if still else 0.0
        finger.stopped = finger.still_s >= self.settings.stopped_time_s
