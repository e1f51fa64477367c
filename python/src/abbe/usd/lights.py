"""UsdLux. Intensity is luminance in nits, times 2^exposure; `normalize` divides by the area or the solid angle.

Colours are linear Rec. 709. Lights are black: what they reflect is not part of UsdLux.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdLux, UsdShade

from .assets import resolve_asset
from .context import Context, Matrix, Place, as_float, write_transform
from .ies import cone_profile, scaled_profile
from .report import Fate
from .scene_text import FileRef, Node

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of linear Rec. 709
LEAST_ANGLE = 0.001  # degrees; below it a distant light has one direction
TURN = np.diag([-1.0, 1.0, -1.0, 1.0])  # half a turn about y: our quads face +z, those of UsdLux -z
IMAGES = (".exr", ".hdr", ".pic")  # of an environment


@dataclasses.dataclass
class Emission:
    """What a light gives off before `normalize`: nits, and the shape of its spectrum as words."""

    nits: float
    colour: tuple[str, ...]


def _input(ctx: Context, prim: Usd.Prim, name: str, otherwise: float) -> float:
    """A number of a light, from a connection too. Errors are reported, and `otherwise` is taken."""
    attribute = prim.GetAttribute(f"inputs:{name}")
    if not attribute:
        attribute = prim.GetAttribute(name)
    value = attribute.Get(ctx.times.first) if attribute else None
    if attribute and UsdShade.Input.IsInput(attribute) and UsdShade.Input(attribute).HasConnectedSource():
        sources = UsdShade.Utils.GetValueProducingAttributes(UsdShade.Input(attribute))
        value = sources[0].Get(ctx.times.first) if sources else value
        if value is None:
            ctx.report.left_out(prim, f"what is connected to inputs:{name}", "lights take numbers, no networks")
    if value is None:
        return otherwise
    if not math.isfinite(value):
        ctx.report.error("E0802", prim, f"inputs:{name} is {value}", "a finite number is wanted")
        return otherwise
    if attribute.ValueMightBeTimeVarying() and ctx.times.animated:
        ctx.report.approximated(prim, f"inputs:{name} that changes", "it is that of the first frame")
    return as_float(value)


def emission_of(ctx: Context, prim: Usd.Prim) -> Emission | None:
    """Nits and colour. None for a light that is off, with a remark."""
    nits = _input(ctx, prim, "intensity", 50000.0 if prim.IsA(UsdLux.DistantLight) else 1.0)
    exposure = _input(ctx, prim, "exposure", 0.0)
    if abs(exposure) > 200:
        ctx.report.error("E0802", prim, f"inputs:exposure is {exposure}", "between -200 and 200 stops are meant")
        return None
    nits *= 2.0**exposure
    colour = prim.GetAttribute("inputs:color").Get(ctx.times.first)
    rgb = tuple(as_float(x) for x in colour) if colour is not None else (1.0, 1.0, 1.0)
    if not all(math.isfinite(x) for x in rgb):
        ctx.report.error("E0802", prim, f"inputs:color is {rgb}", "finite numbers are wanted")
        return None
    if min(rgb) < 0:
        ctx.report.approximated(prim, f"the colour {rgb}", "light is not below 0: it is 0 there")
        rgb = tuple(max(0.0, x) for x in rgb)
    words: tuple[str, ...] = ()
    if prim.GetAttribute("inputs:enableColorTemperature").Get(ctx.times.first):
        kelvin = _input(ctx, prim, "colorTemperature", 6500.0)
        if len(set(rgb)) == 1 and 100 <= kelvin <= 1e6:
            # UsdLux scales black bodies to a luminance of 1.
            return _checked(ctx, prim, nits * rgb[0], ("blackbody", repr(kelvin).removesuffix(".0"), "K"))
        warm = UsdLux.BlackbodyTemperatureAsRgb(kelvin)
        rgb = tuple(as_float(a * b) for a, b in zip(rgb, warm, strict=True))
        ctx.report.approximated(prim, "a colour besides a temperature", "both as one colour of three numbers")
    if len(set(rgb)) > 1:
        words = ("rgb", *(repr(as_float(x)).removesuffix(".0") for x in rgb))
    return _checked(ctx, prim, nits * sum(a * b for a, b in zip(rgb, LUMINANCE, strict=True)), words)


def _checked(ctx: Context, prim: Usd.Prim, nits: float, colour: tuple[str, ...]) -> Emission | None:
    if nits < 0:
        ctx.report.left_out(prim, "a light of negative intensity", "light is not below 0")
        return None
    if nits == 0:
        ctx.report.left_out(prim, "a light that is off", "its intensity or colour is 0")
        return None
    return Emission(nits, colour)


def _amount(node: Node, prop: str, value: float, unit: str, colour: tuple[str, ...]) -> None:
    node.set(prop, float(f"{value:.12g}"), unit)
    if colour:
        node.child("color", *colour)


def _normalized(ctx: Context, prim: Usd.Prim) -> bool:
    return bool(prim.GetAttribute("inputs:normalize").Get(ctx.times.first))


def _stretch(ctx: Context, place: Place) -> tuple[np.ndarray[Any, Any], ...]:
    """Images of the axes in units of the stage."""
    m = place.at(ctx.times.first) / ctx.scale
    return m[0, :3], m[1, :3], m[2, :3]


def _ellipsoid_area(a: float, b: float, c: float) -> float:
    """Of a sphere exactly, else by Thomsen's formula, within 1 %."""
    if a == b == c:
        return 4 * math.pi * a * a
    p = 1.6075
    return float(4 * math.pi * (((a * b) ** p + (a * c) ** p + (b * c) ** p) / 3) ** (1 / p))


