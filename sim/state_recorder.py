"""A spectator that writes down where everything is."""

import numpy as np
from jaxtyping import Float

from preshape.data.trial import TrialOutcome
from preshape.viewer.recording import TrialRecording
from sim.world import World

PALM = "palm"


class StateRecorder:
    """Keeps the states of a trial.

    Args:
        control_period_s: time between two looks.
        every: a state is kept of every so many looks.
    """

    def __init__(self, control_period_s: float, every: int = 2) -> None:
        self._period_s, self._every = control_period_s, every
        self._looks = 0
        self._joint_names: tuple[str, ...] = ()
        self._parts: dict[str, str] = {}
        self._times_s: list[float] = []
        self._phases: list[str] = []
        self._joints: list[Float[np.ndarray, "n"]] = []
        self._palm: list[Float[np.ndarray, "4 4"]] = []
        self._object: list[Float[np.ndarray, "4 4"]] = []
        self._contacts: list[tuple[int, str, Float[np.ndarray, "3"]]] = []

    def __call__(self, world: World, phase: str) -> None:
        """Look at the world; every so often keep its state."""
        self._looks += 1
        if (self._looks - 1) % self._every:
            return
        assert world.robot is not None
        articulation = world.robot.articulation
        if not self._joint_names:
            self._joint_names = tuple(joint.name for joint in articulation.active_joints)
            self._parts = _parts(world)
        for link, point in world.hand_contacts:
            self._contacts.append((len(self._times_s), self._parts[link], point))
        self._times_s.append((self._looks - 1) * self._period_s)
        self._phases.append(phase)
        self._joints.append(articulation.qpos.astype(np.float64))
        self._palm.append(world.robot.palm_pose)
        self._object.append(world.object_pose)

    @property
    def is_empty(self) -> bool:
        """Whether there was nothing to see."""
        return not self._times_s

    def recording(self, outcome: TrialOutcome) -> TrialRecording:
        """All that was kept of a trial with this outcome."""
        points = [point for _, _, point in self._contacts]
        return TrialRecording(
            outcome=outcome,
            joint_names=self._joint_names,
            times_s=np.array(self._times_s),
            phases=tuple(self._phases),
            joints=np.array(self._joints),
            T_world_palm=np.array(self._palm),
            T_world_object=np.array(self._object),
            contact_instants=np.array([instant for instant, _, _ in self._contacts], dtype=np.int64),
            contact_points=np.array(points, dtype=np.float64).reshape(-1, 3),
            contact_parts=tuple(part for _, part, _ in self._contacts),
        )


def _parts(world: World) -> dict[str, str]:
    """The finger that each link of the hand belongs to; the others belong to the palm."""
    assert world.robot is not None
    finger_of = {joint: finger for finger, joints in world.robot.robot.fingers.items() for joint in joints}
    parts: dict[str, str] = {}
    for link in world.robot.articulation.links:  # parents come before their children
        inherited = PALM if link.parent is None else parts[link.parent.name]
        parts[link.name] = finger_of.get(link.joint.name, inherited)
    return parts
