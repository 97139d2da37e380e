"""Grasps drawn into the view: the outline of the palm and the chain of each finger, or a rectangle."""

import numpy as np
import torch
from jaxtyping import Float, UInt8
from scipy.spatial import ConvexHull

from preshape.cornell.rectangle import GraspRectangle
from preshape.drawing.canvas import INITIAL_STYLE, PLANNED_STYLE, Canvas, LineStyle, points_of
from preshape.geometry.camera import Camera
from preshape.hands.kinematics import HandKinematics

NEAREST_M = 0.05
JAW_DEPTH_PX = 5.0
"""How thick the jaws of a rectangle are drawn, in pixels of the view."""


def grasp_overlay(
    rgb: UInt8[np.ndarray, "h w 3"],
    camera: Camera,
    hand: HandKinematics,
    *,
    initial: Float[np.ndarray, "d"] | None = None,
    planned: Float[np.ndarray, "d"] | None = None,
    scale: int = 2,
) -> UInt8[np.ndarray, "scaled_h scaled_w 3"]:
    """The view with the hand drawn at a grasp: initial in dashed orange, planned in thick blue.

    Args:
        rgb: the view.
        camera: its camera.
        hand: kinematics of the hand.
        initial, planned: grasps theta in the camera frame. None, NaN and a hand behind the camera are not
            drawn.
        scale: how many times the picture is larger than the view.
    """
    canvas = Canvas(rgb, scale)
    drawn = []
    for name, theta, style in (("initial", initial, INITIAL_STYLE), ("planned", planned, PLANNED_STYLE)):
        if theta is not None:
            _draw_hand(canvas, camera, hand, theta, style)
            drawn.append((name, style))
    if drawn:
        canvas.legend(drawn)
    return canvas.picture()


def rectangle_overlay(
    rgb: UInt8[np.ndarray, "h w 3"],
    *,
    initial: GraspRectangle | None = None,
    planned: GraspRectangle | None = None,
    scale: int = 2,
) -> UInt8[np.ndarray, "scaled_h scaled_w 3"]:
    """The view with grasp rectangles: initial in dashed orange, planned in thick blue.

    The jaws are drawn as filled strips at the ends of the opening, which close towards each other.

    Args:
        rgb: the view.
        initial, planned: rectangles; None is not drawn.
        scale: how many times the picture is larger than the view.
    """
    canvas = Canvas(rgb, scale)
    drawn = []
    for name, own, style in (("initial", initial, INITIAL_STYLE), ("planned", planned, PLANNED_STYLE)):
        if own is not None:
            _draw_rectangle(canvas, own, style)
            drawn.append((name, style))
    if drawn:
        canvas.legend(drawn)
    return canvas.picture()


def _draw_rectangle(canvas: Canvas, rectangle: GraspRectangle, style: LineStyle) -> None:
    corners = rectangle.corners()
    outline = points_of(corners)
    canvas.line([*outline, outline[0]], style)
    outwards = (corners[1] - corners[0]) / max(rectangle.opening_px, 1e-6) * JAW_DEPTH_PX
    for jaw, out in ((corners[[3, 0]], -outwards), (corners[[1, 2]], outwards)):
        canvas.area(points_of(np.concatenate((jaw, jaw[::-1] + out))), style.colour, 0.7)


def _draw_hand(
    canvas: Canvas,
    camera: Camera,
    hand: HandKinematics,
    theta: Float[np.ndarray, "d"],
    style: LineStyle,
) -> None:
    batch = torch.as_tensor(theta, dtype=torch.float64)[None]
    with torch.no_grad():
        palm, fingers = hand.palm_corners(batch)[0].numpy(), hand.finger_points(batch)[0].numpy()
    nearest = np.min([palm[:, 2].min(), fingers[..., 2].min()])
    if not nearest > NEAREST_M:
        return  # behind the camera, where nothing projects into the view, or nowhere (NaN)
    corners = np.stack(camera.project(palm), axis=-1)
    outline = points_of(corners[ConvexHull(corners).vertices])
    canvas.area(outline, style.colour, 0.25)
    canvas.line([*outline, outline[0]], style)
    for finger in fingers:
        chain = points_of(np.stack(camera.project(finger), axis=-1))
        canvas.line(chain, style)
        for joint in chain[:-1]:
            canvas.dot(joint, 0.8 * style.width_px, style.colour)
        canvas.dot(chain[-1], 1.3 * style.width_px, style.colour)
