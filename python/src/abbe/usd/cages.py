"""Cages of subdivision surfaces: scheme, creases, corners, holes, rules of boundaries, materials of parts."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom

from . import ply
from .context import Context, as_float
from .materials import Look
from .mesh_data import BadMesh, Surface, write_polygons
from .scene_text import Node, number
from .weld import Comparison, Primvar, corners_of_points, odd_corners

Array = npt.NDArray[Any]

SCHEMES = {"catmullClark": "catmull-clark", "loop": "loop", "bilinear": "bilinear", "none": "bilinear"}
BOUNDARIES = {"none": "none", "edgeOnly": "edge-only", "edgeAndCorner": "edge-and-corner"}
TEXTURE_BOUNDARIES = {
    "none": "none",
    "cornersOnly": "corners-only",
    "cornersPlus1": "corners-plus1",
    "cornersPlus2": "corners-plus2",
    "boundaries": "boundaries",
    "all": "all",
}
INFINITE = 10.0  # the sharpness from which on an edge is not smooth at all


def _checked(name: str, values: Array, count: int) -> Array:
    if len(values) and (int(values.min()) < 0 or int(values.max()) >= count):
        raise BadMesh(f"{name} names point {int(values.max())}, but there are {count}")
    return values


def _creases(mesh: UsdGeom.Mesh, time: float, point_count: int) -> list[tuple[list[int], float]]:
    """Chains of points with one sharpness each. Raises BadMesh."""
    lengths = np.asarray(mesh.GetCreaseLengthsAttr().Get(time) or [], np.int64)
    indices = _checked("creaseIndices", np.asarray(mesh.GetCreaseIndicesAttr().Get(time) or [], np.int64), point_count)
    sharpness = np.asarray(mesh.GetCreaseSharpnessesAttr().Get(time) or [], np.float64)
    if len(lengths) and int(lengths.min()) < 2:
        raise BadMesh("a crease of creaseLengths has fewer than two points")
    if int(lengths.sum()) != len(indices):
        raise BadMesh(f"creaseLengths asks for {int(lengths.sum())} points, creaseIndices has {len(indices)}")
    edges = int((lengths - 1).sum())
    if len(sharpness) not in (len(lengths), edges):
        raise BadMesh(f"creaseSharpnesses has {len(sharpness)} values, for {len(lengths)} creases of {edges} edges")
    if not np.isfinite(sharpness).all():
        raise BadMesh("a value of creaseSharpnesses is not finite")
    found: list[tuple[list[int], float]] = []
    at = edge = 0
    per_crease = len(sharpness) == len(lengths)
    for i, length in enumerate(lengths.tolist()):
        chain = indices[at : at + length].tolist()
        if per_crease:
            found.append((chain, float(sharpness[i])))
        else:
            found += [([chain[k], chain[k + 1]], float(sharpness[edge + k])) for k in range(length - 1)]
        at, edge = at + length, edge + length - 1
    return [(chain, min(value, INFINITE)) for chain, value in found if value > 0]


def _corners(mesh: UsdGeom.Mesh, time: float, point_count: int) -> list[tuple[int, float]]:
    indices = _checked("cornerIndices", np.asarray(mesh.GetCornerIndicesAttr().Get(time) or [], np.int64), point_count)
    sharpness = np.asarray(mesh.GetCornerSharpnessesAttr().Get(time) or [], np.float64)
    if len(sharpness) != len(indices):
        raise BadMesh(f"cornerSharpnesses has {len(sharpness)} values for {len(indices)} corners")
    if not np.isfinite(sharpness).all():
        raise BadMesh("a value of cornerSharpnesses is not finite")
    return [(i, min(s, INFINITE)) for i, s in zip(indices.tolist(), sharpness.tolist(), strict=True) if s > 0]


def _holes(mesh: UsdGeom.Mesh, time: float, surface: Surface) -> list[int]:
    """Holes as numbers of the faces that are left."""
    holes = np.asarray(mesh.GetHoleIndicesAttr().Get(time) or [], np.int64)
    if not len(holes):
        return []
    count = len(mesh.GetFaceVertexCountsAttr().Get(time) or [])
    if int(holes.min()) < 0 or int(holes.max()) >= count:
        raise BadMesh(f"holeIndices names face {int(holes.max())}, but there are {count}")
    return np.flatnonzero(np.isin(surface.face_numbers(), holes)).tolist()


def _scheme(ctx: Context, mesh: UsdGeom.Mesh, surface: Surface, scheme: str) -> str:
    word = SCHEMES.get(scheme)
    if word is None:
        ctx.report.unknown(mesh.GetPrim(), f"subdivisionScheme {scheme}", "catmullClark, loop, bilinear and none are; it is catmullClark")
        word = "catmull-clark"
    if word == "loop" and len(surface.topology.counts) and surface.topology.size != 3:
        ctx.report.approximated(mesh.GetPrim(), "the scheme loop", "it is catmull-clark: not all faces are triangles")
        word = "catmull-clark"
    return word


def _token(ctx: Context, mesh: UsdGeom.Mesh, attribute: Any, words: dict[str, str]) -> str | None:
    """The word of the language for an option that is not at its default."""
    if not attribute.HasAuthoredValue():
        return None
    value = str(attribute.Get(ctx.times.first))
    if value not in words:
        ctx.report.unknown(mesh.GetPrim(), f"{attribute.GetName()} {value}", f"{', '.join(words)} are")
    return words.get(value)


def seamless(surface: Surface, primvar: Primvar) -> bool:
    """Makes a primvar of corners one of points, where all corners of a point agree."""
    if not primvar.by_corner:
        return True
    topology = surface.topology
    mate = corners_of_points(topology.corners, topology.point_count)
    same = not len(odd_corners(Comparison([primvar]), topology.corners, mate))
    if same:
        of_point = np.maximum(mate, 0)
        primvar.index, primvar.by_corner = of_point if primvar.index is None else primvar.index.take(of_point), False
    return same


def _groups(ctx: Context, surface: Surface, subsets: list[tuple[UsdGeom.Subset, Array, Look]], node: Node) -> list[tuple[str, Array]]:
    """Faces by material, as groups of the file; the materials of all but the first are written."""
    if not subsets:
        return [("", np.arange(len(surface.topology.counts)))]
    numbers = surface.face_numbers()
    owner = np.full(len(numbers), -1, np.int64)
    for i, (_, faces, _) in enumerate(subsets):
        owner[np.isin(numbers, faces)] = i
    groups = [("", np.flatnonzero(owner < 0))]
    for i, (subset, _, look) in enumerate(subsets):
        faces = np.flatnonzero(owner == i)
        if len(faces):
            name = f"subset-{i}-{''.join(c if c.isascii() and c.isalnum() else '_' for c in subset.GetPrim().GetName())}"
            groups.append((name, faces))
            if look.name:
                node.child("material").named(look.name).key("group", name)
    if not len(groups[0][1]):
        groups = groups[1:]
    else:
        groups[0] = ("rest" if len(groups) > 1 else "", groups[0][1])
    return groups


def _write_file(ctx: Context, surface: Surface, groups: list[tuple[str, Array]], smooth_triangles: bool, stem: str, node: Node) -> None:
    """The cage as OBJ files, one for each key."""
    uvs = uv_corners = None
    if surface.uvs is not None:
        uvs = surface.uvs.values
        topology = surface.topology
        if surface.uvs.by_corner:
            uv_corners = np.arange(len(topology.corners)) if surface.uvs.index is None else surface.uvs.index
        else:
            uv_corners = topology.corners if surface.uvs.index is None else surface.uvs.index[topology.corners]
    if surface.attributes:
        ctx.report.left_out(surface.prim, f"primvar {', '.join(surface.attributes)}", "cages with seams or materials of parts have none")
    tags = ["t smoothtriangles 0/0/1 smooth"] if smooth_triangles else []
    for key, (time, points) in enumerate(surface.points):
        parts = ply.cage(points, surface.topology.counts, surface.topology.corners, uvs, uv_corners, groups, tags)
        ref = ctx.files.add(stem if key == 0 else f"{stem}.{key}", "obj", parts)
        if len(surface.points) == 1:
            node.file(ref)
        else:
            node.child("at", number(ctx.times.seconds(time)), "s").child("file").file(ref)


def cage_node(
    ctx: Context,
    mesh: UsdGeom.Mesh,
    surface: Surface,
    scheme: str,
    subsets: list[tuple[UsdGeom.Subset, Array, Look]],
    look: Look,
) -> Node:
    """A subdivision surface. Raises BadMesh."""
    time, path = ctx.times.first, str(surface.prim.GetPath())
    node = Node("shape").named(ctx.name("shape", path)).word("subdivision")
    creases, corners = _creases(mesh, time, surface.topology.point_count), _corners(mesh, time, surface.topology.point_count)
    holes = _holes(mesh, time, surface)
    if look.name:
        node.child("material").named(look.name)
    groups = _groups(ctx, surface, subsets, node)
    rule = mesh.GetTriangleSubdivisionRuleAttr()
    smooth = rule.HasAuthoredValue() and rule.Get(time) == "smooth" and bool((surface.topology.counts == 3).any())
    seams = surface.uvs is not None and not seamless(surface, surface.uvs)
    for name, primvar in list(surface.attributes.items()):
        if not seamless(surface, primvar):
            ctx.report.left_out(surface.prim, f"primvar {name}", "values of corners that differ at a point are not read on cages")
            primvar.values, primvar.index, primvar.by_corner = primvar.values.mean(axis=0, keepdims=True), None, False
            primvar.index = np.zeros(surface.topology.point_count, np.int64)
    if seams or len(groups) > 1 or (groups and groups[0][0]) or smooth:
        order = np.concatenate([faces for _, faces in groups])
        number_of = np.empty(len(order), np.int64)
        number_of[order] = np.arange(len(order))
        holes = sorted(number_of[holes].tolist())
        _write_file(ctx, surface, groups, smooth, path, node)
    else:
        # Creases and corners name points: they keep their numbers, used or not.
        write_polygons(ctx, surface, path, node, keep_points=True)
    _options(ctx, mesh, surface, scheme, node)
    for chain, sharpness in creases:
        crease = node.child("crease").numbers(chain)
        if sharpness < INFINITE:
            crease.key("sharpness", number(as_float(sharpness)))
    for point, sharpness in corners:
        corner = node.child("corner").numbers([point])
        if sharpness < INFINITE:
            corner.key("sharpness", number(as_float(sharpness)))
    if holes:
        node.child("holes").numbers(holes)
    displaced = [one.displacement for one in (look, *(own for _, _, own in subsets)) if one.displacement is not None]
    if displaced:
        node.adopt(displaced[0])
    if any(one is not displaced[0] for one in displaced):
        ctx.report.approximated(surface.prim, "displacements of several materials", "a shape has one: the first one's")
    return node


def _options(ctx: Context, mesh: UsdGeom.Mesh, surface: Surface, scheme: str, node: Node) -> None:
    word = _scheme(ctx, mesh, surface, scheme)
    if word != "catmull-clark":
        node.set("scheme", word)
    boundary = _token(ctx, mesh, mesh.GetInterpolateBoundaryAttr(), BOUNDARIES)
    if boundary and boundary != "edge-and-corner":
        node.set("boundary", boundary)
    texture = _token(ctx, mesh, mesh.GetFaceVaryingLinearInterpolationAttr(), TEXTURE_BOUNDARIES)
    if texture and texture != "corners-plus1":
        node.set("texture-boundary", texture)
