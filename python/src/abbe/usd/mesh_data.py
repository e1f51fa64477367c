"""Meshes as numbers: faces, primvars of all interpolations, vertices that are split where corners differ."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom

from . import ply
from .context import Context, as_float
from .files import Buffer, Made
from .materials import Look
from .own import Prim, Stated
from .scene_text import Node, number
from .weld import Primvar, blocks, weld

INLINE = 24  # points of a mesh that is written into the scene
LEAST_CORNERS = 3
LIKE = 40  # points that tell meshes of equal size apart
FEW = 1 << 14  # numbers that fit into the cache

Array = npt.NDArray[Any]
# The vertex of each corner; the point of each vertex, and a corner of it, unless vertices are points.
Vertices = tuple[Array, Array | None, Array | None]


@dataclasses.dataclass
class Topology:
    counts: npt.NDArray[np.int32]
    corners: npt.NDArray[np.int32]
    point_count: int

    @property
    def starts(self) -> Array:
        return np.cumsum(self.counts, dtype=np.int64) - self.counts

    def __post_init__(self) -> None:
        counts = self.counts
        self.least = int(np.minimum.reduce(counts)) if len(counts) else 0  # corners of the smallest face
        # Corners of each face, where all have as many.
        self.size: int | None = self.least if len(counts) and self.least == int(np.maximum.reduce(counts)) else None


class BadMesh(Exception):
    """What is wrong with a mesh."""


def all_finite(values: Array) -> bool:
    """By a sum, which is not finite if one of them is not: without an array of answers. Large numbers may add up to infinity.

    Of few numbers it is the sum of squares, which is the fastest.
    """
    flat = values.reshape(-1)
    if math.isfinite(np.dot(flat, flat) if len(flat) <= FEW else np.add.reduce(flat)):
        return True
    return bool(np.isfinite(values).all())


def read_points(ctx: Context, geometry: Any, time: float) -> Array:
    """Points in single precision, checked. Raises BadMesh."""
    return checked_points(geometry.GetPointsAttr().Get(time))


def checked_points(values: Any) -> Array:
    if values is None:
        return np.zeros((0, 3), np.float32)
    points = np.asarray(values, np.float32)
    if not all_finite(points):
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise BadMesh(f"point {bad} is not finite")
    return points


def read_topology(stated: Prim, time: float, point_count: int) -> Topology:
    """Faces, checked. Raises BadMesh."""
    counts = np.asarray(stated.value("faceVertexCounts", time) or [], np.int32)
    corners = np.asarray(stated.value("faceVertexIndices", time) or [], np.int32)
    topology = Topology(counts, corners, point_count)
    if topology.least < 0:
        raise BadMesh(f"face {int(counts.argmin())} has {topology.least} corners")
    total = topology.size * len(counts) if topology.size is not None else int(counts.sum(dtype=np.int64))
    if total != len(corners):
        raise BadMesh(f"faceVertexCounts asks for {total} corners, faceVertexIndices has {len(corners)}")
    if len(corners) and int(np.maximum.reduce(corners.view(np.uint32))) >= point_count:  # numbers below 0 are large ones there
        low, high = int(corners.min()), int(corners.max())
        if low < 0 or high >= point_count:
            raise BadMesh(f"a face has point {low if low < 0 else high}, but there are {point_count}")
    return topology


def moving_points(ctx: Context, geometry: Any, prim: Usd.Prim) -> list[tuple[float, Array]]:
    """Points at each key: from samples, else along velocities. Raises BadMesh."""
    times = ctx.times
    if times.last <= times.first:
        return [(times.first, read_points(ctx, geometry, times.first))]
    samples = list(geometry.GetPointsAttr().GetTimeSamples())
    velocity = geometry.GetVelocitiesAttr()
    keys = times.of_samples(samples)
    if len(velocity.GetTimeSamples() or []) + bool(velocity.HasAuthoredValue()) > 0:
        between = [t for t in samples if times.first < t < times.last]
        keys = sorted({times.first, *between, times.last})
        base = (times.first + times.last) / 2 if not times.animated else times.first
        computed = []
        for key in keys:
            points = np.asarray(geometry.ComputePointsAtTime(key, key if times.animated else base), np.float32)
            if not all_finite(points):
                raise BadMesh("points that follow velocities are not finite")
            computed.append((key, points))
        if all(len(p) == len(computed[0][1]) for _, p in computed):
            return computed if any((p != computed[0][1]).any() for _, p in computed) else computed[:1]
    found = [(key, read_points(ctx, geometry, key)) for key in keys]
    if any(len(points) != len(found[0][1]) for _, points in found):
        ctx.report.approximated(prim, "a change of its points", "it stands as it is when the shutter opens: points come or go")
        return found[:1]
    if all(points is found[0][1] or np.array_equal(points, found[0][1]) for _, points in found[1:]):
        return found[:1]
    return found


def to_primvar(name: str, values: Array, indices: Array | None, interpolation: str, topology: Topology) -> Primvar:
    """Checks the size of a primvar. Raises BadMesh."""
    face_count, corner_count = len(topology.counts), len(topology.corners)
    need = {"constant": 1, "uniform": face_count, "faceVarying": corner_count}.get(interpolation, topology.point_count)
    if indices is not None and len(indices) and (int(indices.min()) < 0 or int(indices.max()) >= len(values)):
        raise BadMesh(f"the indices of primvar {name} leave its {len(values)} values")
    have = len(values) if indices is None else len(indices)
    if have < need:
        raise BadMesh(f"primvar {name} ({interpolation}) has {have} values for {need}")
    if values.dtype.kind == "f" and not all_finite(values):
        raise BadMesh(f"a value of primvar {name} is not finite")
    rows = values.astype(np.float32, copy=False).reshape(len(values), -1)
    if interpolation == "constant":
        first = 0 if indices is None else int(indices[0])
        return Primvar(rows, np.full(topology.point_count, first, np.int32), False)
    if interpolation == "uniform":
        of_face = np.arange(face_count, dtype=np.int32) if indices is None else indices[:face_count]
        return Primvar(rows, np.repeat(of_face, topology.size or topology.counts), True)
    if interpolation == "faceVarying":
        if indices is not None and len(rows) >= topology.point_count and np.array_equal(indices[:corner_count], topology.corners):
            return Primvar(rows, None, False)  # as by points, said in another way
        return Primvar(rows[:corner_count] if indices is None else rows, None if indices is None else indices[:corner_count], True)
    return Primvar(rows, indices, False)


def read_primvar(stated: Prim, name: str, time: float, topology: Topology) -> Primvar | None:
    """A primvar of the prim or of what holds it; None if there is none. Raises BadMesh."""
    primvar = stated.primvar(name, time)
    return None if primvar is None else to_primvar_of(name, primvar, topology)


def to_primvar_of(name: str, stated: Stated, topology: Topology) -> Primvar | None:
    """None of what is not numbers. Raises BadMesh."""
    values, indices, interpolation = stated
    array = np.asarray(values) if hasattr(values, "__len__") and not isinstance(values, str) else np.asarray([values])
    if array.dtype.kind not in "fiu":
        return None
    if not type(values).__name__.endswith("Array"):
        array = array.reshape(1, -1)
    return to_primvar(name, array, None if not indices else np.asarray(indices, np.int32), interpolation, topology)


def flipped(topology: Topology) -> Array:
    """For each corner, which one is there when all faces are turned around."""
    if topology.size is not None:
        order: Array = np.arange(len(topology.corners)).reshape(-1, topology.size)[:, ::-1].reshape(-1)
        return order
    starts = np.repeat(topology.starts, topology.counts)
    lengths = np.repeat(topology.counts, topology.counts)
    at = np.arange(len(topology.corners))
    turned: Array = starts + lengths - 1 - (at - starts)
    return turned


def without_faces(topology: Topology, gone: Array) -> tuple[Topology, Array]:
    """The other faces, and which corners they have."""
    keep = np.ones(len(topology.counts), bool)
    keep[gone] = False
    return of_faces(topology, keep)


def of_faces(topology: Topology, keep: Array) -> tuple[Topology, Array]:
    kept_corners = np.flatnonzero(np.repeat(keep, topology.counts))
    return Topology(topology.counts[keep], topology.corners[kept_corners], topology.point_count), kept_corners


@dataclasses.dataclass
class Surface:
    """A mesh as it was read: all that the parts of it share."""

    stated: Prim
    topology: Topology
    points: list[tuple[float, Array]]
    uvs: Primvar | None
    normals: list[Primvar]  # one for each key, or none
    attributes: dict[str, Primvar]
    faces: Array | None = None  # the numbers that the faces have in the stage; None: as they are

    @property
    def prim(self) -> Usd.Prim:
        return self.stated.prim

    def face_numbers(self) -> Array:
        return np.arange(len(self.topology.counts)) if self.faces is None else self.faces

    def by_corner(self) -> list[Primvar]:
        found = [p for p in (self.uvs, *self.normals, *self.attributes.values()) if p is not None]
        return [p for p in found if p.by_corner]


def _read_normals(stated: Prim, keys: list[float], topology: Topology) -> list[Primvar]:
    """Normals of polygons: primvars:normals, else normals; those of whole faces are as good as none."""
    found: list[Primvar] = []
    for time in keys:
        primvar = stated.primvar("normals", time) if "primvars:normals" in stated.names else None
        if primvar is not None:
            if primvar.interpolation in ("constant", "uniform"):
                return []
            one = to_primvar_of("normals", primvar, topology)
        elif "normals" not in stated.names:
            return []
        else:
            mesh = UsdGeom.Mesh(stated.prim)
            interpolation, values = str(mesh.GetNormalsInterpolation()), mesh.GetNormalsAttr().Get(time)
            if interpolation in ("constant", "uniform"):
                return []
            one = None if values is None or not len(values) else to_primvar("normals", np.asarray(values), None, interpolation, topology)
        if one is None or one.values.shape[1] != 3:
            return []
        found.append(one)
    return found


def _points_of_mesh(ctx: Context, stated: Prim) -> list[tuple[float, Array]]:
    """Its points at each key. Raises BadMesh."""
    times, prim = ctx.times, stated.prim
    moves = times.last > times.first and ("velocities" in stated.names or prim.GetAttribute("points").ValueMightBeTimeVarying())
    return moving_points(ctx, UsdGeom.Mesh(prim), prim) if moves else [(times.first, checked_points(stated.value("points", times.first)))]


def read_surface(ctx: Context, stated: Prim, looks: list[Look], is_cage: bool) -> Surface | None:
    """A mesh with what its materials ask for. None where there is nothing to show. Raises BadMesh."""
    prim, time = stated.prim, ctx.times.first
    points = _points_of_mesh(ctx, stated)
    topology = read_topology(stated, time, len(points[0][1]))
    if not len(topology.corners) or not len(points[0][1]):
        ctx.report.left_out(prim, "a mesh without faces", "it shows nothing")
        return None
    gone = np.flatnonzero(topology.counts < LEAST_CORNERS) if topology.least < LEAST_CORNERS else np.zeros(0, np.int64)
    if len(gone):
        ctx.report.left_out(prim, "faces of fewer than three corners", "they have no area")
    uv_names = [look.uv for look in looks if look.uv]
    uvs = None
    for name in [*dict.fromkeys(uv_names), "st"] if uv_names else ["st"]:
        uvs = read_primvar(stated, name, time, topology)
        if uvs is not None and uvs.values.shape[1] >= 2:
            uvs.values = uvs.values[:, :2]
            break
        uvs = None
    if uvs is None and uv_names:
        uvs = Primvar(np.zeros((1, 2), np.float32), np.zeros(len(points[0][1]), np.int32), False)
        ctx.report.approximated(prim, f"the texture coordinates {uv_names[0]}", "it has none: 0 0 everywhere")
    attributes = {}
    for look in looks:
        for name, (source, size, fallback) in look.attributes.items():
            values = read_primvar(stated, source, time, topology)
            if values is None or values.values.shape[1] < size:
                rows = np.asarray([fallback], np.float32).reshape(1, -1)
                values = Primvar(rows, np.zeros(len(points[0][1]), np.int32), False)
            values.values = values.values[:, :size]
            attributes[name] = values
    normals = [] if is_cage else _read_normals(stated, [key for key, _ in points], topology)
    surface = Surface(stated, topology, points, uvs, normals, attributes)
    if not is_cage:
        holes = np.asarray(stated.value("holeIndices", time) or [], np.int64)
        if len(holes) and (int(holes.min()) < 0 or int(holes.max()) >= len(topology.counts)):
            raise BadMesh(f"holeIndices names face {int(holes.max())}, but there are {len(topology.counts)}")
        gone = np.union1d(gone, holes).astype(np.int64) if len(holes) else gone
    if len(gone):
        surface.topology, kept = without_faces(topology, gone)
        if not len(kept):
            ctx.report.left_out(prim, "a mesh without faces", "those it has are holes, or have no area")
            return None
        surface.faces = np.delete(np.arange(len(topology.counts)), gone)
        _select(surface, kept)
    if stated.value("orientation", time) == UsdGeom.Tokens.leftHanded:
        order = flipped(surface.topology)
        surface.topology = dataclasses.replace(surface.topology, corners=surface.topology.corners[order])
        _select(surface, order)
    return surface


def _select(surface: Surface, corners: Array) -> None:
    """Takes these corners in this order, in all that belongs to corners."""
    done: set[int] = set()
    for primvar in surface.by_corner():
        if id(primvar) not in done:
            primvar.index = corners if primvar.index is None else primvar.index[corners]
            done.add(id(primvar))


def part(surface: Surface, faces: Array) -> Surface:
    """The faces of a mask, as a mesh of its own."""
    topology, kept = of_faces(surface.topology, faces)

    def taken(p: Primvar | None) -> Primvar | None:
        if p is None or not p.by_corner:
            return p
        return Primvar(p.values, kept if p.index is None else p.index[kept], True)

    normals = [n for n in (taken(p) for p in surface.normals) if n is not None]
    attributes = {k: v for k, v in ((k, taken(p)) for k, p in surface.attributes.items()) if v is not None}
    return Surface(surface.stated, topology, surface.points, taken(surface.uvs), normals, attributes, surface.face_numbers()[faces])


def vertices(surface: Surface) -> Vertices:
    topology = surface.topology
    split = surface.by_corner()
    if split:
        return weld(topology.corners, topology.point_count, split)
    used = np.zeros(topology.point_count, bool)
    for block in blocks(len(topology.corners)):
        used[topology.corners[block]] = True
    if used.all():
        return topology.corners, None, None
    number_of = np.cumsum(used) - 1
    return number_of[topology.corners].astype(np.int32), np.flatnonzero(used), None


def _columns(surface: Surface, key: int, point: Array | None, corner: Array | None) -> list[ply.Group]:
    """What vertices have, by names and functions that make the rows of some of them."""
    positions = surface.points[key][1]
    count = len(positions) if point is None else len(point)
    groups: list[ply.Group] = [(["x", "y", "z"], count, lambda b: positions[b] if point is None else positions.take(point[b], axis=0))]

    def add(primvar: Primvar, names: list[str]) -> None:
        if primvar.by_corner:
            assert corner is not None
            groups.append((names, count, lambda b: primvar.at_corners(corner[b])))
        elif point is None and primvar.index is None:
            groups.append((names, count, lambda b: primvar.values[b]))
        else:
            rows = primvar.at_points(surface.topology.point_count)
            groups.append((names, count, lambda b: rows[b] if point is None else rows.take(point[b], axis=0)))

    if surface.normals:
        add(surface.normals[min(key, len(surface.normals) - 1)], ["nx", "ny", "nz"])
    if surface.uvs is not None:
        add(surface.uvs, ["u", "v"])
    for name, primvar in surface.attributes.items():
        add(primvar, ["red", "green", "blue"] if name == "color" else [name])
    return groups


def _pieces(surface: Surface, key: int, split: Vertices) -> Iterator[Buffer]:
    """The file of a mesh at one of its keys."""
    corners, point, corner = split
    return ply.mesh(_columns(surface, key, point, corner), surface.topology.counts, corners, surface.topology.size)


def _file(surface: Surface, key: int, split: Vertices | None) -> Made:
    """The file of a mesh at one of its keys. Which corners share a vertex is found when it is written, unless it is `split` already."""
    points, corners = surface.points[key][1], surface.topology.corners
    like = (len(points), len(corners), points[:LIKE].tobytes())
    return Made(32 * len(points) + 4 * len(corners), like, lambda: _pieces(surface, key, split or vertices(surface)))


def write_polygons(ctx: Context, surface: Surface, stem: str, node: Node, keep_points: bool = False) -> None:
    """A polygon mesh: in the scene if it is small, else as PLY beside it; one file for each key."""
    points, corners = surface.points[0][1], surface.topology.corners
    split: Vertices | None = (corners, None, None) if keep_points else None
    if not surface.normals and min(len(points), len(corners)) <= INLINE:
        split = split or vertices(surface)
        if len(points if split[1] is None else split[1]) <= INLINE:
            _write_small(ctx, surface, split, node)
            return
    if len(surface.points) > 1:
        split = split or vertices(surface)  # once for all keys
    for key, (time, _) in enumerate(surface.points):
        ref = ctx.files.add(stem if key == 0 else f"{stem}.{key}", "ply", _file(surface, key, split))
        if len(surface.points) == 1:
            node.file(ref)
        else:
            node.child("at", number(ctx.times.seconds(time)), "s").child("file").file(ref)


def _write_small(ctx: Context, surface: Surface, split: Vertices, node: Node) -> None:
    """A mesh that stands in the scene itself."""
    every = slice(0, INLINE)
    for key, (time, _) in enumerate(surface.points):
        groups = _columns(surface, key, split[1], split[2])
        at = node if len(surface.points) == 1 else node.child("at", number(ctx.times.seconds(time)), "s")
        at.rows("points", _shortest(groups[0][2](every)))
        if key == 0:
            _write_inline(surface, split[0], {names[0]: rows(every) for names, _, rows in groups}, node)


def _shortest(rows: ply.Floats) -> list[list[float]]:
    return [[as_float(x) + 0.0 for x in row] for row in rows]


def _write_inline(surface: Surface, corners: Array, rows: dict[str, ply.Floats], node: Node) -> None:
    faces = node.child("faces")
    starts, counts = surface.topology.starts, surface.topology.counts
    faces.children = [Node("-").numbers(corners[s : s + n]) for s, n in zip(starts, counts, strict=True)]
    if surface.uvs is not None:
        node.rows("uvs", _shortest(rows["u"]))
    for name in surface.attributes:
        if name == "color":
            attribute = node.child("attribute").text("color")
            attribute.children = [Node("-").numbers(row) for row in _shortest(rows["red"])]
        else:
            node.child("attribute").text(name).numbers(as_float(x) for x in rows[name][:, 0])
