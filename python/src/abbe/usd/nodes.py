"""Nodes of shader networks: those of UsdPreviewSurface, and those of MaterialX that textures here can say."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any

from pxr import Sdf, UsdShade

from .network import Network, Result, reads
from .texture import (
    Attribute,
    Const,
    Coordinates,
    Image,
    Pattern,
    Position,
    Product,
    Ramp,
    Step,
    Value,
    clamped,
    curve,
    mix,
    scaled,
    spread,
    within,
)

CHANNELS = {"r": "red", "g": "green", "b": "blue", "a": "alpha", "x": "red", "y": "green", "z": "blue", "w": "alpha"}
SPACES = {
    "sRGB": "srgb_rec709_scene", "srgb_texture": "srgb_rec709_scene", "srgb_rec709_scene": "srgb_rec709_scene",
    "srgb_tx": "srgb_rec709_scene", "raw": "data", "data": "data", "Raw": "data", "none": "data", "identity": "data",
    "lin_rec709": "lin_rec709_scene", "lin_rec709_scene": "lin_rec709_scene", "lin_srgb": "lin_rec709_scene",
    "acescg": "lin_ap1_scene", "lin_ap1": "lin_ap1_scene", "lin_ap1_scene": "lin_ap1_scene",
    "lin_ap0_scene": "lin_ap0_scene", "lin_rec2020_scene": "lin_rec2020_scene", "lin_rec2020": "lin_rec2020_scene",
    "lin_p3d65_scene": "lin_p3d65_scene", "lin_displayp3": "lin_p3d65_scene", "lin_adobergb": "lin_adobergb_scene",
    "lin_adobergb_scene": "lin_adobergb_scene", "srgb_p3d65_scene": "srgb_p3d65_scene",
    "srgb_displayp3": "srgb_p3d65_scene", "srgb_ap1_scene": "srgb_ap1_scene", "g22_rec709": "g22_rec709_scene",
    "g22_rec709_scene": "g22_rec709_scene", "g18_rec709": "g18_rec709_scene", "g18_rec709_scene": "g18_rec709_scene",
    "g22_ap1": "g22_ap1_scene", "g22_ap1_scene": "g22_ap1_scene", "adobergb": "g22_adobergb_scene",
    "g22_adobergb_scene": "g22_adobergb_scene", "auto": "", "": "",
}  # fmt: skip
WRAPS = {"repeat": "periodic", "periodic": "periodic", "clamp": "clamp", "mirror": "mirror", "black": "black",
         "constant": "black", "useMetadata": "black"}  # fmt: skip


def space_of(net: Network, shader: UsdShade.Shader, name: str) -> str | None:
    if name not in SPACES:
        net.ctx.report.unknown(shader.GetPrim(), f"the colour space {name}", "what the file itself says is taken")
    return SPACES.get(name) or None


def is_number(shader: UsdShade.Shader, output: str) -> bool:
    port = shader.GetOutput(output)
    return bool(port) and port.GetTypeName() in (Sdf.ValueTypeNames.Float, Sdf.ValueTypeNames.Int, Sdf.ValueTypeNames.Double)


def coordinates(net: Network, shader: UsdShade.Shader, name: str) -> Coordinates:
    found = net.any(shader, name)
    if found is None or isinstance(found, Coordinates):
        return found or Coordinates("")
    net.ctx.report.left_out(shader.GetPrim(), f"what is connected to {name}", "texture coordinates are a primvar, moved, turned and scaled")
    return Coordinates("")


def wrapped(net: Network, shader: UsdShade.Shader, image: Image, names: tuple[str, str], otherwise: str) -> Image:
    modes = [str(net.raw(shader, name, otherwise)) for name in names]
    for mode in modes:
        if mode not in WRAPS:
            net.ctx.report.unknown(shader.GetPrim(), f"the wrap mode {mode}", f"{', '.join(WRAPS)} are")
    words = [WRAPS.get(mode, "periodic") for mode in modes]
    if words[0] != words[1]:
        net.ctx.report.approximated(shader.GetPrim(), "different wrap modes along s and t", f"both are {words[0]}")
    if "<UDIM>" in image.file.path:
        return image
    return dataclasses.replace(image, wrap=words[0])


@reads("UsdUVTexture")
def uv_texture(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    fallback = tuple(net.raw(shader, "fallback", (0.0, 0.0, 0.0, 1.0)))
    channel = {"r": 0, "g": 1, "b": 2, "a": 3}.get(output)
    image = picture(net, shader)
    if image is None:
        return Const(fallback[:3] if channel is None else (fallback[channel],))
    if channel is not None:
        image = dataclasses.replace(image, take=CHANNELS[output])
    scale, bias = tuple(net.raw(shader, "scale", (1.0,) * 4)), tuple(net.raw(shader, "bias", (0.0,) * 4))
    part = slice(0, 3) if channel is None else slice(channel, channel + 1)
    value = scaled(image, scale[part], bias[part], channel is not None)
    if value is None:
        net.ctx.report.approximated(
            shader.GetPrim(),
            f"scale {scale[:3]} and bias {bias[:3]} of a picture",
            "colours beyond 0 and 1 are no textures here: it is as it is stored",
        )
        return image
    return value


def picture(net: Network, shader: UsdShade.Shader) -> Image | None:
    """The picture of a UsdUVTexture, before its scale and bias."""
    image = net.asset(shader, "file")
    if image is None:
        return None
    stated = str(net.raw(shader, "sourceColorSpace", "auto"))
    space = space_of(net, shader, image.space or "" if stated == "auto" else stated)
    image = dataclasses.replace(image, space=space, at=coordinates(net, shader, "st"))
    return wrapped(net, shader, image, ("wrapS", "wrapT"), "useMetadata")


@reads("UsdPrimvarReader")
def primvar_reader(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    return primvar_value(net, shader, str(net.raw(shader, "varname", "st") or "st"), output, "fallback")


def primvar_value(net: Network, shader: UsdShade.Shader, name: str, output: str, default: str) -> Result:
    kind = str(shader.GetIdAttr().Get() or "").rsplit("_", 1)[-1]
    if kind in ("float2", "vector2", "texcoord2f"):
        return Coordinates(name)
    given = net.raw(shader, default)
    if kind in ("float", "int", "integer"):
        return Attribute(name, 1, (float(given) if given is not None else 0.0,))
    fallback = tuple(float(x) for x in given)[:3] if given is not None and hasattr(given, "__len__") else (0.0,) * 3
    return Attribute(name, 3, fallback)


@reads("UsdTransform2d")
def transform_2d(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    at = coordinates(net, shader, "in")
    scale, offset = net.raw(shader, "scale", (1.0, 1.0)), net.raw(shader, "translation", (0.0, 0.0))
    step = Step((float(scale[0]), float(scale[1])), float(net.raw(shader, "rotation", 0.0)), (float(offset[0]), float(offset[1])))
    return Coordinates(at.primvar, (*at.steps, step))


@reads("texcoord")
def texcoord(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    index = int(net.raw(shader, "index", 0))
    return Coordinates("st" if index == 0 else f"st{index}")


@reads("geompropvalue")
def geomprop(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    return primvar_value(net, shader, str(net.raw(shader, "geomprop", "st")), output, "default")


@reads("geomcolor")
def geomcolor(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    return Attribute("displayColor", 3, (1.0, 1.0, 1.0))


def pair(net: Network, shader: UsdShade.Shader, name: str, otherwise: float) -> tuple[float, float]:
    value = net.value(shader, name)
    if isinstance(value, Const):
        two = spread(value, 2)
        return two[0], two[1]
    return otherwise, otherwise


@reads("place2d")
def place_2d(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    at = coordinates(net, shader, "texcoord")
    pivot, scale, offset = pair(net, shader, "pivot", 0), pair(net, shader, "scale", 1), pair(net, shader, "offset", 0)
    rotate = net.number(shader, "rotate", 0.0)
    if 0 in scale:
        net.ctx.report.error("E0802", shader.GetPrim(), "a scale of 0", "texture coordinates are divided by it")
        return at
    before = Step(offset=(-pivot[0], -pivot[1]))
    # rotate2d of MaterialX turns pictures counter-clockwise, and so coordinates clockwise.
    turned = Step((1 / scale[0], 1 / scale[1]), -rotate, (pivot[0] - offset[0], pivot[1] - offset[1]))
    if int(net.raw(shader, "operationorder", 0)) == 1:
        net.ctx.report.approximated(shader.GetPrim(), "operationorder 1 of place2d", "it is scaled, turned and moved in this order")
    return Coordinates(at.primvar, (*at.steps, before, turned) if any(pivot) else (*at.steps, turned))


def mtlx_picture(net: Network, shader: UsdShade.Shader) -> Image | None:
    image = net.asset(shader, "file")
    if image is None:
        return None
    image = dataclasses.replace(image, space=space_of(net, shader, image.space or ""), at=coordinates(net, shader, "texcoord"))
    return wrapped(net, shader, image, ("uaddressmode", "vaddressmode"), "periodic")


@reads("image")
def image_node(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    image = mtlx_picture(net, shader)
    if image is None:
        return net.value(shader, "default")
    return dataclasses.replace(image, take="red") if is_number(shader, output) else image


@reads("tiledimage")
def tiled_image(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    image = mtlx_picture(net, shader)
    if image is None:
        return net.value(shader, "default")
    tiling, offset = pair(net, shader, "uvtiling", 1), pair(net, shader, "uvoffset", 0)
    size, tile = pair(net, shader, "realworldimagesize", 1), pair(net, shader, "realworldtilesize", 1)
    if 0 in size:
        net.ctx.report.error("E0802", shader.GetPrim(), "a realworldimagesize of 0", "texture coordinates are divided by it")
        return image
    ratio = (tile[0] / size[0], tile[1] / size[1])
    step = Step((tiling[0] * ratio[0], tiling[1] * ratio[1]), 0.0, (-offset[0] * ratio[0], -offset[1] * ratio[1]))
    image = dataclasses.replace(image, at=Coordinates(image.at.primvar, (*image.at.steps, step)))
    return dataclasses.replace(image, take="red") if is_number(shader, output) else image


@dataclasses.dataclass(frozen=True)
class NormalMap:
    """A picture of directions, and the factor of its slopes."""

    image: Image
    strength: float


def normal_map(net: Network, shader: UsdShade.Shader, name: str) -> NormalMap | None:
    """What is connected to an input for normals."""
    found = net.source(shader, name)
    if found is None or not found[1]:
        return None
    node = UsdShade.Shader(found[0].GetPrim())
    kind = str(node.GetIdAttr().Get() or "")
    strength = 1.0
    if kind.startswith("ND_normalmap"):
        strength = net.number(node, "scale", 1.0)
        inner = net.any(node, "in")
        if isinstance(inner, Image) and not inner.take:
            return NormalMap(inner, strength)
    elif "UsdUVTexture" in kind:
        image = picture(net, node)
        if image is None:
            return None
        scale, bias = tuple(net.raw(node, "scale", (1.0,) * 4))[:3], tuple(net.raw(node, "bias", (0.0,) * 4))[:3]
        if scale != (2, 2, 2) or bias != (-1, -1, -1):
            net.ctx.report.approximated(
                node.GetPrim(), f"a normal map of scale {scale} and bias {bias}", "it is taken as 2 and -1, which fit pictures of 8 bits"
            )
        return NormalMap(image, strength)
    elif kind.startswith(("ND_normal_", "ND_Nworld")):
        return None  # the surface's own
    net.ctx.report.left_out(shader.GetPrim(), f"what is connected to {name}", f"a picture of normals is wanted, not {kind or 'this'}")
    return None


# Arithmetic. Numbers may be any function of one texture; colours are multiplied and mixed.


def _operate(a: Const, b: Const, f: Callable[[float, float], float]) -> Const:
    n = max(len(a.values), len(b.values))
    return Const(tuple(f(x, y) for x, y in zip(spread(a, n), spread(b, n), strict=True)))


def _lost(net: Network, shader: UsdShade.Shader, what: str, kept: Value) -> Value:
    net.ctx.report.approximated(shader.GetPrim(), what, "colours of pictures are multiplied and mixed here: it is passed on as it is")
    return kept


def _move(at: Coordinates, scale: Sequence[float], offset: Sequence[float]) -> Coordinates:
    step = Step((scale[0], scale[1]), 0.0, (offset[0], offset[1]))
    return Coordinates(at.primvar, (*at.steps, step))


def _linear(net: Network, shader: UsdShade.Shader, output: str, a: Any, s: Const, b: Const) -> Result:
    """a · s + b."""
    if isinstance(a, Coordinates):
        return _move(a, spread(s, 2), spread(b, 2))
    value = scaled(a, s.values, b.values, is_number(shader, output))
    return value if value is not None else _lost(net, shader, "a picture times and plus constants", a)


@reads("multiply", "divide")
def multiply(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    a, b = net.any(shader, "in1"), net.any(shader, "in2")
    divides = "divide" in str(shader.GetIdAttr().Get())
    if divides and isinstance(b, Const):
        if 0 in b.values:
            net.ctx.report.error("E0802", shader.GetPrim(), "a division by 0", "look at in2")
            return a
        b = Const(tuple(1 / x for x in b.values))
    if a is None or b is None:
        return b if a is None else a
    if isinstance(a, Position) and isinstance(b, Const) and len(set(b.values)) == 1:
        return Position("", (), a.factor * b.number)
    if isinstance(a, Const) and isinstance(b, Const):
        return _operate(a, b, lambda x, y: x * y)
    if isinstance(b, Const):
        return _linear(net, shader, output, a, b, Const((0.0,)))
    if isinstance(a, Const) and not divides:
        return _linear(net, shader, output, b, a, Const((0.0,)))
    if isinstance(a, Coordinates) or isinstance(b, Coordinates) or divides:
        net.ctx.report.left_out(shader.GetPrim(), "this product or quotient", "its first part is passed on")
        return a
    return Product(a, b)


@reads("add", "subtract")
def add(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    a, b = net.any(shader, "in1"), net.any(shader, "in2")
    minus = "subtract" in str(shader.GetIdAttr().Get())
    sign = -1.0 if minus else 1.0
    if a is None or b is None:
        return a if b is None else b
    if isinstance(a, Const) and isinstance(b, Const):
        return _operate(a, b, lambda x, y: x + sign * y)
    if isinstance(b, Const):
        return _linear(net, shader, output, a, Const((1.0,)), Const(tuple(sign * x for x in b.values)))
    if isinstance(a, Const):
        return _linear(net, shader, output, b, Const((sign,)), a)
    if isinstance(a, Coordinates) or isinstance(b, Coordinates) or not is_number(shader, output):
        return _lost(net, shader, "a sum of two textures", a) if not isinstance(a, Coordinates) else a
    # Half of the sum is a mixture; what goes beyond 0 and 1 ends there.
    if minus:
        half = mix(a, scaled(b, (-1.0,), (1.0,), True) or b, Const((0.5,)))
        return Ramp(half, ((0.5, Const((0.0,))), (1.0, Const((1.0,)))))
    return Ramp(mix(a, b, Const((0.5,))), ((0.0, Const((0.0,))), (0.5, Const((1.0,)))))


@reads("mix")
def mix_node(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    zero = Const((0.0,))
    return mix(net.value(shader, "bg", zero) or zero, net.value(shader, "fg", zero) or zero, net.value(shader, "mix", zero) or zero)


@reads("invert")
def invert(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    value, amount = net.value(shader, "in"), net.value(shader, "amount", Const((1.0,)))
    if value is None or not isinstance(amount, Const):
        return value
    if isinstance(value, Const):
        return _operate(amount, value, lambda x, y: x - y)
    return _linear(net, shader, output, value, Const((-1.0,)), amount)


@reads("clamp", "remap", "range", "power", "smoothstep", "contrast", "absval", "sign", "sqrt", "min", "max")
def unary(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    """Functions of one number: curves of 17 points where they are no straight lines."""
    kind = str(shader.GetIdAttr().Get())[3:].split("_")[0]
    two = kind in ("power", "min", "max")
    value = net.value(shader, "in1" if two else "in")
    if value is None:
        return None
    f = _function(net, shader, kind)
    if f is None:
        net.ctx.report.left_out(shader.GetPrim(), f"{kind} by a texture", "its first input is passed on")
        return value
    if isinstance(value, Const):
        return Const(tuple(f(x) for x in value.values))
    if not is_number(shader, output):
        return value if kind in ("clamp", "absval") else _lost(net, shader, f"{kind} of a coloured texture", value)
    low, high = f(0.0), f(1.0)
    if kind == "remap" and abs(f(0.5) - (low + high) / 2) <= 1e-6 * (1 + abs(low) + abs(high)):
        return scaled(value, (high - low,), (low,), True)
    if kind == "clamp" and f(-1e9) == 0 and f(1e9) == 1:
        return within(value)
    return curve(value, f, straight=kind == "remap")


def _function(net: Network, shader: UsdShade.Shader, kind: str) -> Callable[[float], float] | None:
    def at(name: str, otherwise: float) -> float:
        value = net.value(shader, name)
        return value.number if isinstance(value, Const) else otherwise

    if kind in ("power", "min", "max"):
        second = net.value(shader, "in2", Const((1.0,)))
        if not isinstance(second, Const):
            return None
        p = second.number
        return {"power": lambda x: math.pow(max(x, 0.0), p), "min": lambda x: min(x, p), "max": lambda x: max(x, p)}[kind]
    if kind == "clamp":
        low, high = at("low", 0), at("high", 1)
        return lambda x: min(high, max(low, x))
    if kind in ("remap", "range", "smoothstep"):
        a, b = at("inlow" if kind != "smoothstep" else "low", 0), at("inhigh" if kind != "smoothstep" else "high", 1)
        low, high, gamma = at("outlow", 0), at("outhigh", 1), at("gamma", 1)
        if a == b:
            return lambda x: low if x < a else high

        def map_range(x: float) -> float:
            t = (x - a) / (b - a)
            if kind == "smoothstep":
                t = clamped(t)
                return t * t * (3 - 2 * t)
            if kind == "range" and gamma > 0:
                t = math.pow(max(t, 0.0), 1 / gamma)
            return low + t * (high - low)

        return map_range
    if kind == "contrast":
        amount, pivot = at("amount", 1), at("pivot", 0.5)
        return lambda x: (x - pivot) * amount + pivot
    simple: dict[str, Callable[[float], float]] = {
        "absval": lambda x: abs(x),
        "sqrt": lambda x: math.sqrt(max(x, 0.0)),
        "sign": lambda x: math.copysign(1.0, x) if x else 0.0,
    }
    return simple.get(kind)


# Channels.


def take(net: Network, shader: UsdShade.Shader, value: Result, index: int) -> Result:
    if isinstance(value, Const):
        return Const((spread(value, index + 1)[index],))
    if isinstance(value, Image) and not value.take:
        return dataclasses.replace(value, take=["red", "green", "blue", "alpha"][index])
    if isinstance(value, Position):
        if value.factor * net.ctx.metres_per_scene_unit != 1:
            net.ctx.report.approximated(shader.GetPrim(), "a coordinate that is scaled", "it is in metres")
        return Ramp("xyz"[min(index, 2)], ((0.0, Const((0.0,))), (1.0, Const((1.0,)))))
    if isinstance(value, Coordinates):
        return Ramp("uv"[min(index, 1)], ((0.0, Const((0.0,))), (1.0, Const((1.0,)))), value)
    if index:
        net.ctx.report.approximated(shader.GetPrim(), f"channel {index + 1} of what is no picture", "its first one is taken")
    return value


@reads("extract")
def extract(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    return take(net, shader, net.any(shader, "in"), min(max(int(net.raw(shader, "index", 0)), 0), 3))


@reads("separate2", "separate3", "separate4")
def separate(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    index = {"outr": 0, "outg": 1, "outb": 2, "outa": 3, "outx": 0, "outy": 1, "outz": 2, "outw": 3}.get(output, 0)
    return take(net, shader, net.any(shader, "in"), index)


@reads("swizzle")
def swizzle(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    channels = str(net.raw(shader, "channels", ""))
    value = net.any(shader, "in")
    if len(channels) == 1:
        return take(net, shader, value, "rgbaxyzw".find(channels) % 4 if channels in "rgbaxyzw" else 0)
    return value


@reads("combine2", "combine3", "combine4")
def combine(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    parts = [net.value(shader, f"in{i}", Const((0.0,))) for i in range(1, 4)]
    if all(isinstance(p, Const) for p in parts):
        return Const(tuple(p.number for p in parts if isinstance(p, Const)))
    plain = [dataclasses.replace(p, take="") if isinstance(p, Image) else p for p in parts]
    if all(p == plain[0] for p in plain) and [getattr(p, "take", "") for p in parts] == ["red", "green", "blue"]:
        return plain[0]
    if all(p == parts[0] for p in parts):
        return parts[0]
    kept = next(p for p in parts if not isinstance(p, Const))
    net.ctx.report.left_out(shader.GetPrim(), "a colour of several textures", "the first one is taken for all channels")
    return kept


@reads("convert", "dot", "constant", "saturate", "hsvadjust", "colorcorrect")
def passed_on(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    kind = str(shader.GetIdAttr().Get())[3:].split("_")[0]
    value = net.any(shader, "value" if kind == "constant" else "in")
    if kind in ("saturate", "hsvadjust", "colorcorrect") and value is not None:
        net.ctx.report.approximated(shader.GetPrim(), kind, "its input is passed on as it is")
    return value


@reads("luminance")
def luminance(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    value = net.value(shader, "in")
    if isinstance(value, Const):
        r, g, b = value.rgb()
        return Const((0.2722287 * r + 0.6740818 * g + 0.0536895 * b,))
    net.ctx.report.approximated(shader.GetPrim(), "the luminance of a texture", "its first channel is taken")
    return value


# Patterns.


@reads("ramplr", "ramptb", "splitlr", "splittb")
def ramp(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    kind = str(shader.GetIdAttr().Get())[3:].split("_")[0]
    at, zero = coordinates(net, shader, "texcoord"), Const((0.0,))
    across = kind.endswith("lr")
    low = net.value(shader, "valuel" if across else "valueb", zero) or zero
    high = net.value(shader, "valuer" if across else "valuet", zero) or zero
    centre = clamped(net.number(shader, "center", 0.5))
    places = (centre, centre) if kind.startswith("split") else (0.0, 1.0)
    return Ramp("u" if across else "v", ((places[0], low), (places[1], high)), at)


@reads("ramp4")
def ramp_of_corners(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    at, zero = coordinates(net, shader, "texcoord"), Const((0.0,))
    tl, tr, bl, br = (net.value(shader, f"value{c}", zero) or zero for c in ("tl", "tr", "bl", "br"))
    bottom, top = Ramp("u", ((0.0, bl), (1.0, br)), at), Ramp("u", ((0.0, tl), (1.0, tr)), at)
    return Ramp("v", ((0.0, bottom), (1.0, top)), at)


@reads("checkerboard")
def checkerboard(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    at, tiling = coordinates(net, shader, "texcoord"), pair(net, shader, "uvtiling", 8)
    one, two = net.value(shader, "color1", Const((1.0,) * 3)), net.value(shader, "color2", Const((0.0,) * 3))
    scaled_at = Coordinates(at.primvar, (*at.steps, Step((tiling[0], tiling[1]))))
    odd = Pattern("checker", (("even", "0"), ("odd", "1"), ("scale", "1")), scaled_at)
    return mix(two or Const((0.0,)), one or Const((1.0,)), odd)  # color1 has the odd ones


@reads("position")
def position(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    space = str(net.raw(shader, "space", "object"))
    if space not in ("object", "model"):
        net.ctx.report.approximated(shader.GetPrim(), f"positions in the space `{space}`", "those of the shape are taken")
    return Position("")


@reads("modulo")
def modulo(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    """The parity of cubes: the sum of the whole parts of a position, modulo 2."""
    cells = _cells(net, shader)
    if cells is None or cells.factor <= 0:
        net.ctx.report.left_out(shader.GetPrim(), "modulo", "its first input is passed on, unless it counts cubes")
        return net.any(shader, "in1") if cells is None else None
    edge = net.ctx.metres_per_scene_unit / cells.factor
    return Pattern("checker", (("even", "0"), ("odd", "1"), ("scale", f"{edge:.9g} m")))


def _cells(net: Network, shader: UsdShade.Shader) -> Position | None:
    """What is rounded down and summed up before a modulo of 2."""
    for kind, name in (("ND_modulo_float", "in1"), ("ND_dotproduct_vector3", "in1"), ("ND_floor_vector3", "in")):
        if shader.GetIdAttr().Get() != kind:
            return None
        if kind == "ND_modulo_float" and net.any(shader, "in2") != Const((2.0,)):
            return None
        if kind == "ND_dotproduct_vector3" and net.any(shader, "in2") != Const((1.0,) * 3):
            return None
        found = net.source(shader, name)
        if found is None or not found[1]:
            return None
        if kind == "ND_floor_vector3":
            cells = net.any(shader, name)
            return cells if isinstance(cells, Position) else None
        shader = UsdShade.Shader(found[0].GetPrim())
    return None


# What gradient noise of MaterialX is to ours [MaterialX2023, mx_noise]: gradients √2 long times 0.982, and of length 1 times 2/√3.
STRENGTH = 0.982 * math.sqrt(2) / (2 / math.sqrt(3))


@reads("noise2d", "noise3d", "fractal2d", "fractal3d", "cellnoise2d", "cellnoise3d", "worleynoise2d", "worleynoise3d")
def noise(net: Network, shader: UsdShade.Shader, output: str) -> Result:
    kind = str(shader.GetIdAttr().Get())[3:].split("_")[0]
    amplitude, pivot = net.value(shader, "amplitude", Const((1.0,))), net.value(shader, "pivot", Const((0.0,)))
    metres, total = net.ctx.metres_per_scene_unit, 1.0
    at = net.any(shader, "position")
    if isinstance(at, Position) and at.factor > 0:
        metres /= at.factor
    properties = [("scale", f"{float(f'{metres:.9g}')!r} m"), ("octaves", "1")]
    if kind.startswith("fractal"):
        octaves = min(16, max(1, int(net.raw(shader, "octaves", 3))))
        lacunarity = min(8.0, max(1.0, net.number(shader, "lacunarity", 2.0)))
        gain = clamped(net.number(shader, "diminish", 0.5))
        total = sum(gain**k for k in range(octaves))
        properties[1:] = [("octaves", str(octaves)), ("lacunarity", repr(lacunarity)), ("gain", repr(gain))]
    net.ctx.report.approximated(shader.GetPrim(), kind, "another noise of this size and amplitude, in the space of the shape")
    a = amplitude.number if isinstance(amplitude, Const) else 1.0
    p = pivot.number if isinstance(pivot, Const) else 0.0
    value = Pattern("noise", tuple(properties))
    if kind.startswith(("cell", "worley")):
        return value
    a *= total * (STRENGTH if "3d" in kind else 1.0)
    return scaled(value, (2 * a,), (p - a,), True)
