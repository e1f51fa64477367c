"""Cameras, the film and render settings."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdRender

from .context import NIT_PER_ONE, Context, Matrix, Place, as_float, is_finite
from .report import Fate
from .scene_text import Node, number

DEFAULT_HEIGHT = 720  # pixels, of a film that nothing says
MAX_PIXELS = 65536  # of a side
TENTH = 0.1  # focal length and aperture are in tenths of a unit of the stage


@dataclasses.dataclass
class Settings:
    """What a UsdRenderSettings prim says, or what is taken without one."""

    prim: Usd.Prim | None = None
    resolution: tuple[int, int] | None = None
    pixel_aspect: float = 1.0
    conform: str = "expandAperture"
    camera: str = ""
    motion_blur: bool = True
    depth_of_field: bool = True
    window: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0)
    product: str = ""


def read_settings(ctx: Context) -> Settings:
    """The stage's own render settings, else the first ones."""
    api = UsdRender.Settings.GetStageRenderSettings(ctx.stage)
    prim = api.GetPrim() if api else None
    if prim is None or not prim.IsValid():
        prim = next(iter(ctx.census.all(UsdRender.Settings)), None)
    s = Settings(prim)
    if prim is None:
        return s
    ctx.report.count(prim, Fate.CARRIED)
    _read_base(ctx, prim, s)
    settings = UsdRender.Settings(prim)
    purposes = settings.GetIncludedPurposesAttr().Get()
    if purposes is not None and ctx.options.purposes is None:
        ctx.purposes = tuple(str(p) for p in purposes)
    binding = settings.GetMaterialBindingPurposesAttr().Get()
    if binding is not None:
        ctx.binding_purposes = tuple(str(p) for p in binding)
    space = settings.GetRenderingColorSpaceAttr().Get()
    if space and "709" not in str(space) and str(space) not in ("lin_srgb",):
        ctx.report.approximated(prim, f"renderingColorSpace {space}", "colours are linear Rec. 709, and light is rendered as spectra")
    products = settings.GetProductsRel().GetForwardedTargets()
    for i, target in enumerate(products):
        product = ctx.stage.GetPrimAtPath(target)
        if not product.IsValid():
            ctx.report.error("E0802", prim, f"the product {target} is not there", "look at `products`")
        elif i:
            ctx.report.left_out(product, "a further product", "a render has one picture: the first one's")
        else:
            _read_product(ctx, product, s)
    return s


def _read_base(ctx: Context, prim: Usd.Prim, s: Settings) -> None:
    """What settings and products share; products override what they state themselves."""

    def stated(name: str) -> Any:
        attribute = prim.GetAttribute(name)
        return attribute.Get() if attribute and (s.prim is prim or attribute.HasAuthoredValue()) else None

    resolution = stated("resolution")
    if resolution is not None:
        if min(resolution) < 1 or max(resolution) > MAX_PIXELS:
            ctx.report.error("E0802", prim, f"resolution is {tuple(resolution)}", f"between 1 and {MAX_PIXELS} pixels")
        else:
            s.resolution = (int(resolution[0]), int(resolution[1]))
    aspect = stated("pixelAspectRatio")
    if aspect is not None:
        if not (0.01 <= aspect <= 100):
            ctx.report.error("E0802", prim, f"pixelAspectRatio is {aspect}", "between 0.01 and 100")
        else:
            s.pixel_aspect = as_float(aspect)
    conform, window = stated("aspectRatioConformPolicy"), stated("dataWindowNDC")
    s.conform = s.conform if conform is None else str(conform)
    if window is not None:
        s.window = tuple(as_float(x) for x in window)  # type: ignore[assignment]
    if stated("disableMotionBlur") or stated("instantaneousShutter"):
        s.motion_blur = False
    if stated("disableDepthOfField"):
        s.depth_of_field = False
    targets = prim.GetRelationship("camera").GetForwardedTargets() if prim.GetRelationship("camera") else []
    if targets:
        s.camera = str(targets[0])


def _read_product(ctx: Context, product: Usd.Prim, s: Settings) -> None:
    ctx.report.count(product, Fate.CARRIED)
    _read_base(ctx, product, s)
    name = product.GetAttribute("productName").Get(ctx.times.first)
    s.product = str(name or "")
    variables = product.GetRelationship("orderedVars").GetForwardedTargets() if product.GetRelationship("orderedVars") else []
    for target in variables:
        variable = ctx.stage.GetPrimAtPath(target)
        source = str(variable.GetAttribute("sourceName").Get() or "") if variable.IsValid() else ""
        if source not in ("Ci", "color", "rgba", "rgb", ""):
            ctx.report.left_out(variable, f"the render variable {source}", "state `layers` of the film")
        elif variable.IsValid():
            ctx.report.count(variable, Fate.USED)


