"""A table top for tests: real depth images by ray casting, so that perception is tested without simulator."""

from collections.abc import Sequence

import numpy as np
import open3d as o3d
import pytest
from scipy import ndimage
from scipy.spatial.transform import Rotation

from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation

Mesh = o3d.geometry.TriangleMesh
COLOURS = np.array(
    [[200, 60, 50], [60, 90, 200], [150, 120, 90], [90, 90, 90], [220, 130, 30]], dtype=np.uint8
)


class TableTop:
    """A table on a floor before a camera, as in the simulator: meshes to stand on it, and views of them."""

    height_m = 0.59
    camera = Camera.looking_at(
        np.array([0.8, -0.9, 1.25]), np.array([0.8, 0.0, 0.65]), width=640, height=480, focal=525.0
    )

    def box(
        self,
        size: Sequence[float],
        centre_xy: tuple[float, float] = (0.8, 0.0),
        yaw: float = 0.0,
        floating: float = 0.0,
    ) -> Mesh:
        """Box that stands on the table, or floats above it, turned about its vertical axis."""
        mesh = Mesh.create_box(*size).translate(-np.array(size) / 2)
        mesh.rotate(Rotation.from_euler("z", yaw).as_matrix(), center=np.zeros(3))
        return mesh.translate((*centre_xy, self.height_m + size[2] / 2 + floating))

    def cylinder(self, radius: float, height: float, centre_xy: tuple[float, float] = (0.8, 0.0)) -> Mesh:
        """Cylinder that stands on the table."""
        mesh = Mesh.create_cylinder(radius, height, resolution=48)
        return mesh.translate((*centre_xy, self.height_m + height / 2))

    @staticmethod
    def slab(low: Sequence[float], high: Sequence[float]) -> Mesh:
        """Axis-aligned box between two corners in the world."""
        return Mesh.create_box(*(np.array(high) - np.array(low))).translate(low)

    def view(
        self, *objects: Mesh, surroundings: Sequence[Mesh] = (), noise_seed: int | None = None
    ) -> Observation:
        """View of objects on the table, with the floor in view; with Kinect-like noise if a seed is given."""
        table = self.slab((0.495, -0.456, self.height_m - 0.03), (1.105, 0.456, self.height_m))
        floor = self.slab((-4, -4, -0.1), (5, 6, 0))
        scene = o3d.t.geometry.RaycastingScene()
        for mesh in (*objects, table, floor, *surroundings):
            scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(mesh))
        hits = scene.cast_rays(self._rays())
        # The rays have length 1 along the optical axis, so that the distance along them is the depth.
        depth = hits["t_hit"].numpy().astype(np.float32)
        depth[~np.isfinite(depth)] = np.nan
        if noise_seed is not None:
            depth = _kinect_noise(depth, np.random.default_rng(noise_seed))
        mesh_number = hits["geometry_ids"].numpy()
        shade = 0.6 + 0.4 * np.abs(hits["primitive_normals"].numpy() @ (0.3, -0.5, 0.8))[..., None]
        colour = COLOURS[np.minimum(mesh_number, len(COLOURS) - 1).astype(int)]
        return Observation((colour * shade).astype(np.uint8), depth, mesh_number < len(objects), self.camera)

    def _rays(self) -> o3d.core.Tensor:
        camera = self.camera
        # Open3D counts pixels from their corners, the project from their centres.
        intrinsics = np.array(
            [[camera.fx, 0.0, camera.cx + 0.5], [0.0, camera.fy, camera.cy + 0.5], [0.0, 0.0, 1.0]]
        )
        return o3d.t.geometry.RaycastingScene.create_rays_pinhole(
            o3d.core.Tensor(intrinsics),
            o3d.core.Tensor(np.linalg.inv(camera.T_world_camera)),
            camera.width,
            camera.height,
        )


def _kinect_noise(depth: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Axial noise and quantisation that grow with the square of the distance; holes at depth edges."""
    noisy = depth + rng.normal(0.0, 0.003 / 1.2**2, depth.shape) * depth**2
    step = 2.9e-3 * depth**2
    noisy = np.round(noisy / step) * step
    jump = ndimage.maximum_filter(depth, 3) - ndimage.minimum_filter(depth, 3) > 0.05
    noisy[jump & (rng.random(depth.shape) < 0.8)] = np.nan
    noisy[rng.random(depth.shape) < 0.01] = np.nan
    return noisy.astype(np.float32)


@pytest.fixture(scope="session")
def table_top() -> TableTop:
    """The table top that the tests of perception look at."""
    return TableTop()