@dataclasses.dataclass
class Shaping:
    angle: float  # degrees, from the axis
    softness: float
    focus: float
    profile: FileRef | None
    profile_normalized: bool

    @property
    def is_none(self) -> bool:
        return self.angle >= 180 and self.focus == 0 and self.profile is None


def shaping_of(ctx: Context, prim: Usd.Prim) -> Shaping:
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return Shaping(180, 0, 0, None, False)
    angle = _input(ctx, prim, "shaping:cone:angle", 90.0)
    softness = min(1.0, max(0.0, _input(ctx, prim, "shaping:cone:softness", 0.0)))
    focus = max(0.0, _input(ctx, prim, "shaping:focus", 0.0))
    tint = prim.GetAttribute("inputs:shaping:focusTint").Get(ctx.times.first)
    if tint is not None and any(tint) and focus > 0:
        ctx.report.left_out(prim, "shaping:focusTint", "the light has one colour in all directions")
    attribute = prim.GetAttribute("inputs:shaping:ies:file")
    asset = attribute.Get(ctx.times.first)
    profile = None
    if isinstance(asset, Sdf.AssetPath) and asset.path:
        profile = resolve_asset(ctx, prim, asset, attribute)
        if _input(ctx, prim, "shaping:ies:angleScale", 0.0) != 0:
            ctx.report.left_out(prim, "shaping:ies:angleScale", "the angles are those of the profile")
    normalized = bool(prim.GetAttribute("inputs:shaping:ies:normalize").Get(ctx.times.first))
    return Shaping(angle, softness, focus, profile, normalized)


# Lights of no extent, for what has a shaping. Their intensity is that which the area shows from far away.


