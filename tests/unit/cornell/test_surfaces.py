"""Points and range images become depth images that agree, with each other and with the published point."""

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from synthetic_cornell import BLOCK, BLOCK_M, MEASURED, TABLE_M, surface_points, write_cloud, write_cornell

from preshape.cornell import cameras
from preshape.cornell.cameras import fit_camera, nominal_camera
from preshape.cornell.data_set import read_cornell
from preshape.cornell.image_files import depth_from_range
from preshape.cornell.point_cloud_files import read_point_cloud
from preshape.cornell.views import Surface, load_cornell_view, load_surface
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, make_pose, transform_points
from preshape.perception.image import eight_channel_image
from preshape.perception.observation import Observation

HEAD = (
    "# .PCD v.7 - Point Cloud Data file format\nFIELDS x y z rgb index\nSIZE 4 4 4 4 4\nTYPE F F F F U\n"
    "COUNT 1 1 1 1 1\nWIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA ascii\n"
)
PUBLISHED = "1924.064 -647.111 -119.4176 0 25547\n"
FUZZ = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def cloud_file(folder: Path, points: str, n: int = 1) -> Path:
    path = folder / "pcd0100.txt"
    path.write_text(HEAD.format(n=n) + points)
    return path


def world_points(view: Observation) -> np.ndarray:
    return transform_points(view.camera.T_world_camera, view.camera.unproject(view.depth.astype(np.float64)))


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cornell(tmp_path_factory.mktemp("cornell"), n=2)


class TestPointCloud:
    def test_the_published_point_lies_in_its_row_and_column(self, tmp_path: Path) -> None:
        points = read_point_cloud(cloud_file(tmp_path, PUBLISHED))
        np.testing.assert_allclose(points[39, 587], (1.924064, -0.647111, -0.1194176))
        assert np.linalg.norm(points[39, 587]) == pytest.approx(2.03348, abs=1e-5)
        assert np.isfinite(points).all(axis=-1).sum() == 1

    def test_first_and_last_pixel(self, tmp_path: Path) -> None:
        points = read_point_cloud(cloud_file(tmp_path, "1 2 3 0 0\n4 5 6 0 307199\nnan nan nan 0 640\n", n=3))
        np.testing.assert_allclose(points[0, 0], (0.001, 0.002, 0.003))
        np.testing.assert_allclose(points[479, 639], (0.004, 0.005, 0.006))
        assert np.isnan(points[1, 0]).all()

    @pytest.mark.parametrize(
        ("points", "message"),
        [
            ("", "0 of 1 points"),
            (PUBLISHED * 2, "2 of 1 points"),
            ("1 2 3 0 307200\n", "pixels of the image"),
            ("1 2 3 0 -1\n", "pixels of the image"),
            ("1 2 3 0 1.5\n", "pixels of the image"),
            ("1 2 3 0 nan\n", "pixels of the image"),
            ("1 2 3 0\n", "4 numbers"),
            ("1 2 3 zero 5\n", "in numbers"),
        ],
    )
    def test_other_points_are_refused(self, tmp_path: Path, points: str, message: str) -> None:
        with pytest.raises(InputError, match=message):
            read_point_cloud(cloud_file(tmp_path, points))

    def test_two_points_of_one_pixel_are_refused(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="different pixels"):
            read_point_cloud(cloud_file(tmp_path, PUBLISHED * 2, n=2))

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("DATA ascii", "DATA binary"),
            ("DATA ascii\n", ""),
            ("index", "x"),
            ("rgb index", "rgb"),
            ("POINTS 1", ""),
        ],
    )
    def test_another_head_is_refused(self, tmp_path: Path, old: str, new: str) -> None:
        path = cloud_file(tmp_path, PUBLISHED)
        path.write_text(path.read_text().replace(old, new))
        with pytest.raises(InputError, match="damaged"):
            read_point_cloud(path)

    @FUZZ
    @given(
        content=st.binary(max_size=60)
        | st.text("0123456789.-enaif \n", max_size=60).map(lambda text: (HEAD.format(n=2) + text).encode())
        | st.lists(st.sampled_from([*HEAD.format(n=1).splitlines(), PUBLISHED]), max_size=12).map(
            lambda lines: "\n".join(lines).encode()
        )
    )
    def test_whatever_a_file_holds_ends_in_points_or_one_error(self, tmp_path: Path, content: bytes) -> None:
        path = tmp_path / "pcd0100.txt"
        path.write_bytes(content)
        with suppress(InputError):
            assert read_point_cloud(path).shape == (480, 640, 3)


