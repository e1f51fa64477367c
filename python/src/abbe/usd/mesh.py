"""Meshes: polygons, subdivision surfaces, materials of subsets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom, UsdShade

from .cages import cage_node
from .context import Context, Place, write_transform
from .materials import Look
from .mesh_data import BadMesh, Surface, part, read_surface, write_polygons
from .own import Prim
from .report import Fate
from .scene_text import Node

Array = npt.NDArray[Any]


def subsets_of(ctx: Context, stated: Prim) -> list[tuple[UsdGeom.Subset, Array]]:
    """Subsets with materials, and their faces. Raises BadMesh."""
    found: list[tuple[UsdGeom.Subset, Array]] = []
    if not stated.has_children:
        return found
    prim = stated.prim
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    face_count = len(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(ctx.times.first) or []) if subsets else 0
    for subset in subsets:
        if subset.GetElementTypeAttr().Get() != UsdGeom.Tokens.face:
            ctx.report.left_out(subset.GetPrim(), "a subset that is none of faces", "materials belong to faces")
            continue
        indices = np.asarray(subset.GetIndicesAttr().Get(ctx.times.first) or [], np.int64)
        if len(indices) and (int(indices.min()) < 0 or int(indices.max()) >= face_count):
            raise BadMesh(f"subset {subset.GetPrim().GetName()} names face {int(indices.max())}, but there are {face_count}")
        ctx.report.count(subset.GetPrim(), Fate.USED)
        found.append((subset, indices))
    return found


def _with_material(node: Node, look: Look) -> Node:
    if look.name:
        node.child("material").named(look.name)
    return node


def _polygon_parts(ctx: Context, surface: Surface, subsets: list[tuple[UsdGeom.Subset, Array, Look]], look: Look) -> list[tuple[str, Surface, Look]]:
    """A mesh by materials: the faces of each subset, and those of none."""
    path = surface.stated.path
    if not subsets:
        return [(path, surface, look)]
    numbers = surface.face_numbers()
    total = int(numbers.max()) + 1 if len(numbers) else 0
    owner = np.full(total, -1, np.int64)
    for i, (_, faces, _) in enumerate(subsets):
        owner[faces[faces < total]] = i
    owner = owner[numbers]
    if not (owner >= 0).any():
        return [(path, surface, look)]
    parts = []
    if (owner < 0).any():
        parts.append((path, part(surface, owner < 0), look))
    for i, (subset, _, own) in enumerate(subsets):
        if (owner == i).any():
            parts.append((str(subset.GetPath()), part(surface, owner == i), own))
    return parts


def convert_mesh(ctx: Context, stated: Prim, place: Place, look: Look, look_of_subset: Callable[[UsdGeom.Subset], Look]) -> list[Node]:
    """The shapes that a mesh becomes; none, with remarks, where it cannot be."""
    prim = stated.prim
    scheme = str(stated.value("subdivisionScheme", Usd.TimeCode.Default()) or "catmullClark")
    try:
        subsets = [(s, faces, look_of_subset(s)) for s, faces in subsets_of(ctx, stated)]
        looks = [look, *(own for _, _, own in subsets)]
        displaced = next((one.displacement for one in looks if one.displacement), None)
        is_cage = scheme != "none" or displaced is not None
        surface = read_surface(ctx, stated, looks, is_cage)
        if surface is None:
            ctx.report.count(prim, Fate.LEFT_OUT)
            return []
        if is_cage:
            node = cage_node(ctx, UsdGeom.Mesh(prim), surface, scheme, subsets, look)
            shapes = [node] if node else []
        else:
            shapes = []
            for path, one, own in _polygon_parts(ctx, surface, subsets, look):
                node = Node("shape").named(ctx.name("shape", path)).word("mesh")
                write_polygons(ctx, one, path, node)
                shapes.append(_with_material(node, own))
    except BadMesh as fault:
        ctx.report.error("E0802", prim, "the mesh makes no sense", str(fault))
        return []
    ctx.grow(surface.points[0][1], place)
    return [node for node in shapes if write_transform(ctx, node, place, prim)]
