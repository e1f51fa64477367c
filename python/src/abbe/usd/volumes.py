"""UsdVol: OpenVDB fields become `volume vdb`."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade, UsdVol

from .assets import resolve_asset
from .context import Context, Place, as_float, write_transform
from .network import Network, node_kind
from .report import Fate
from .scene_text import FileRef, Node
from .texture import Const

# What fields are called, and what they are here.
ROLES = {"density": "density", "temperature": "temperature", "flame": "flame", "flames": "flame", "heat": "temperature",
         "color": "color", "Cd": "color", "velocity": "velocity", "v": "velocity", "vel": "velocity"}  # fmt: skip
VECTORS = ("color", "velocity")


def _fields(ctx: Context, prim: Usd.Prim) -> list[tuple[str, FileRef, str]]:
    """Role, file and name of the grid of each field that can be used."""
    found: list[tuple[str, FileRef, str]] = []
    for name, path in sorted(UsdVol.Volume(prim).GetFieldPaths().items()):
        field = ctx.stage.GetPrimAtPath(path)
        if not field.IsValid():
            ctx.report.error("E0802", prim, f"the field {name} is not there", f"there is no prim {path}")
            continue
        if not field.IsA(UsdVol.OpenVDBAsset):
            ctx.report.left_out(field, f"a field of type {field.GetTypeName()}", "OpenVDBAsset is read")
            continue
        asset = UsdVol.OpenVDBAsset(field)
        file = asset.GetFilePathAttr().Get(ctx.times.first)
        if not isinstance(file, Sdf.AssetPath) or not file.path:
            ctx.report.error("E0802", field, "filePath is empty", "name the OpenVDB file")
            continue
        ref = resolve_asset(ctx, field, file, asset.GetFilePathAttr())
        if ref is None:
            continue
        grid = str(asset.GetFieldNameAttr().Get(ctx.times.first) or name)
        if asset.GetFieldIndexAttr().Get(ctx.times.first):
            ctx.report.left_out(field, "fieldIndex", "the first grid of the name is taken")
        role = ROLES.get(name) or ROLES.get(grid)
        if role in [r for r, _, _ in found]:
            ctx.report.left_out(field, f"the field {name}", f"there is a field of {role} already")
            continue
        if role is None:
            ctx.report.left_out(field, f"the field {name}", f"{', '.join(sorted(ROLES))} have a meaning")
            continue
        ctx.report.count(field, Fate.USED)
        found.append((role, ref, grid))
    return found


def _medium(ctx: Context, prim: Usd.Prim, material: UsdShade.Material | None, node: Node) -> None:
    """Scattering and absorption: of MaterialX's anisotropic_vdf, else those of a white cloud."""
    source = material.ComputeVolumeSource("mtlx")[0] if material else None
    if not source and material:
        source = material.ComputeVolumeSource()[0]
    if not source:
        node.set("extinction", 1 / ctx.metres, "per-m").set("albedo", 0.8)
        ctx.report.approximated(prim, "a volume without a volume shader", "extinction 1 per unit of the stage, albedo 0.8")
        return
    net, shader = Network(ctx, material), source
    if node_kind(str(source.GetIdAttr().Get() or "")) == "volume":
        found = net.source(source, "vdf")
        if found and found[1]:
            shader = UsdShade.Shader(found[0].GetPrim())
        emission = net.source(source, "edf")
        if emission and emission[1]:
            ctx.report.left_out(source.GetPrim(), "what the volume emits", "state a temperature or emission in the scene")
    kind = node_kind(str(shader.GetIdAttr().Get() or ""))
    if kind not in ("anisotropic", "absorption"):
        ctx.report.left_out(shader.GetPrim(), f"the volume shader {shader.GetIdAttr().Get()}", "extinction 1 per unit of the stage, albedo 0.8")
        node.set("extinction", 1 / ctx.metres, "per-m").set("albedo", 0.8)
        return
    for name in ("scattering", "absorption"):
        value = net.value(shader, name, Const((0.0,)))
        rgb = value.rgb() if isinstance(value, Const) else (0.0,) * 3
        if not isinstance(value, Const):
            ctx.report.left_out(shader.GetPrim(), f"a texture of {name}", "the grid of densities alone varies: it is 0")
        per_metre = [as_float(max(0.0, x)) / ctx.metres for x in rgb]
        words: list[Any] = per_metre[:1] if len(set(per_metre)) == 1 else ["rgb", *per_metre]
        node.set(name, *words, "per-m")
    g = min(0.99, max(-0.99, net.number(shader, "anisotropy", 0.0)))
    if g:
        node.child("phase", "henyey-greenstein").numbers([as_float(g)])


def convert_volume(ctx: Context, prim: Usd.Prim, place: Place, material: UsdShade.Material | None) -> list[Node]:
    fields = _fields(ctx, prim)
    density = next((f for f in fields if f[0] == "density"), None)
    if density is None:
        ctx.report.left_out(prim, "a volume without a density", "a field called density is wanted")
        ctx.report.count(prim, Fate.LEFT_OUT)
        return []
    node = Node("volume").named(ctx.name("volume", str(prim.GetPath()))).word("vdb").file(density[1])
    node.child("density").text(density[2])
    for role, ref, grid in fields:
        if role == "density":
            continue
        if ref != density[1]:
            ctx.report.left_out(prim, f"the field of {role}", "all grids of a volume are in the file of its density")
        else:
            node.child(role).text(grid)
    _medium(ctx, prim, material, node)
    if len(ctx.keys(place)) > 1:
        ctx.report.approximated(prim, "a volume that moves", "it stands as it is when the shutter opens")
    still = Place(None, fixed=place.at(ctx.times.first))
    # Files of volumes are in metres, whatever the scene counts in.
    size = ctx.metres_per_scene_unit
    return [node] if write_transform(ctx, node, still, prim, np.diag([size, size, size, 1.0])) else []
