"""Shapes that are formulas: sphere, cube, cone, cylinder, capsule, plane."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom

from . import ply
from .context import Context, Place, as_float, write_transform
from .files import whole
from .materials import Look
from .scene_text import Node

AROUND, ALONG = 64, 16  # faces of a capsule around its axis, and of each of its halves along it
AXES = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}


def _size(ctx: Context, prim: Usd.Prim, name: str, otherwise: float) -> float | None:
    """A length above 0 in units of the stage; None with a remark."""
    value = prim.GetAttribute(name).Get(ctx.times.first)
    x = otherwise if value is None else as_float(value) if not isinstance(value, float) else value
    if not math.isfinite(x) or x < 0:
        ctx.report.error("E0802", prim, f"{name} is {x}", "a length is not below 0")
        return None
    if x == 0:
        ctx.report.left_out(prim, "what has no extent", f"{name} is 0")
        return None
    return x


def _axis(ctx: Context, prim: Usd.Prim) -> str:
    axis = str(prim.GetAttribute("axis").Get() or "Z")
    if axis not in AXES:
        ctx.report.unknown(prim, f"the axis {axis}", "X, Y and Z are; it is Z")
        return "Z"
    return axis


def _sphere(ctx: Context, prim: Usd.Prim, node: Node) -> float | None:
    radius = _size(ctx, prim, "radius", 1.0)
    if radius is not None:
        node.word("sphere").set("radius", radius)
    return radius


def _cube(ctx: Context, prim: Usd.Prim, node: Node) -> float | None:
    size = _size(ctx, prim, "size", 2.0)
    if size is not None:
        node.word("box").set("size", size, size, size)
    return None if size is None else size / 2


def _round(ctx: Context, prim: Usd.Prim, node: Node) -> float | None:
    """Cones and cylinders, also those of two radii."""
    axis, height = _axis(ctx, prim), _size(ctx, prim, "height", 2.0)
    kind = str(prim.GetTypeName())
    if height is None:
        return None
    top, bottom = 0.0, 0.0
    if kind == "Cylinder_1":
        top, bottom = (float(prim.GetAttribute(n).Get(ctx.times.first)) for n in ("radiusTop", "radiusBottom"))
        if not (top >= 0 and bottom >= 0 and max(top, bottom) > 0 and math.isfinite(top + bottom)):
            ctx.report.error("E0802", prim, f"radiusTop {top} and radiusBottom {bottom}", "radii are not below 0, and not both 0")
            return None
    else:
        radius = _size(ctx, prim, "radius", 1.0)
        if radius is None:
            return None
        top, bottom = (0.0 if kind == "Cone" else radius), radius
    node.word("cylinder" if top == bottom else "cone")
    if axis != "Y" or ctx.up == "z":
        node.set("axis", *AXES[axis])
    node.set("radius", bottom)
    if top not in (bottom, 0.0):
        node.set("top-radius", top)
    node.set("height", height)
    return max(height / 2, top, bottom)


def _plane(ctx: Context, prim: Usd.Prim, node: Node) -> float | None:
    axis, width, length = _axis(ctx, prim), _size(ctx, prim, "width", 2.0), _size(ctx, prim, "length", 2.0)
    if width is None or length is None:
        return None
    w, h = width / 2, length / 2
    # Counter-clockwise seen from the end of the axis. The width is along x (z where the axis is X), the length along y (z for Y).
    faces: dict[str, list[tuple[float, float, float]]] = {
        "Z": [(-w, -h, 0), (w, -h, 0), (w, h, 0), (-w, h, 0)],
        "Y": [(-w, 0, h), (w, 0, h), (w, 0, -h), (-w, 0, -h)],
        "X": [(0, -h, w), (0, -h, -w), (0, h, -w), (0, h, w)],
    }
    node.word("quad").rows("points", faces[axis])
    return max(w, h)


def _capsule(ctx: Context, prim: Usd.Prim, node: Node) -> float | None:
    """A mesh with normals: one body, so that glass has one inside."""
    axis, height = _axis(ctx, prim), _size(ctx, prim, "height", 1.0)
    names = ("radiusTop", "radiusBottom") if prim.GetTypeName() == "Capsule_1" else ("radius", "radius")
    top, bottom = (_size(ctx, prim, name, 0.5) for name in names)
    if height is None or top is None or bottom is None:
        return None
    profile = _capsule_profile(height, top, bottom)
    angles = np.arange(AROUND) * (2 * math.pi / AROUND)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = np.array([[r * c, r * s, z] for r, z, _, _ in profile for c, s in ring], np.float32)
    normals = np.array([[a * c, a * s, b] for _, _, a, b in profile for c, s in ring], np.float32)
    order = {"Z": [0, 1, 2], "X": [2, 0, 1], "Y": [1, 2, 0]}[axis]
    points, normals = points[:, order], normals[:, order]
    faces = []
    for row in range(len(profile) - 1):
        for i in range(AROUND):
            a, b = row * AROUND + i, row * AROUND + (i + 1) % AROUND
            faces.append((a, b, b + AROUND, a + AROUND))
    corners: npt.NDArray[np.int32] = np.array(faces, np.int32).reshape(-1)
    rows = np.hstack([points, normals])
    groups: list[ply.Group] = [(["x", "y", "z", "nx", "ny", "nz"], len(rows), lambda b: rows[b])]
    ref = ctx.files.add(str(prim.GetPath()), "ply", [whole(ply.mesh(groups, np.full(len(faces), 4, np.int32), corners, 4))])
    node.word("mesh").file(ref)
    node.remark(
        ctx.report.approximated(prim, "a capsule", f"a smooth mesh of {len(faces)} faces, within {1 - math.cos(math.pi / AROUND):.1%} of its radius")
    )
    return height / 2 + max(top, bottom)


def _capsule_profile(height: float, top: float, bottom: float) -> list[tuple[float, float, float, float]]:
    """Radius, height and normal from the lower pole to the upper one. The poles are rings of next to no radius."""
    out = []
    for centre, radius, first, last in ((-height / 2, bottom, -90.0, 0.0), (height / 2, top, 0.0, 90.0)):
        for i in range(ALONG + 1):
            angle = math.radians(first + (last - first) * i / ALONG)
            c = max(math.cos(angle), 1e-6)
            out.append((radius * c, centre + radius * math.sin(angle), c, math.sin(angle)))
    return out


FORMULAS: dict[str, Callable[[Context, Usd.Prim, Node], float | None]] = {
    "Sphere": _sphere,
    "Cube": _cube,
    "Cone": _round,
    "Cylinder": _round,
    "Cylinder_1": _round,
    "Capsule": _capsule,
    "Capsule_1": _capsule,
    "Plane": _plane,
}


def convert_formula(ctx: Context, prim: Usd.Prim, place: Place, look: Look) -> list[Node]:
    """The shape of a prim that is a formula; none, with a remark, where it cannot be."""
    node = Node("shape").named(ctx.name("shape", str(prim.GetPath())))
    extent = FORMULAS[str(prim.GetTypeName())](ctx, prim, node)
    if extent is None:
        return []
    sizes = [a for a in prim.GetAuthoredAttributes() if a.GetName() in ("radius", "size", "height", "width", "length")]
    if ctx.times.last > ctx.times.first and any(a.ValueMightBeTimeVarying() for a in sizes):
        ctx.report.approximated(prim, "a size that changes", "it is that when the shutter opens")
    if str(UsdGeom.Gprim(prim).GetOrientationAttr().Get() or "") == "leftHanded" and look.emits:
        ctx.report.approximated(prim, "leftHanded orientation", "it emits outwards")
    if look.uv or look.attributes:
        ctx.report.approximated(prim, "texture coordinates of a formula", "those of the shape here: USD states none")
    if look.name:
        node.child("material").named(look.name)
    ctx.grow(np.array([[-extent] * 3, [extent] * 3]), place)
    return [node] if write_transform(ctx, node, place, prim) else []


def wrap_for_stretch(ctx: Context, node: Node, place: Place, prim: Any, name: str) -> list[Node]:
    """What may only be scaled evenly, as an object whose instance is stretched."""
    holder = Node("object").named(name)
    holder.adopt(node)
    instance = Node("instance").named(name)
    return [holder, instance] if write_transform(ctx, instance, place, prim) else []