def choose_camera(ctx: Context, s: Settings) -> Usd.Prim | None:
    """The camera that is rendered: that of the options, of the settings, else the first one."""
    wanted = ctx.options.camera or s.camera
    cameras = ctx.census.all(UsdGeom.Camera)
    if not wanted:
        return cameras[0] if cameras else None
    path = "/" + wanted.strip("/")  # cameras of the scene are called by it without the slash
    named = ctx.stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    found = [named] if named is not None and named.IsValid() and named.IsA(UsdGeom.Camera) else []
    found = found or [p for p in cameras if p.GetName() == wanted.strip("/")]
    if found:
        return found[0]
    names = ", ".join(str(p.GetPath()) for p in cameras[:10]) or "none"
    ctx.report.error("E0802", s.prim if not ctx.options.camera else None, f"there is no camera `{wanted}`", f"the stage has {names}")
    return None


def set_times(ctx: Context, camera: Usd.Prim | None, s: Settings) -> None:
    """The moments that the camera's shutter is open, for a frame or a range of them."""
    stage, t = ctx.stage, ctx.times
    t.per_second = float(stage.GetTimeCodesPerSecond()) or 24.0
    if not (math.isfinite(t.per_second) and t.per_second > 0):
        ctx.report.error("E0802", None, f"timeCodesPerSecond is {t.per_second}", "a number above 0 is wanted")
        t.per_second = 24.0
    start = stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else 0.0
    first = ctx.options.frame if ctx.options.frame is not None else start
    last = first
    if ctx.options.frames is not None:
        first, last = ctx.options.frames
        t.animated = True
    if camera is not None and s.motion_blur:
        lens = UsdGeom.Camera(camera)
        opens, closes = (float(a.Get(first) or 0.0) for a in (lens.GetShutterOpenAttr(), lens.GetShutterCloseAttr()))
        if not (math.isfinite(opens) and math.isfinite(closes)) or closes < opens:
            ctx.report.error("E0802", camera, f"the shutter opens at {opens} and closes at {closes}", "it closes after it opens")
        else:
            t.open, t.close = as_float(opens), as_float(closes)
    t.first, t.last = first + t.open, last + t.close


def _film(ctx: Context, s: Settings, aspect: float) -> tuple[Node, float]:
    """The film, and the proportions of what it shows."""
    width, height = s.resolution or (0, DEFAULT_HEIGHT)
    if not s.resolution:
        width = min(MAX_PIXELS, max(1, round(height * aspect)))
    if s.pixel_aspect != 1:
        square = min(MAX_PIXELS, max(1, round(width * s.pixel_aspect)))
        ctx.report.approximated(s.prim, f"pixelAspectRatio {s.pixel_aspect:g}", f"pixels are square: {square} instead of {width} show the same")
        width = square
    node = Node("film").set("size", width, height)
    x0, y0, x1, y1 = s.window
    if s.window != (0.0, 0.0, 1.0, 1.0):
        left, right, top, bottom = round(x0 * width), round(x1 * width), round((1 - y1) * height), round((1 - y0) * height)
        if right > left and bottom > top:
            node.set("crop", left, top, right, bottom)
        else:
            ctx.report.error("E0802", s.prim, f"dataWindowNDC is {s.window}", "xmin, ymin, xmax, ymax in this order")
    if s.product.endswith(".exr"):
        node.child("output").text(s.product)
    elif s.product:
        ctx.report.left_out(s.prim, f"the product name {s.product}", "pictures are OpenEXR: -o of `abbe render` names them")
    return node, width / height


def _conformed(h: float, v: float, aspect: float, policy: str) -> tuple[float, float]:
    """Apertures that have the proportions of the film [UsdRenderSettingsBase]."""
    own = h / v
    widen = {"expandAperture": aspect > own, "cropAperture": aspect <= own, "adjustApertureWidth": True}.get(policy, False)
    if policy == "adjustPixelAspectRatio":
        return h, h / aspect
    return (v * aspect, v) if widen else (h, h / aspect)


