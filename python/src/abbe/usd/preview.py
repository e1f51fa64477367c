"""The view and the light of a stage that has none: those that glTF and OBJ models get (docs/importing_obj.md)."""

from __future__ import annotations

import math

import numpy as np

from .context import NIT_PER_ONE, Context, Matrix
from .scene_text import Node

SIZE = (960, 720)  # pixels
FOV = 35.0  # degrees across the width, that of a short telephoto lens
FILLED = 0.9  # of the frame, by the box
AZIMUTH, ELEVATION = 30.0, 22.0  # degrees: from the front towards +x, and upwards


def _axes(ctx: Context) -> Matrix:
    """Right, up and back of the camera, as rows."""
    a, e = math.radians(AZIMUTH), math.radians(ELEVATION)
    back = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
    up = np.array([0.0, 1.0, 0.0])
    if ctx.up == "z":
        back, up = np.array([back[0], -back[2], back[1]]), np.array([0.0, 0.0, 1.0])
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(back, right), back])


def _centre(corners: Matrix, axis: int, distance: float) -> float:
    """Where the camera stands so that there is as much room on either side: by bisection."""
    low, high = float(corners[:, axis].min()), float(corners[:, axis].max())
    for _ in range(60):
        c = (low + high) / 2
        below = ((c - corners[:, axis]) / (distance - corners[:, 2])).max()
        above = ((corners[:, axis] - c) / (distance - corners[:, 2])).max()
        low, high = (c, high) if above > below else (low, c)
    return (low + high) / 2


def preview_camera(ctx: Context) -> list[Node]:
    """A camera that shows all there is, from the front and a little from above, and its film."""
    low, high = ctx.bounds
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        low, high = np.full(3, -0.5), np.full(3, 0.5)
    if (high - low).max() <= 0:
        low, high = low - 0.5, high + 0.5
    axes, half = _axes(ctx), (high - low) / 2
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = (signs * half) @ axes.T
    across = FILLED * math.tan(math.radians(FOV) / 2)

    def distance_for(axis: int, t: float) -> float:
        side = corners[:, 2] * t
        return float(max(0, (side - corners[:, axis]).max()) + max(0, (side + corners[:, axis]).max())) / (2 * t)

    distance = max(distance_for(0, across), distance_for(1, across * SIZE[1] / SIZE[0]))
    target = (low + high) / 2 + axes[0] * _centre(corners, 0, distance) + axes[1] * _centre(corners, 1, distance)

    def rounded(v: Matrix) -> list[float]:
        digits = int(3 - math.floor(math.log10(distance)))
        return [round(float(x), digits) + 0.0 for x in v]

    camera = Node("camera", "perspective")
    camera.set("from", *rounded(target + axes[2] * distance)).set("look-at", *rounded(target)).set("fov", FOV, "deg")
    camera.set("exposure", *_exposure(ctx))
    return [camera, Node("film").set("size", *SIZE)]


def _exposure(ctx: Context) -> tuple[float | str, ...]:
    return (float(f"{math.log2(NIT_PER_ONE):.8g}"), "stops") if ctx.lit or ctx.emits else (0.0, "stops")


def preview_lights(ctx: Context) -> list[Node]:
    """A neutral sky and a soft key light, bright enough for no exposure."""
    toward = (0.5, -1, -0.7) if ctx.up == "y" else (0.5, 0.7, -1)
    sky = Node("light").named("surroundings").word("sky").set("luminance", 18000, "nits")
    key = Node("light").named("key").word("sun").set("toward", *toward)
    key.set("irradiance", 150, "klx").set("angular-diameter", 20, "deg")
    return [sky, key]
