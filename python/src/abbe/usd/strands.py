"""Curves and points."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom

from . import ply
from .context import Context, Place, is_similarity, write_transform
from .materials import Look
from .mesh_data import BadMesh, moving_points
from .scene_text import Node, number
from .shapes import wrap_for_stretch

Array = npt.NDArray[Any]

BASES = {"bezier": "bezier", "bspline": "bspline", "catmullRom": "catmull-rom"}
SPAN = 8  # straight pieces of a span of a NURBS curve


def _counts(prim: Usd.Prim, time: float, total: int) -> Array:
    counts = np.asarray(prim.GetAttribute("curveVertexCounts").Get(time) or [], np.int64)
    if len(counts) and int(counts.min()) < 1:
        raise BadMesh(f"curve {int(counts.argmin())} has {int(counts.min())} points")
    if int(counts.sum()) != total:
        raise BadMesh(f"curveVertexCounts asks for {int(counts.sum())} points, there are {total}")
    return counts


def _widths(ctx: Context, prim: Usd.Prim, geometry: Any) -> tuple[Array, str]:
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("widths")
    if primvar and primvar.HasValue():
        flat, interpolation = primvar.ComputeFlattened(ctx.times.first), str(primvar.GetInterpolation())
    else:
        flat, interpolation = geometry.GetWidthsAttr().Get(ctx.times.first), str(geometry.GetWidthsInterpolation())
    widths = np.asarray(flat if flat is not None else [], np.float32)
    if not len(widths):
        ctx.report.approximated(prim, "what has no widths", "1 unit of the stage")
        return np.ones(1, np.float32), "constant"
    if not np.isfinite(widths).all():
        raise BadMesh("a width is not finite")
    return np.maximum(widths, 0), interpolation


def _vertex_radii(widths: Array, interpolation: str, counts: Array, total: int, step: int, is_cubic: bool) -> Array:
    """The radius at each point. Those of the ends of segments are brought to the points, linear in between."""
    if interpolation == "constant" or len(widths) == 1:
        return np.full(total, widths[0] / 2, np.float32)
    if interpolation == "uniform" and len(widths) >= len(counts):
        return np.repeat(widths[: len(counts)] / 2, counts).astype(np.float32)
    if interpolation == "vertex" or (interpolation == "varying" and not is_cubic) or len(widths) == total:
        if len(widths) < total:
            raise BadMesh(f"there are {len(widths)} widths for {total} points")
        return (widths[:total] / 2).astype(np.float32)
    out, at = [], 0
    for n in counts.tolist():
        ends = (n - 4) // step + 2 if step == 3 else n - 2
        values = widths[at : at + ends]
        if ends < 1 or len(values) < ends:
            raise BadMesh(f"there are {len(widths)} varying widths, too few for the segments")
        places = np.arange(n) / 3 if step == 3 else np.arange(n) - 1.0
        out.append(np.interp(places, np.arange(ends), values))
        at += ends
    return (np.concatenate(out) / 2).astype(np.float32)


def _split(rows: Array, counts: Array) -> list[Array]:
    return np.split(rows, np.cumsum(counts)[:-1]) if len(counts) else []


def _closed(rows: Array, basis: str) -> Array:
    """A periodic curve with its first points again at the end."""
    return np.concatenate([rows, rows[: 1 if basis in ("linear", "bezier") else 3]])


def _pinned(rows: Array) -> Array:
    """Points before the first and behind the last one, so that the curve reaches both."""
    return np.concatenate([[2 * rows[0] - rows[1]], rows, [2 * rows[-1] - rows[-2]]])


def _wrap(strands: list[Array], wrap: str, basis: str) -> list[Array]:
    if wrap == "periodic":
        return [_closed(s, basis) for s in strands]
    if wrap == "pinned" and basis in ("bspline", "catmullRom"):
        return [_pinned(s) if len(s) > 1 else s for s in strands]
    return strands


def _usable(ctx: Context, prim: Usd.Prim, strands: list[Array], basis: str) -> list[int]:
    """Which strands have enough points for their basis."""
    least = 2 if basis == "linear" else 4
    good = [i for i, s in enumerate(strands) if len(s) >= least and (basis != "bezier" or len(s) % 3 == 1)]
    if len(good) < len(strands):
        ctx.report.left_out(prim, "strands of too few points", f"{basis} needs {'4, 7, 10, …' if basis == 'bezier' else f'at least {least}'}")
    return good


def basis_curves(ctx: Context, prim: Usd.Prim) -> tuple[str, list[tuple[float, list[Array]]]]:
    """Basis, and at each key the strands: rows of x y z and radius. Raises BadMesh."""
    geometry = UsdGeom.BasisCurves(prim)
    keys = moving_points(ctx, geometry, prim)
    counts = _counts(prim, ctx.times.first, len(keys[0][1]))
    cubic = str(geometry.GetTypeAttr().Get() or "cubic") != "linear"
    basis = str(geometry.GetBasisAttr().Get() or "bezier") if cubic else "linear"
    if cubic and basis not in BASES:
        ctx.report.approximated(prim, f"the basis {basis}", "straight lines between its points")
        basis = "linear"
    widths, interpolation = _widths(ctx, prim, geometry)
    wrap = str(geometry.GetWrapAttr().Get() or "nonperiodic")
    if geometry.GetNormalsAttr().HasAuthoredValue():
        ctx.report.approximated(prim, "ribbons with normals", "tubes of the same width")
    if wrap != "nonperiodic" and interpolation == "varying" and cubic:
        ctx.report.approximated(prim, f"varying widths of {wrap} curves", "their mean is taken")
        widths, interpolation = widths.mean(keepdims=True), "constant"
    radii = _vertex_radii(widths, interpolation, counts, len(keys[0][1]), 3 if basis == "bezier" else 1, cubic)
    out = []
    for time, points in keys:
        rows = np.concatenate([points, radii[:, None]], axis=1)
        out.append((time, _wrap(_split(rows, counts), wrap, basis)))
    return basis, out


def hermite_curves(ctx: Context, prim: Usd.Prim) -> tuple[str, list[tuple[float, list[Array]]]]:
    """Hermite curves are Bézier curves: P, P + T/3, Q - U/3, Q. Raises BadMesh."""
    geometry = UsdGeom.HermiteCurves(prim)
    time = ctx.times.first
    keys = moving_points(ctx, geometry, prim)[:1]
    points = keys[0][1]
    counts = _counts(prim, time, len(points))
    tangents = np.asarray(geometry.GetTangentsAttr().Get(time) or [], np.float32).reshape(-1, 3)
    if len(tangents) != len(points) or not np.isfinite(tangents).all():
        raise BadMesh(f"there are {len(tangents)} tangents for {len(points)} points, or they are not finite")
    widths, interpolation = _widths(ctx, prim, geometry)
    radii = _vertex_radii(widths, interpolation, counts, len(points), 1, False)
    strands = []
    rows, slopes = np.concatenate([points, radii[:, None]], axis=1), np.pad(tangents, ((0, 0), (0, 1)))
    for p, t in zip(_split(rows, counts), _split(slopes, counts), strict=True):
        if len(p) < 2:
            continue
        t = t.copy()
        t[:, 3] = np.gradient(p[:, 3])
        inner = np.stack([p[:-1], p[:-1] + t[:-1] / 3, p[1:] - t[1:] / 3], axis=1).reshape(-1, 4)
        strands.append(np.concatenate([inner, p[-1:]]))
    return "bezier", [(time, strands)]


def nurbs_curves(ctx: Context, prim: Usd.Prim) -> tuple[str, list[tuple[float, list[Array]]]]:
    """NURBS curves in straight pieces, by de Boor's algorithm. Raises BadMesh."""
    geometry = UsdGeom.NurbsCurves(prim)
    time = ctx.times.first
    points = moving_points(ctx, geometry, prim)[0][1]
    counts = _counts(prim, time, len(points))
    orders = np.asarray(geometry.GetOrderAttr().Get(time) or [], np.int64)
    knots = np.asarray(geometry.GetKnotsAttr().Get(time) or [], np.float64)
    weights = np.asarray(geometry.GetPointWeightsAttr().Get(time) or np.ones(len(points)), np.float64)
    if len(orders) != len(counts) or len(knots) != int((counts + orders).sum()) or len(weights) != len(points):
        raise BadMesh(f"{len(orders)} orders, {len(knots)} knots and {len(weights)} weights do not fit {len(counts)} curves of {len(points)} points")
    if (orders < 2).any() or (counts < orders).any() or not np.isfinite(knots).all() or not (weights > 0).all():
        raise BadMesh("an order below 2 or above the number of points, or a knot or weight that is no good number")
    widths, interpolation = _widths(ctx, prim, geometry)
    radii = _vertex_radii(widths, interpolation, counts, len(points), 1, False)
    rows = np.concatenate([points, radii[:, None]], axis=1).astype(np.float64)
    ctx.report.approximated(prim, "NURBS curves", f"{SPAN} straight pieces for each span")
    out, p0, k0 = [], 0, 0
    for n, order in zip(counts.tolist(), orders.tolist(), strict=True):
        k = knots[k0 : k0 + n + order]
        out.append(_de_boor(rows[p0 : p0 + n], weights[p0 : p0 + n], k, order).astype(np.float32))
        p0, k0 = p0 + n, k0 + n + order
    return "linear", [(time, out)]