def write_cameras(ctx: Context, s: Settings, chosen: Usd.Prim | None, places: dict[str, Place]) -> list[Node]:
    """All cameras, the one that is rendered first, and the film; nothing where there is no camera."""
    cameras = ctx.census.all(UsdGeom.Camera)
    if chosen is not None:
        cameras = [chosen, *(p for p in cameras if p.GetPath() != chosen.GetPath())]
    if not cameras:
        if s.prim is not None and s.resolution:
            return [_film(ctx, s, 1.0)[0]]
        return []
    apertures = _apertures(ctx, cameras[0])
    if apertures is None:
        return []
    film, aspect = _film(ctx, s, apertures[0] / apertures[1])
    if s.conform == "adjustPixelAspectRatio" and abs(aspect - apertures[0] / apertures[1]) > 1e-4:
        ctx.report.approximated(s.prim, "adjustPixelAspectRatio", "pixels are square: the height of the aperture follows")
    nodes = []
    for prim in cameras:
        place = places.get(str(prim.GetPath())) or _place_of(ctx, prim)
        node = _camera(ctx, s, prim, place, aspect)
        ctx.report.count(prim, Fate.CARRIED if node else Fate.LEFT_OUT)
        if node:
            nodes.append(node)
    return [*nodes, film]


def _place_of(ctx: Context, prim: Usd.Prim) -> Place:
    place = ctx.root()
    for path in prim.GetPath().GetPrefixes():
        ancestor = ctx.stage.GetPrimAtPath(path)
        if ancestor.IsA(UsdGeom.Xformable):
            place = Place(place, ancestor)
    return place


def _apertures(ctx: Context, prim: Usd.Prim) -> tuple[float, float] | None:
    lens = UsdGeom.Camera(prim)
    h, v = (as_float(a.Get(ctx.times.first)) for a in (lens.GetHorizontalApertureAttr(), lens.GetVerticalApertureAttr()))
    if not (0 < h < 1e12 and 0 < v < 1e12):
        ctx.report.error("E0802", prim, f"the apertures are {h} and {v}", "lengths above 0")
        return None
    return h, v


def _camera(ctx: Context, s: Settings, prim: Usd.Prim, place: Place, aspect: float) -> Node | None:
    apertures = _apertures(ctx, prim)
    if apertures is None:
        return None
    lens, t = UsdGeom.Camera(prim), ctx.times.first
    h, v = _conformed(*apertures, aspect, s.conform)
    offsets = [as_float(a.Get(t)) for a in (lens.GetHorizontalApertureOffsetAttr(), lens.GetVerticalApertureOffsetAttr())]
    tenth = TENTH * ctx.metres  # metres
    node = Node("camera").named(ctx.name("camera", str(prim.GetPath())))
    orthographic = lens.GetProjectionAttr().Get() == UsdGeom.Tokens.orthographic
    aside = np.eye(4)
    if orthographic:
        node.word("orthographic").set("width", as_float(h * tenth), "m")
        # Without a lens to shift the camera steps aside.
        aside[3, :2] = [x * TENTH * ctx.scale for x in offsets]
    else:
        focal = as_float(lens.GetFocalLengthAttr().Get(t))
        if not 0 < focal < 1e12:
            ctx.report.error("E0802", prim, f"focalLength is {focal}", "a length above 0")
            return None
        _lens(ctx, s, prim, node, focal * tenth, h * tenth, v * tenth, [x * tenth for x in offsets])
    if not _place_camera(ctx, prim, node, place, aside):
        return None
    times = ctx.times
    if times.animated:
        if times.open:
            node.set("time", times.seconds(times.open), "s")
    elif times.first:
        node.set("time", times.seconds(times.first), "s")
    if times.close > times.open:
        node.set("shutter", times.seconds(times.close - times.open), "s")
    node.set("exposure", *_exposure(ctx, prim))
    _camera_remarks(ctx, prim)
    return node


