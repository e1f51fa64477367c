"""Shader networks of UsdShade, read into values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pxr import Gf, Sdf, UsdShade

from .assets import resolve_asset
from .context import Context, as_float
from .texture import Const, Coordinates, Image, Value, depth

MAX_NODES = 100_000  # visited for one input
MAX_DEPTH = 28  # of textures inside of each other; the language has 32

Result = Value | Coordinates | None
NodeReader = Callable[["Network", UsdShade.Shader, str], "Result"]
READERS: dict[str, NodeReader] = {}


def reads(*names: str) -> Callable[[NodeReader], NodeReader]:
    """Says which nodes a function reads."""

    def enter(function: NodeReader) -> NodeReader:
        for name in names:
            READERS[name] = function
        return function

    return enter


def node_kind(identifier: str) -> str:
    """`multiply` of `ND_multiply_color3FA`, `UsdUVTexture` of itself and of MaterialX's form of it."""
    if not identifier.startswith("ND_"):
        return identifier
    name = identifier[3:]
    for known in ("open_pbr_surface", "standard_surface", "gltf_pbr"):
        if name.startswith(known):
            return known
    return name.split("_")[0]


def const_of(value: Any) -> Const | None:
    """A constant of numbers; None for anything else."""
    if isinstance(value, bool):
        return Const((float(value),))
    if isinstance(value, (int, float)):
        return Const((as_float(value),))
    if isinstance(value, (Gf.Vec2f, Gf.Vec3f, Gf.Vec4f, Gf.Vec2d, Gf.Vec3d, Gf.Vec4d, Gf.Vec3h, Gf.Vec2i, Gf.Vec3i)):
        return Const(tuple(as_float(x) for x in value))
    return None


class Network:
    """The network behind one material."""

    def __init__(self, ctx: Context, material: UsdShade.Material) -> None:
        self.ctx = ctx
        self.material = material
        self._cache: dict[tuple[str, str], Result] = {}
        self._busy: set[str] = set()
        self._visited = 0

    def source(self, shader: UsdShade.Shader, name: str) -> tuple[Any, str] | None:
        """Where an input has its value from: an attribute with a value, or a shader's output."""
        port = shader.GetInput(name)
        if not port:
            return None
        attributes = UsdShade.Utils.GetValueProducingAttributes(port)
        if not attributes:
            return None
        attribute = attributes[0]
        base, kind = UsdShade.Utils.GetBaseNameAndType(attribute.GetName())
        return attribute, (base if kind == UsdShade.AttributeType.Output else "")

    def raw(self, shader: UsdShade.Shader, name: str, otherwise: Any = None) -> Any:
        """The plain value of an input, whatever its type; `otherwise` if it is connected or absent."""
        found = self.source(shader, name)
        if found is None or found[1]:
            return otherwise
        value = found[0].Get(self.ctx.times.first)
        return otherwise if value is None else value

    def number(self, shader: UsdShade.Shader, name: str, otherwise: float) -> float:
        """A number that cannot be a texture."""
        value = self.value(shader, name)
        if value is None:
            return otherwise
        if isinstance(value, Const):
            return value.number
        self.ctx.report.approximated(shader.GetPrim(), f"a texture at {name}", f"it is {otherwise:g}: this takes one value")
        return otherwise

    def value(self, shader: UsdShade.Shader, name: str, otherwise: Value | None = None) -> Value | None:
        """The value of an input; `otherwise` where it has none."""
        result = self.any(shader, name)
        if isinstance(result, Coordinates):
            self.ctx.report.left_out(shader.GetPrim(), f"texture coordinates at {name}", "they are no colours here")
            return otherwise
        return otherwise if result is None else result

    def any(self, shader: UsdShade.Shader, name: str) -> Result:
        found = self.source(shader, name)
        if found is None:
            return None
        attribute, output = found
        if output:
            return self.output(UsdShade.Shader(attribute.GetPrim()), output)
        constant = const_of(attribute.Get(self.ctx.times.first))
        if constant is not None and not all(-1e30 < x < 1e30 for x in constant.values):
            self.ctx.report.error("E0802", shader.GetPrim(), f"inputs:{name} is not finite", "a number is wanted")
            return None
        return constant

    def output(self, shader: UsdShade.Shader, output: str) -> Result:
        """What a node of the network gives."""
        prim = shader.GetPrim()
        key = (str(prim.GetPath()), output)
        if key in self._cache:
            return self._cache[key]
        if key[0] in self._busy:
            self.ctx.report.error("E0802", prim, "a shader network that feeds itself", "break the cycle of connections")
            return None
        self._visited += 1
        if self._visited > MAX_NODES or len(self._busy) > 200:
            self.ctx.report.error("E0802", prim, "a shader network without end", f"more than {MAX_NODES} nodes, or 200 deep")
            return None
        identifier = str(shader.GetIdAttr().Get() or "")
        if "UsdPrimvarReader" in identifier:
            kind = "UsdPrimvarReader"
        else:
            kind = node_kind(identifier)
        self._busy.add(key[0])
        reader = READERS.get(kind)
        result = reader(self, shader, output) if reader else self._unknown(shader, identifier)
        if not isinstance(result, (Coordinates, type(None))) and depth(result) > MAX_DEPTH:
            self.ctx.report.left_out(prim, "a network that is too deep", f"{MAX_DEPTH} textures may hold each other")
            result = None
        self._busy.discard(key[0])
        self._cache[key] = result
        return result

    def _unknown(self, shader: UsdShade.Shader, identifier: str) -> Result:
        what = f"the node {identifier}" if identifier else "a node without info:id"
        for name in ("in", "in1", "input", "bg", "default"):
            result = self.any(shader, name)
            if result is not None:
                self.ctx.report.left_out(shader.GetPrim(), what, f"its `{name}` is passed on")
                return result
        self.ctx.report.left_out(shader.GetPrim(), what, "the default of what it feeds is taken")
        return None

    def asset(self, shader: UsdShade.Shader, name: str) -> Image | None:
        """The picture that an input names, or None with a remark."""
        found = self.source(shader, name)
        if found is None or found[1]:
            return None
        value = found[0].Get(self.ctx.times.first)
        if not isinstance(value, Sdf.AssetPath) or not value.path:
            return None
        ref = resolve_asset(self.ctx, shader.GetPrim(), value, found[0])
        space = str(found[0].GetColorSpace() or "")
        return Image(ref, space or None) if ref else None