def _shaped(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission, shaping: Shaping, metres2: float, flat: bool) -> list[Node]:
    """`metres2`: the area that is seen along the axis. `flat` ones are seen by the cosine of the angle with it."""
    candela = e.nits * metres2
    why = "a point: its shadows are sharp, and it is not seen"
    if shaping.profile is not None:
        ref = scaled_profile(ctx, prim, shaping.profile, candela, shaping.profile_normalized)
        if ref is None:
            return []
        node.word("ies").file(ref).set("toward", 0, 0, -1)
        if shaping.angle < 90 or shaping.focus > 0:
            ctx.report.left_out(prim, "the cone and focus of a light with a profile", "the profile alone says where its light goes")
    elif shaping.focus == 0 and not flat:
        node.word("spot").set("toward", 0, 0, -1).set("angle", min(360.0, max(0.01, 2 * shaping.angle)), "deg")
        node.set("inner-angle", max(0.0, 2 * shaping.angle * (1 - shaping.softness)), "deg")
        node.set("intensity", float(f"{candela:.12g}"), "cd")
    else:
        ref = cone_profile(ctx, prim, candela, shaping.angle, shaping.softness, shaping.focus, flat)
        node.word("ies").file(ref).set("toward", 0, 0, -1)
    if e.colour:
        node.child("color", *e.colour)
    node.remark(ctx.report.approximated(prim, "the shaping of a light with an area", why))
    return [node] if write_transform(ctx, node, place, prim) else []


def _instead_of_flat(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission, area: float) -> list[Node] | None:
    """What stands for a flat light of that area (units of the stage) where it has no extent or a shaping; else None, and its emission is ready."""
    if not _extent(ctx, prim, area):
        return []
    if _normalized(ctx, prim):
        e.nits /= area
    shaping = shaping_of(ctx, prim)
    if shaping.angle < 90 or shaping.focus > 0 or shaping.profile is not None:
        return _shaped(ctx, prim, place, node, e, shaping, area * ctx.metres**2, True)
    return None


