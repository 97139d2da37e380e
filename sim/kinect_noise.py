"""What a Kinect makes of a true depth image.

The first Kinect sees a projected dot pattern with an infrared camera and matches it with a stored reference.
Its errors follow from that. What is measured is disparity, in whole steps, so that noise and steps of depth
grow with the square of the distance (Khoshelham and Elberink, "Accuracy and resolution of Kinect depth data
for indoor mapping applications", Sensors 2012). Surfaces seen at a grazing angle are noisier, and edges are
ragged by a pixel or so (Nguyen, Izadi and Lovell, "Modeling Kinect sensor noise for improved 3D
reconstruction and tracking", 3DIMPVT 2012). What the projector cannot see stays dark.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from scipy.ndimage import gaussian_filter

from preshape.geometry.camera import Camera


@dataclass(frozen=True)
class KinectNoise:
    """The noise of a Kinect's depth.

    Args:
        disparity_m: depth is this over the disparity in whole steps: 351.3 m, so that a step is 2.85 mm at
            1 m (Khoshelham and Elberink, m / (f b) = 2.85e-5 per cm).
        disparity_sigma: standard deviation of the disparity (steps). Together with the steps, 0.4 gives their
            random error of 1.4 mm at 1 m.
        correlation_px: radius over which neighbours share their error, as the matching window makes them.
        grazing_sigma_m: Nguyen et al.'s factor of the noise that incidence adds, times
            angle^2 / ((90 deg - angle)^2 sqrt(depth)).
        lateral_sigma_px: how far edges wander (Nguyen et al.: 0.8 px and more).
        grazing_hole_deg: incidence from which pixels are lost more and more often; at 90 deg all are.
        baseline_m: distance from the infrared camera to the projector on its right.
        nearest_m, farthest_m: the sensor's range.
    """

    disparity_m: float = 351.3
    disparity_sigma: float = 0.4
    correlation_px: float = 1.0
    grazing_sigma_m: float = 1e-4
    lateral_sigma_px: float = 0.8
    grazing_hole_deg: float = 75.0
    baseline_m: float = 0.075
    nearest_m: float = 0.4
    farthest_m: float = 5.0

    def __call__(
        self, depth: Float32[np.ndarray, "h w"], camera: Camera, rng: np.random.Generator
    ) -> Float32[np.ndarray, "h w"]:
        """The measured depth (m, NaN in holes) for a true depth (m, NaN where there is nothing)."""
        incidence = incidence_angles(depth, camera)
        lost = self._shadow(depth, camera) | self._missed(incidence, rng)
        source = self._ragged(depth.shape, rng)
        true = depth.take(source).astype(np.float64)
        measured = self._correlated(depth.shape, rng)
        measured *= self.disparity_sigma
        measured += self.disparity_m / true
        np.maximum(np.rint(measured, out=measured), 1, out=measured)
        np.divide(self.disparity_m, measured, out=measured)
        self._add_grazing_noise(measured, incidence.take(source), true, rng)
        lost |= lost.take(source)
        lost |= ~((measured >= self.nearest_m) & (measured <= self.farthest_m))
        measured[lost] = np.nan
        return measured.astype(np.float32)

    def _missed(
        self, incidence: Float32[np.ndarray, "h w"], rng: np.random.Generator
    ) -> Bool[np.ndarray, "h w"]:
        """Pixels without a surface, and those lost at random because light grazes their surface."""
        onset = np.deg2rad(self.grazing_hole_deg)
        missed = np.isnan(incidence)
        luck = rng.random(incidence.shape)
        steep = np.flatnonzero(incidence > onset)
        missed.reshape(-1)[steep] = luck.take(steep) < (incidence.take(steep) - onset) / (np.pi / 2 - onset)
        return missed

    def _add_grazing_noise(
        self,
        measured: Float[np.ndarray, "h w"],
        incidence: Float32[np.ndarray, "h w"],
        depth: Float[np.ndarray, "h w"],
        rng: np.random.Generator,
    ) -> None:
        """Add the noise of steep incidence: Nguyen et al.'s equation for more than 60 degrees."""
        noise = rng.standard_normal(measured.shape)
        steep = np.flatnonzero(incidence > np.deg2rad(60.0))
        angle = np.minimum(incidence.take(steep), np.deg2rad(self.grazing_hole_deg))
        sigma = self.grazing_sigma_m * angle**2 / ((np.pi / 2 - angle) ** 2 * np.sqrt(depth.take(steep)))
        measured.reshape(-1)[steep] += sigma * noise.take(steep)

    def _shadow(self, depth: Float32[np.ndarray, "h w"], camera: Camera) -> Bool[np.ndarray, "h w"]:
        """Where the projector's light does not reach.

        Along a row the projector's columns rise with the camera's, unless something nearer, further right in
        the image, takes the same light.
        """
        columns = np.arange(depth.shape[1]) - camera.fx * self.baseline_m / depth
        columns[np.isnan(columns)] = np.inf
        lowest_on_the_right = np.minimum.accumulate(columns[:, ::-1], axis=1)[:, ::-1]
        shadow = np.zeros(depth.shape, bool)
        shadow[:, :-1] = columns[:, :-1] > lowest_on_the_right[:, 1:]
        return shadow

    def _ragged(self, shape: tuple[int, int], rng: np.random.Generator) -> Int[np.ndarray, "h w"]:
        """Number of the pixel, in a flat image, that each pixel really measures."""
        row, column = shift = rng.standard_normal((2, *shape))
        shift *= self.lateral_sigma_px
        np.rint(shift, out=shift)
        row += np.arange(shape[0])[:, None]
        column += np.arange(shape[1])
        np.clip(row, 0, shape[0] - 1, out=row)
        np.clip(column, 0, shape[1] - 1, out=column)
        row *= shape[1]
        row += column
        return row.astype(np.intp)

    def _correlated(self, shape: tuple[int, int], rng: np.random.Generator) -> Float[np.ndarray, "h w"]:
        """Standard normal noise that neighbours share."""
        white = rng.standard_normal(shape)
        if self.correlation_px == 0:
            return white
        smooth: Float[np.ndarray, "h w"] = gaussian_filter(white, self.correlation_px, output=white)
        # An average over a Gaussian window of white noise has this standard deviation.
        smooth *= 2 * np.sqrt(np.pi)
        smooth *= self.correlation_px
        return smooth


def incidence_angles(depth: Float32[np.ndarray, "h w"], camera: Camera) -> Float32[np.ndarray, "h w"]:
    """Angle (rad) between the line of sight and the surface's normal; near 90 degrees at depth edges."""
    rise_v, rise_u = np.gradient(depth)
    x, y = camera.rays(np.float32)
    slope_u, slope_v = camera.fx * rise_u, camera.fy * rise_v
    # The cross product of the surface's tangents along u and v, scaled so that its dot product with the
    # line of sight (x, y, 1) is the depth.
    normal_length = np.sqrt(slope_u**2 + slope_v**2 + (x * slope_u + y * slope_v + depth) ** 2)
    return np.arccos(np.minimum(depth / (normal_length * np.sqrt(x**2 + y**2 + 1)), 1))