def _lens(ctx: Context, s: Settings, prim: Usd.Prim, node: Node, focal: float, width: float, height: float, offsets: list[float]) -> None:
    """Perspective, all in metres. Only ratios show unless there is depth of field."""
    lens, t = UsdGeom.Camera(prim), ctx.times.first
    # The language takes lenses of 0.1 mm to 100 m: without depth of field the sensor may have any size.
    stop = as_float(lens.GetFStopAttr().Get(t))
    focus = as_float(lens.GetFocusDistanceAttr().Get(t)) * ctx.metres
    deep = s.depth_of_field and stop > 0 and focus > 0
    if not 1e-4 <= focal <= 100 or max(width, height) > 100:
        factor = 0.05 / focal
        width, height, offsets = width * factor, height * factor, [x * factor for x in offsets]
        stop, focal = stop * factor, 0.05
    millimetres = [float(f"{x * 1000:.9g}") for x in (focal, width, height, *offsets)]
    node.set("lens", millimetres[0], "mm").set("sensor", *millimetres[1:3], "mm")
    if any(offsets):
        node.set("shift", *millimetres[3:], "mm")
    if deep:
        if stop < 0.1:
            node.set("aperture", focal / stop, "m")
        else:
            node.set("f-stop", float(f"{stop:.9g}"))
        if focal / stop > 0.5:
            ctx.report.approximated(
                prim,
                f"a lens {focal / stop:.2g} m across",
                f"USD counts focal lengths in tenths of a unit, of {ctx.metres:g} m here: is metersPerUnit right?",
            )
    if focus > 0 and s.depth_of_field:
        node.set("focus", float(f"{focus:.9g}"), "m")


def _exposure(ctx: Context, prim: Usd.Prim) -> tuple[float | str, ...]:
    """Stops with which a nit shows as 1 times the camera's own exposure, as other renderers of UsdLux have it."""
    stops = math.log2(NIT_PER_ONE) if ctx.lit or ctx.emits else 0.0
    lens = UsdGeom.Camera(prim)
    scale = float(lens.ComputeLinearExposureScale(ctx.times.first)) if hasattr(lens, "ComputeLinearExposureScale") else 1.0
    if not (math.isfinite(scale) and scale > 0):
        ctx.report.error("E0802", prim, f"the exposure is {scale}", "look at exposure, exposure:time, exposure:fStop and exposure:iso")
        scale = 1.0
    return float(f"{stops + math.log2(scale):.8g}") + 0.0, "stops"


def _rigid(m: Matrix) -> Matrix | None:
    """Place and directions without scale; mirrored ones are turned so that right stays right."""
    if not is_finite(m) or abs(np.linalg.det(m[:3, :3])) < 1e-30:
        return None
    back, up = m[2, :3], m[1, :3]
    back = back / np.linalg.norm(back)
    up = up - back * (up @ back)
    up = up / np.linalg.norm(up)
    out = np.eye(4)
    out[0, :3], out[1, :3], out[2, :3], out[3, :3] = np.cross(up, back), up, back, m[3, :3]
    return np.where(np.abs(out) < 1e-15, 0.0, out)


def _place_camera(ctx: Context, prim: Usd.Prim, node: Node, place: Place, aside: Matrix) -> bool:
    keys = []
    for time in ctx.keys(place):
        m = place.at(time)
        rigid = _rigid(m)
        if rigid is None:
            ctx.report.error("E0802", prim, "a camera without extent, or at no finite place", "look at its xformOps")
            return False
        if np.linalg.det(m[:3, :3]) < 0:
            ctx.report.approximated(prim, "a mirrored camera", "its picture is not mirrored")
        keys.append((time, aside @ rigid))
    if all((m == keys[0][1]).all() for _, m in keys):
        keys = keys[:1]
    for time, m in keys:
        at = node if len(keys) == 1 else node.child("at", number(ctx.times.seconds(time)), "s")
        at.set("from", *m[3, :3]).set("look-at", *(m[3, :3] - m[2, :3])).set("up", *m[1, :3])
    if len(keys) > 1:
        m = keys[0][1]
        node.set("from", *m[3, :3]).set("look-at", *(m[3, :3] - m[2, :3])).set("up", *m[1, :3])
    return True


def _camera_remarks(ctx: Context, prim: Usd.Prim) -> None:
    lens = UsdGeom.Camera(prim)
    if len(lens.GetClippingPlanesAttr().Get(ctx.times.first) or []):
        ctx.report.left_out(prim, "clippingPlanes", "cameras here cut nothing")
    for attribute in (lens.GetFocalLengthAttr(), lens.GetFocusDistanceAttr(), lens.GetFStopAttr(), lens.GetExposureAttr()):
        if ctx.times.animated and attribute.ValueMightBeTimeVarying():
            ctx.report.approximated(prim, f"{attribute.GetName()} that changes", "it is that of the first frame")
    if lens.GetStereoRoleAttr().Get() not in (None, UsdGeom.Tokens.mono):
        ctx.report.left_out(prim, "stereoRole", "cameras are rendered one by one")