def _de_boor(rows: Array, weights: Array, knots: Array, order: int) -> Array:
    degree = order - 1
    breaks = np.unique(knots[degree : len(rows) + 1])
    if len(breaks) < 2 or (np.diff(knots) < 0).any():
        raise BadMesh("knots that do not grow")
    places = np.unique(np.concatenate([np.linspace(a, b, SPAN + 1) for a, b in itertools.pairwise(breaks)]))
    homogeneous = np.concatenate([rows * weights[:, None], weights[:, None]], axis=1)
    out = []
    for u in places:
        span = min(max(int(np.searchsorted(knots, u, "right")) - 1, degree), len(rows) - 1)
        d = homogeneous[span - degree : span + 1].copy()
        for r in range(1, order):
            for j in range(degree, r - 1, -1):
                i = span - degree + j
                width = knots[i + degree - r + 1] - knots[i]
                a = (u - knots[i]) / width if width > 0 else 0.0
                d[j] = (1 - a) * d[j - 1] + a * d[j]
        out.append(d[degree, :-1] / d[degree, -1])
    return np.array(out)


CURVES = {"BasisCurves": basis_curves, "HermiteCurves": hermite_curves, "NurbsCurves": nurbs_curves}


def convert_curves(ctx: Context, prim: Usd.Prim, place: Place, look: Look) -> list[Node]:
    try:
        basis, keys = CURVES[str(prim.GetTypeName())](ctx, prim)
    except BadMesh as fault:
        ctx.report.error("E0802", prim, "the curves make no sense", str(fault))
        return []
    good = _usable(ctx, prim, keys[0][1], basis)
    if not good:
        ctx.report.left_out(prim, "curves without strands", "they show nothing")
        return []
    node = Node("shape").named(ctx.name("shape", str(prim.GetPath()))).word("curves")
    node.set("basis", BASES.get(basis, "linear"))
    counts = np.array([len(keys[0][1][i]) for i in good], np.int32)
    return _points_shape(ctx, prim, place, look, node, [(t, np.concatenate([s[i] for i in good])) for t, s in keys], counts)


