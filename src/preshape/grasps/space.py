"""The grasp space: what each number of theta means for one robot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Float

from preshape.geometry.pose import euler_xyz_from_rotation, make_pose, rotation_from_euler_xyz

PALM_NAMES = ("palm_x", "palm_y", "palm_z", "palm_roll", "palm_pitch", "palm_yaw")
PALM_UNITS = ("m", "m", "m", "rad", "rad", "rad")


@dataclass(frozen=True, eq=False)
class GraspSpace:
    """Names, units and limits of theta = (palm pose, preshape joints).

    The palm pose is xyz (m) and extrinsic XYZ Euler angles (rad) in the camera frame. Palm frame: x is the
    palm's normal into the object, y the thumb's side, z along the middle finger.

    Args:
        name: name of the space; data, networks and robots that share it fit together.
        names, units: one entry per parameter.
        lower, upper: limits; the palm's are infinite, because they depend on the scene.
        frame: frame of the palm pose.
    """

    name: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    lower: Float[np.ndarray, "d"]
    upper: Float[np.ndarray, "d"]
    frame: str = "camera"

    @classmethod
    def palm_and_joints(cls, name: str, joint_limits: Mapping[str, Sequence[float]]) -> "GraspSpace":
        """Grasp space of a palm pose and preshape joints with the given (lower, upper) limits in rad."""
        lower = [-np.inf] * 6 + [limits[0] for limits in joint_limits.values()]
        upper = [np.inf] * 6 + [limits[1] for limits in joint_limits.values()]
        names = PALM_NAMES + tuple(joint_limits)
        units = PALM_UNITS + ("rad",) * len(joint_limits)
        return cls(name, names, units, np.array(lower), np.array(upper))

    def narrowed(self, joint_ranges: Mapping[str, Sequence[float]]) -> "GraspSpace":
        """The same space with its preshape joints limited to (low, high) in rad, where a range is given."""
        lower, upper = self.lower.copy(), self.upper.copy()
        for k, name in enumerate(self.names):
            if name in joint_ranges:
                lower[k], upper[k] = np.clip(joint_ranges[name], self.lower[k], self.upper[k])
        return replace(self, lower=lower, upper=upper)

    @property
    def dim(self) -> int:
        """Number of parameters d."""
        return len(self.names)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The preshape joints, in the order of theta."""
        return self.names[6:]

    def theta(
        self, T_camera_palm: Float[np.ndarray, "4 4"], joints: Float[np.ndarray, "j"]
    ) -> Float[np.ndarray, "d"]:
        """Theta of a palm pose and preshape joints (rad)."""
        angles = euler_xyz_from_rotation(T_camera_palm[:3, :3])
        return np.concatenate((T_camera_palm[:3, 3], angles, joints))

    def palm_pose(self, theta: Float[np.ndarray, "d"]) -> Float[np.ndarray, "4 4"]:
        """T_camera_palm of theta."""
        rotation = rotation_from_euler_xyz(torch.as_tensor(theta[3:6])).numpy()
        return make_pose(rotation, theta[:3])

    def joints(self, theta: Float[np.ndarray, "d"]) -> Float[np.ndarray, "j"]:
        """Preshape joint angles of theta (rad)."""
        return theta[6:]
