"""Values over a surface, between the shader networks of a stage and the textures of the scene language."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from .context import as_float
from .scene_text import FileRef, Node

SAME = 1e-6  # of factors that went through numbers of single precision
LUT_STOPS = 17  # of a curve that is no straight line


@dataclasses.dataclass(frozen=True)
class Const:
    values: tuple[float, ...]

    @property
    def number(self) -> float:
        return self.values[0]

    def rgb(self) -> tuple[float, float, float]:
        v = self.values
        return (v[0], v[1], v[2]) if len(v) >= 3 else (v[0], v[0], v[0])


@dataclasses.dataclass(frozen=True)
class Step:
    """How texture coordinates are changed: scaled, then turned counter-clockwise (degrees), then moved."""

    scale: tuple[float, float] = (1.0, 1.0)
    rotate: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)


@dataclasses.dataclass(frozen=True)
class Coordinates:
    """Texture coordinates of a name, and what is done to them in order."""

    primvar: str
    steps: tuple[Step, ...] = ()


@dataclasses.dataclass(frozen=True)
class Position(Coordinates):
    """Places in the space of the shape, in units of the stage, times a factor."""

    factor: float = 1.0


@dataclasses.dataclass(frozen=True)
class Image:
    file: FileRef
    space: str | None  # None: as the file says
    wrap: str = "periodic"
    take: str = ""  # red, green, blue, alpha, or empty: its colour
    at: Coordinates = Coordinates("")


@dataclasses.dataclass(frozen=True)
class Attribute:
    """A primvar that is no texture coordinate."""

    source: str
    size: int
    fallback: tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class Product:
    first: Value
    second: Value


@dataclasses.dataclass(frozen=True)
class Ramp:
    """Values at positions; linear in between, constant beyond. `over` is `u`, `v` or another value."""

    over: Value | str
    stops: tuple[tuple[float, Value], ...]
    at: Coordinates = Coordinates("")


@dataclasses.dataclass(frozen=True)
class Pattern:
    """`noise` or `checker`, with its properties as words."""

    kind: str
    properties: tuple[tuple[str, str], ...]
    at: Coordinates = Coordinates("")


@dataclasses.dataclass(frozen=True)
class Line:
    """A number that goes beyond 0 and 1, value · scale + bias: what is made of it may lie within again."""

    value: Value
    scale: float
    bias: float


Plain = Const | Image | Attribute | Product | Ramp | Pattern
Value = Plain | Line


def clamped(x: float) -> float:
    return min(1.0, max(0.0, x))


def mix(a: Value, b: Value, t: Value) -> Value:
    """a where t is 0, b where it is 1."""
    if isinstance(t, Const) and t.number in (0.0, 1.0):
        return b if t.number == 1 else a
    if isinstance(a, Const) and isinstance(b, Const) and isinstance(t, Const):
        n = max(len(a.values), len(b.values))
        pairs = zip(spread(a, n), spread(b, n), strict=True)
        return Const(tuple(x + (y - x) * t.number for x, y in pairs))
    return Ramp(t, ((0.0, a), (1.0, b)))


def spread(c: Const, size: int) -> tuple[float, ...]:
    return c.values * size if len(c.values) == 1 else (*c.values, *([c.values[-1]] * size))[:size]


def curve(value: Value, f: Callable[[float], float], straight: bool = False) -> Value:
    """A function of a number: exact where it is a straight line between 0 and 1."""
    if isinstance(value, Const):
        return Const(tuple(f(x) for x in value.values))
    if isinstance(value, Line):
        s, b = value.scale, value.bias
        return curve(value.value, lambda x: f(s * x + b), straight)
    count = 2 if straight else LUT_STOPS
    places = [i / (count - 1) for i in range(count)]
    return Ramp(value, tuple((x, Const((clamped(f(x)),))) for x in places))


def scaled(value: Value, scale: tuple[float, ...], bias: tuple[float, ...], is_number: bool) -> Value | None:
    """value · scale + bias, or None where textures between 0 and 1 cannot say it."""
    if isinstance(value, Const):
        n = max(len(value.values), len(scale), len(bias))
        parts = zip(spread(value, n), spread(Const(scale), n), spread(Const(bias), n), strict=True)
        return Const(tuple(v * s + b for v, s, b in parts))
    if set(scale) == {1.0} and set(bias) == {0.0}:
        return value
    if is_number:
        s, b = scale[0], bias[0]
        if isinstance(value, Line):
            s, b = s * value.scale, s * value.bias + b
            value = value.value
        if abs(s - 1) < SAME and abs(b) < SAME:
            return value
        if 0 <= b <= 1 and 0 <= s + b <= 1:
            return Ramp(value, ((0.0, Const((b,))), (1.0, Const((s + b,)))))
        return Line(value, s, b)
    value = within(value)
    if set(bias) == {0.0} and all(0 <= s <= 1 for s in scale):
        return Product(value, Const(scale))
    # colour · s + b = (1 - k) · colour · s / (1 - k) + k · b / k: a mixture with a constant.
    k = max(bias)
    if min(*bias, *scale) >= 0 and k > 0 and max(scale) <= 1 - k:
        inner = Product(value, Const(tuple(s / (1 - k) for s in scale)))
        return Ramp(Const((k,)), ((0.0, inner), (1.0, Const(tuple(b / k for b in bias)))))
    return None


def within(value: Value) -> Plain:
    """The same, ending at 0 and 1."""
    return _clipped(value.value, value.scale, value.bias) if isinstance(value, Line) else value


def _clipped(value: Value, s: float, b: float) -> Const | Ramp:
    """A straight line where it lies between 0 and 1, and 0 or 1 beyond."""
    if s == 0:
        return Const((b,))
    ends = sorted((-b / s, (1 - b) / s))
    places = [0.0, *(x for x in ends if 0 < x < 1), 1.0]
    return Ramp(value, tuple((x, Const((clamped(s * x + b),))) for x in places))


class Uses:
    """What a value asks of the meshes that have it: texture coordinates and attributes."""

    def __init__(self) -> None:
        self.uv: str | None = None
        self.other_uvs: set[str] = set()
        self.attributes: dict[str, tuple[str, int, tuple[float, ...]]] = {}
        self.colour_source: str | None = None
        self.lost_attributes: set[str] = set()

    def coordinates(self, at: Coordinates) -> None:
        name = at.primvar or "st"
        if self.uv is None:
            self.uv = name
        elif self.uv != name:
            self.other_uvs.add(name)

    def attribute(self, a: Attribute) -> str | None:
        """The name under which a mesh has it. None where there are two colours: a mesh has one."""
        if a.size == 1:
            name = a.source if a.source not in ("x", "y", "z", "u", "v", "nx", "ny", "nz", "color", "s", "t") else f"{a.source}_"
            name = "".join(c if c.isascii() and (c.isalnum() or c in "_-.") else "_" for c in name)
            self.attributes[name] = (a.source, 1, a.fallback)
            return name
        if self.colour_source not in (None, a.source):
            self.lost_attributes.add(a.source)
            return None
        self.colour_source = a.source
        self.attributes["color"] = (a.source, 3, a.fallback)
        return "color"


def _placed(node: Node, at: Coordinates) -> Node:
    """Behind `node`: the word for changed coordinates, and the node whose value is looked up with them."""
    for step in at.steps:
        if step == Step():
            continue
        node.word("placed")
        inner = node.child("map")
        if step.scale != (1.0, 1.0):
            node.set("scale", *step.scale)
        if step.rotate:
            node.set("rotate", step.rotate, "deg")
        if step.offset != (0.0, 0.0):
            node.set("offset", *step.offset)
        node = inner
    return node


def _write_image(node: Node, image: Image, uses: Uses, is_number: bool) -> None:
    uses.coordinates(image.at)
    at = _placed(node, image.at)
    if image.take and image.take != "alpha":
        at.word("channel")
        at.set("take", image.take)
        at = at.child("of")
    at.word("image").file(image.file)
    space = image.space
    if image.take == "alpha":
        space = None
    elif is_number and space in (None, "data"):
        space = "data"
    elif not is_number and space == "data":
        space = "lin_rec709_scene"
    if space:
        at.key("space", space)
    if image.wrap != "periodic":
        at.set("wrap", image.wrap)
    if image.take == "alpha":
        at.set("take", "alpha")


def write(node: Node, value: Value, uses: Uses, is_number: bool) -> None:
    """Writes a value behind a property: numbers as they are, colours as `rgb`, textures in place."""
    value = within(value)
    if isinstance(value, Const):
        if is_number or len(set(value.rgb())) == 1:
            node.numbers([as_float(value.values[0])])
        else:
            node.word("rgb").numbers(as_float(x) for x in value.rgb())
    elif isinstance(value, Image):
        _write_image(node, value, uses, is_number)
    elif isinstance(value, Attribute):
        name = uses.attribute(value)
        if name is None:
            write(node, Const(value.fallback), uses, is_number)
        else:
            node.word("attribute").text(name)
    elif isinstance(value, Product):
        node.word("product")
        write(node.child("first"), value.first, uses, is_number)
        write(node.child("second"), value.second, uses, is_number)
    elif isinstance(value, Ramp):
        at = node
        if isinstance(value.over, str) and value.over in "uv":
            uses.coordinates(value.at)
            at = _placed(node, value.at)
        at.word("ramp")
        if isinstance(value.over, str):
            at.set("over", value.over)
        else:
            over = value.over
            if isinstance(over, Const):  # `input` takes no plain number
                over = Product(over, Const((1.0,)))
            write(at.child("input"), over, uses, True)
        for place, stop in value.stops:
            child = at.child("stop").numbers([as_float(place)])
            write(child, stop, uses, is_number)
    else:
        if value.kind == "checker" and not dict(value.properties)["scale"].endswith(" m"):
            uses.coordinates(value.at)
        at = _placed(node, value.at)
        at.word(value.kind)
        for name, words in value.properties:
            at.set(name, words)


def depth(value: Value) -> int:
    """How many textures hold each other."""
    value = within(value)
    if isinstance(value, Product):
        return 1 + max(depth(value.first), depth(value.second))
    if isinstance(value, Ramp):
        inner = [depth(stop) for _, stop in value.stops]
        return 1 + max(inner + ([] if isinstance(value.over, str) else [depth(value.over)]))
    if isinstance(value, Image):
        return 2 + len(value.at.steps)
    return 1


def most(value: Value) -> float:
    """The largest number that a value can have, as far as that is known."""
    if isinstance(value, Const):
        return max(value.values)
    return 1.0