def _points_shape(
    ctx: Context, prim: Usd.Prim, place: Place, look: Look, node: Node, keys: list[tuple[float, Array]], counts: Array | None
) -> list[Node]:
    """Rows of x y z and radius as files; the shape in its place."""
    for key, (time, rows) in enumerate(keys):
        columns = [(name, np.ascontiguousarray(rows[:, i], np.float32)) for i, name in enumerate(("x", "y", "z", "radius"))]
        parts = ply.rows_of(columns) if counts is None else ply.strands(columns, counts)
        ref = ctx.files.add(str(prim.GetPath()) + (f".{key}" if key else ""), "ply", parts)
        if len(keys) == 1:
            node.file(ref)
        else:
            node.child("at", number(ctx.times.seconds(time)), "s").child("file").file(ref)
    if look.emits:
        ctx.report.left_out(prim, "what it emits", "curves and points cannot emit: they are dark")
    if look.attributes:
        ctx.report.approximated(prim, "primvars of curves or points", "materials of primvars are for meshes: grey and matte")
    elif look.name and not look.emits:
        node.child("material").named(look.name)
    ctx.grow(keys[0][1][:, :3], place)
    if all(is_similarity(place.at(t)) for t in ctx.keys(place)):
        return [node] if write_transform(ctx, node, place, prim) else []
    return wrap_for_stretch(ctx, node, place, prim, ctx.name("object", f"{str(prim.GetPath()).strip('/')}"))


def convert_points(ctx: Context, prim: Usd.Prim, place: Place, look: Look) -> list[Node]:
    geometry = UsdGeom.Points(prim)
    try:
        keys = moving_points(ctx, geometry, prim)
        count = len(keys[0][1])
        widths, interpolation = _widths(ctx, prim, geometry)
        radii = np.full(count, widths[0] / 2) if interpolation == "constant" or len(widths) == 1 else widths[:count] / 2
        if len(radii) < count:
            raise BadMesh(f"there are {len(widths)} widths for {count} points")
    except BadMesh as fault:
        ctx.report.error("E0802", prim, "the points make no sense", str(fault))
        return []
    if not count:
        ctx.report.left_out(prim, "points without points", "they show nothing")
        return []
    node = Node("shape").named(ctx.name("shape", str(prim.GetPath()))).word("points")
    rows = [(t, np.concatenate([p, radii[:, None]], axis=1)) for t, p in keys]
    return _points_shape(ctx, prim, place, look, node, rows, None)