class TestCamera:
    @pytest.mark.parametrize(
        ("euler", "focal"), [((-2.5, 0.1, -1.4), 525.0), ((3.1, 0.2, 0.4), 525.0), ((-2.2, 0.0, 2.9), 590.0)]
    )
    def test_focal_length_and_pose_come_from_the_points(self, euler: tuple[float, ...], focal: float) -> None:
        rotation = Rotation.from_euler("xyz", euler).as_matrix()
        camera = Camera(640, 480, focal, focal, 319.5, 239.5, make_pose(rotation, np.array([0.3, 0.2, 0.8])))
        points = surface_points(camera)
        fitted, depth = fit_camera(points, Path("points"))
        assert fitted.fx == pytest.approx(focal, rel=1e-3)
        np.testing.assert_allclose(fitted.T_world_camera, camera.T_world_camera, atol=2e-3)
        expected = transform_points(invert_pose(camera.T_world_camera), points)[..., 2]
        np.testing.assert_allclose(depth, expected, atol=2e-3)

    @pytest.mark.parametrize("turn", [0.0, 1.3])
    def test_the_slopes_are_those_of_finite_differences(self, turn: float) -> None:
        rng = np.random.default_rng(0)
        pixels, points = rng.uniform(0, 480, (20, 2)), rng.normal(size=(20, 3))
        parameters = np.array([turn, -0.4 * turn, 0.9 * turn, 0.3, -0.2, 0.8, 0.1])

        def misses(step: np.ndarray) -> np.ndarray:
            return np.asarray(cameras._misses(parameters + step, pixels, points))

        steps = 1e-6 * np.eye(7)
        expected = np.stack([(misses(own) - misses(-own)) / 2e-6 for own in steps], axis=1)
        found = cameras._slopes(parameters, pixels, points)
        np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())

    def test_the_published_point_lies_on_its_pixel_for_the_nominal_camera(self) -> None:
        camera = nominal_camera()
        point = transform_points(
            invert_pose(camera.T_world_camera), np.array([[1.924064, -0.647111, -0.1194176]])
        )
        u, v = camera.project(point)
        assert (u[0], v[0]) == (pytest.approx(587, abs=0.5), pytest.approx(39, abs=0.5))

    def test_points_in_the_wrong_pixels_are_refused(self) -> None:
        points = np.full((480, 640, 3), np.nan)
        points[MEASURED] = surface_points(nominal_camera())[MEASURED]
        shuffled = np.random.default_rng(0).permutation(points[MEASURED].reshape(-1, 3))
        points[MEASURED] = shuffled.reshape(points[MEASURED].shape)
        with pytest.raises(InputError, match="no camera"):
            fit_camera(points, Path("points"))

    def test_single_points_in_wrong_pixels_are_left_out(self) -> None:
        points = np.full((480, 640, 3), np.nan)
        points[MEASURED] = surface_points(nominal_camera())[MEASURED]
        points[0, 0] = points[250, 300]
        _, depth = fit_camera(points, Path("points"))
        assert np.isnan(depth[0, 0])
        assert np.isfinite(depth[MEASURED]).all()

    def test_a_few_points_are_refused(self) -> None:
        with pytest.raises(InputError, match="too few"):
            fit_camera(np.full((480, 640, 3), np.nan), Path("points"))


class TestViews:
    def test_measured_points_are_taken_where_they_are(self, root: Path) -> None:
        first, second = (load_cornell_view(image.files) for image in read_cornell(root).images)
        assert (first.surface, second.surface) == (Surface.MEASURED, Surface.APPROXIMATE)
        assert np.isnan(first.observation.depth[0, 0])

    def test_both_surfaces_agree_and_stand_upright(self, root: Path) -> None:
        files = read_cornell(root).images[0].files
        measured, approximate = (load_surface(files, surface) for surface in Surface)
        np.testing.assert_allclose(approximate.depth[MEASURED], measured.depth[MEASURED], atol=1e-3)
        for view in (measured, approximate):
            height = world_points(view)[..., 2]
            np.testing.assert_allclose(height[BLOCK], TABLE_M + BLOCK_M, atol=1e-3)
            np.testing.assert_allclose(height[212:236, 255:385], TABLE_M, atol=1e-3)

    def test_the_image_has_colour_depth_and_the_normals_of_the_table(self, root: Path) -> None:
        view = load_cornell_view(read_cornell(root).images[0].files).observation
        image = eight_channel_image(view)
        assert image.shape == (8, 480, 640)
        np.testing.assert_allclose(image[:3, 270, 320] * 255, (40, 60, 80), atol=1e-3)
        up = view.camera.T_world_camera[2, :3]
        np.testing.assert_allclose(image[4:7, 270, 320], up, atol=0.02)
        np.testing.assert_allclose(image[3], np.nan_to_num(view.depth))

    def test_a_ray_that_stays_too_far_away_has_no_depth(self) -> None:
        assert np.isnan(depth_from_range(np.full((480, 640), 0.05, dtype=np.float32), nominal_camera())).all()


def test_writing_points_keeps_the_unknown_ones_out(tmp_path: Path) -> None:
    points = np.full((480, 640, 3), np.nan)
    points[3, 4] = (0.5, 0.25, -0.125)
    write_cloud(tmp_path / "points.txt", points)
    np.testing.assert_array_equal(read_point_cloud(tmp_path / "points.txt"), points)