def _rect(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    w, h = _input(ctx, prim, "width", 1.0), _input(ctx, prim, "height", 1.0)
    x, y, _ = _stretch(ctx, place)
    area = w * h * float(np.linalg.norm(np.cross(x, y)))
    other = _instead_of_flat(ctx, prim, place, node, e, area)
    if other is not None:
        return other
    node.word("quad").set("size", w, h)
    _amount(node, "luminance", e.nits, "nits", e.colour)
    _picture(ctx, prim, node)
    return [node] if write_transform(ctx, node, place, prim, TURN) else []


def _extent(ctx: Context, prim: Usd.Prim, area: float) -> bool:
    if not (math.isfinite(area) and area > 0):
        ctx.report.left_out(prim, "a light without extent", "its width, height, length, radius or scale is 0 or below")
        return False
    return True


def _picture(ctx: Context, prim: Usd.Prim, node: Node) -> None:
    """The picture in front of a rectangle, seen upright and unmirrored from where it shines."""
    attribute = prim.GetAttribute("inputs:texture:file")
    asset = attribute.Get(ctx.times.first) if attribute else None
    if isinstance(asset, Sdf.AssetPath) and asset.path:
        ref = resolve_asset(ctx, prim, asset, attribute)
        if ref:
            node.child("texture", "image").file(ref)


def _disk(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    r = _input(ctx, prim, "radius", 0.5)
    x, y, _ = _stretch(ctx, place)
    area = math.pi * r * abs(r) * float(np.linalg.norm(np.cross(x, y)))
    other = _instead_of_flat(ctx, prim, place, node, e, area)
    if other is not None:
        return other
    node.word("disk").set("radius", r).set("normal", 0, 0, -1)
    _amount(node, "luminance", e.nits, "nits", e.colour)
    return [node] if write_transform(ctx, node, place, prim) else []


def _sphere(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    r = _input(ctx, prim, "radius", 0.5)
    point = bool(prim.GetAttribute("treatAsPoint").Get(ctx.times.first))
    lengths = [float(np.linalg.norm(axis)) for axis in _stretch(ctx, place)]
    if r == 0 and point:
        r = 1e-6  # of a point nothing but its intensity is left
    a, b, c = (abs(r) * s for s in lengths)
    area = _ellipsoid_area(a, b, c)
    if not _extent(ctx, prim, area if r > 0 else 0.0):
        return []
    seen = area / 4 * ctx.metres**2  # the mean over all directions [Cauchy]
    if _normalized(ctx, prim):
        e.nits /= area
    shaping = shaping_of(ctx, prim)
    if not shaping.is_none:
        return _shaped(ctx, prim, place, node, e, shaping, seen, False)
    if point:
        node.word("point")
        _amount(node, "intensity", e.nits * seen, "cd", e.colour)
    else:
        node.word("sphere").set("radius", r)
        _amount(node, "luminance", e.nits, "nits", e.colour)
    return [node] if write_transform(ctx, node, place, prim) else []


def _cylinder(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    """A tube along x without caps: a black shape that emits, since there is no such light."""
    r, length = _input(ctx, prim, "radius", 0.5), _input(ctx, prim, "length", 1.0)
    x, y, z = _stretch(ctx, place)
    a, b = r * float(np.linalg.norm(y)), r * float(np.linalg.norm(z))
    around = math.pi * (3 * (a + b) - math.sqrt(max(0.0, (3 * a + b) * (a + 3 * b))))  # [Ramanujan]
    area = around * length * float(np.linalg.norm(x))
    if not _extent(ctx, prim, area if r > 0 else 0.0):
        return []
    if _normalized(ctx, prim):
        e.nits /= area
    if bool(prim.GetAttribute("treatAsLine").Get(ctx.times.first)):
        ctx.report.approximated(prim, "treatAsLine", "a cylinder of its radius")
    if not shaping_of(ctx, prim).is_none and prim.HasAPI(UsdLux.ShapingAPI):
        ctx.report.left_out(prim, "the shaping of a cylinder", "it emits evenly from all around")
    shape = Node("shape").take_values(node).word("cylinder").set("axis", 1, 0, 0).set("radius", r).set("height", length)
    shape.set("caps", "off")
    material = shape.child("material", "openpbr").set("base-weight", 0).set("specular-weight", 0)
    material.set("emission-luminance", float(f"{e.nits:.12g}"), "nits")
    if e.colour:
        emission_colour(material, e)
    return [shape] if write_transform(ctx, shape, place, prim) else []


def emission_colour(material: Node, e: Emission) -> None:
    """`emission-color rgb` is a factor where `color rgb` is a shape: its luminance is brought to 1."""
    if e.colour[0] == "rgb":
        rgb = [float(x) for x in e.colour[1:]]
        total = sum(a * b for a, b in zip(rgb, LUMINANCE, strict=True))
        material.set("emission-color", "rgb", *(float(f"{x / total:.12g}") for x in rgb))
    else:
        material.child("emission-color", *e.colour)


def _distant(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    angle = _input(ctx, prim, "angle", 0.53)
    if not 0 <= angle <= 180:
        ctx.report.approximated(prim, f"an angle of {angle} degrees", "between 0 and 180")
        angle = min(180.0, max(0.0, angle))
    node.word("sun").set("toward", 0, 0, -1)
    if angle < LEAST_ANGLE:
        node.set("angular-diameter", 0, "deg")
        _amount(node, "irradiance", e.nits, "lx", e.colour)
    else:
        node.set("angular-diameter", angle, "deg")
        # Normalized, the illuminance is the intensity: the radiance times π sin²(angle / 2).
        _amount(node, *(("irradiance", e.nits, "lx") if _normalized(ctx, prim) else ("luminance", e.nits, "nits")), e.colour)
    return [node] if _write_turn(ctx, node, place, prim, np.eye(4)) else []


def _write_turn(ctx: Context, node: Node, place: Place, prim: Usd.Prim, before: Matrix) -> bool:
    """Of what is far away only the rotation matters."""
    m = place.at(ctx.times.first)[:3, :3]
    if not np.isfinite(m).all() or abs(np.linalg.det(m)) < 1e-30:
        ctx.report.error("E0802", prim, "its transform does not turn", "look at its xformOps")
        return False
    u, _, v = np.linalg.svd(m)
    turn = u @ v
    if np.linalg.det(turn) < 0:
        ctx.report.approximated(prim, "a mirrored light", "it is turned half around instead")
        turn = -turn
    whole = np.eye(4)
    whole[:3, :3] = np.where(np.abs(turn) < 1e-12, 0.0, np.where(np.abs(np.abs(turn) - 1) < 1e-12, np.sign(turn), turn))
    fixed = Place(None, fixed=whole)
    if len(ctx.keys(place)) > 1 and any((place.at(t) != place.at(ctx.times.first)).any() for t in ctx.keys(place)):
        ctx.report.approximated(prim, "a light far away that turns", "it stands as it is when the shutter opens")
    return write_transform(ctx, node, fixed, prim, before)


def _dome(ctx: Context, prim: Usd.Prim, place: Place, node: Node, e: Emission) -> list[Node]:
    attribute = prim.GetAttribute("inputs:texture:file")
    asset = attribute.Get(ctx.times.first)
    if _normalized(ctx, prim):
        e.nits /= 4 * math.pi
    if not (isinstance(asset, Sdf.AssetPath) and asset.path):
        node.word("sky")
        _amount(node, "luminance", e.nits, "nits", e.colour)
        return [node]
    form = str(prim.GetAttribute("inputs:texture:format").Get() or "automatic")
    if form not in ("automatic", "latlong"):
        ctx.report.left_out(prim, f"a dome in the format {form}", "latlong is read")
        return []
    ref = resolve_asset(ctx, prim, asset, attribute)
    if ref is None:
        return []
    if not ref.path.lower().endswith(IMAGES):
        ctx.report.left_out(prim, f"the dome `{asset.path}`", "environments are EXR or Radiance HDR: convert it (`oiiotool in -o out.exr`)")
        return []
    if e.colour:
        ctx.report.approximated(prim, "the colour of a dome with a picture", "its luminance alone counts")
    node.word("environment").file(ref)
    node.set("luminance", float(f"{e.nits:.12g}"), "nits")
    pole = str(prim.GetAttribute("poleAxis").Get() or "scene") if prim.IsA(UsdLux.DomeLight_1) else "Y"
    return [node] if _write_turn(ctx, node, place, prim, dome_turn(ctx.up, pole)) else []


def dome_turn(up: str, pole: str) -> Matrix:
    """From our latitude-longitude image to that of UsdLux, of row vectors.

    Ours has its middle towards -z (+y where z is up), its right half towards +x. UsdLux follows OpenEXR: the middle
    towards +z, the right half towards -x, the top towards +y. A pole along z turns that by 90° about x: y becomes z.
    """
    from_ours = np.diag([-1.0, 1.0, -1.0, 1.0])  # x → -x, y → y, z → -z
    if up == "z":
        from_ours = np.eye(4)
        from_ours[:3, :3] = [[-1, 0, 0], [0, 0, 1], [0, 1, 0]]  # x → -x, y → z, z → y
    if pole == "Z" or (pole == "scene" and up == "z"):
        to_z = np.eye(4)
        to_z[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # y → z, z → -y
        return np.asarray(from_ours @ to_z)
    return from_ours


LIGHTS: dict[str, Callable[[Context, Usd.Prim, Place, Node, Emission], list[Node]]] = {
    "RectLight": _rect,
    "DiskLight": _disk,
    "SphereLight": _sphere,
    "CylinderLight": _cylinder,
    "DistantLight": _distant,
    "DomeLight": _dome,
    "DomeLight_1": _dome,
}


def _remarks(ctx: Context, prim: Usd.Prim) -> None:
    """What no light has here."""
    api = UsdLux.LightAPI(prim)
    filters = api.GetFiltersRel().GetTargets() if api.GetFiltersRel() else []
    for target in filters:
        named = prim.GetStage().GetPrimAtPath(target)
        kind = (named.GetTypeName() or "of no type") if named.IsValid() else "not there"
        ctx.report.left_out(prim, f"the light filter {target} ({kind})", "lights have no filters")
    for name in ("lightLink", "shadowLink"):
        collection = Usd.CollectionAPI(prim, name)
        if not collection:
            continue
        root = collection.GetIncludeRootAttr().Get()
        if collection.GetExcludesRel().GetTargets() or collection.GetIncludesRel().GetTargets() or root is False:
            ctx.report.left_out(prim, name, "lights light all that there is")
    for name, what in (("diffuse", "matte surfaces"), ("specular", "gloss")):
        if prim.GetAttribute(f"inputs:{name}") and _input(ctx, prim, name, 1.0) != 1:
            ctx.report.left_out(prim, f"inputs:{name}", f"light on {what} is as it is on others")
    shadow = UsdLux.ShadowAPI(prim) if prim.HasAPI(UsdLux.ShadowAPI) else None
    if shadow and shadow.GetShadowEnableAttr().Get(ctx.times.first) is False:
        ctx.report.left_out(prim, "shadow:enable off", "all light casts shadows")


def convert_light(ctx: Context, prim: Usd.Prim, place: Place) -> list[Node]:
    """The light of a prim; none, with a remark, where it cannot be."""
    kind = str(prim.GetTypeName())
    convert = LIGHTS.get(kind)
    ctx.had_lights = True
    if convert is None:
        ctx.report.left_out(prim, f"a light of type {kind}", f"{', '.join(LIGHTS)} are read")
        ctx.report.count(prim, Fate.LEFT_OUT)
        return []
    _remarks(ctx, prim)
    emission = emission_of(ctx, prim)
    node = Node("light").named(ctx.name("light", str(prim.GetPath())))
    nodes = convert(ctx, prim, place, node, emission) if emission else []
    if not nodes:
        ctx.report.count(prim, Fate.LEFT_OUT)
    ctx.lit = ctx.lit or bool(nodes)
    return nodes


def glow_of_mesh(ctx: Context, prim: Usd.Prim, light: Usd.Prim, place: Place) -> Emission | None:
    """What a mesh gives off that is a light, by itself or by a GeometryLight."""
    ctx.had_lights = True
    _remarks(ctx, light)
    e = emission_of(ctx, light)
    if e is None:
        return None
    ctx.lit = True
    if _normalized(ctx, light):
        area = mesh_area(ctx, UsdGeom.Mesh(prim), place)
        if not _extent(ctx, light, area):
            return None
        e.nits /= area
    if light.HasAPI(UsdLux.ShapingAPI) and not shaping_of(ctx, light).is_none:
        ctx.report.left_out(light, "the shaping of a mesh", "it emits evenly")
    mode = str(light.GetAttribute("light:materialSyncMode").Get() or "materialGlowTintsLight")
    if mode != "noMaterialResponse":
        ctx.report.approximated(light, f"materialSyncMode {mode}", "a mesh that is a light is black and emits by itself alone")
    return e


def mesh_area(ctx: Context, mesh: UsdGeom.Mesh, place: Place) -> float:
    """Of all faces in the world, in units of the stage: half of the sum of crossed edges of each fan."""
    points = np.asarray(mesh.GetPointsAttr().Get(ctx.times.first) or [], np.float64).reshape(-1, 3)
    world = points @ (place.at(ctx.times.first)[:3, :3] / ctx.scale)
    corners = np.asarray(mesh.GetFaceVertexIndicesAttr().Get(ctx.times.first) or [], np.int64)
    area, at = 0.0, 0
    for n in mesh.GetFaceVertexCountsAttr().Get(ctx.times.first) or []:
        face = world[corners[at : at + n]] if at + n <= len(corners) and (corners[at : at + n] < len(world)).all() else world[:0]
        if len(face) >= 3:
            area += float(np.linalg.norm(np.cross(face[1:-1] - face[0], face[2:] - face[0]).sum(axis=0))) / 2
        at += n
    return area
