"""Materials of a stage, each written once, and what they ask of the meshes that have them."""

from __future__ import annotations

import dataclasses

import numpy as np
from pxr import Usd, UsdShade

from . import nodes  # the readers of nodes enter themselves
from .context import Context, as_float
from .network import Network, node_kind
from .own import Prim, Stated
from .report import Fate
from .scene_text import Node
from .surfaces import WRITERS, SurfaceWriter
from .texture import Attribute, Const, Image, Line, Uses, Value, write

CONTEXTS = ["mtlx", ""]  # of surface outputs, the first one that can be read


@dataclasses.dataclass
class Look:
    """The material of a shape."""

    name: str = ""  # of the material in the scene; empty: the grey that shapes have without one
    uv: str | None = None  # the primvar with its texture coordinates
    attributes: dict[str, tuple[str, int, tuple[float, ...]]] = dataclasses.field(default_factory=dict)
    displacement: Node | None = None
    emits: bool = False


@dataclasses.dataclass(frozen=True)
class Glow:
    """Light that a surface gives off by being a light: nits, and a colour as words."""

    nits: float
    colour: tuple[str, ...]


class Materials:
    def __init__(self, ctx: Context) -> None:
        self.ctx = ctx
        self.nodes: list[Node] = []
        self._looks: dict[str, Look] = {}
        self._colours: dict[tuple[float, ...], Look] = {}

    def bound(self, prims: list[Usd.Prim]) -> list[UsdShade.Material | None]:
        """The material of each prim, by the purposes of the render settings."""
        found: list[UsdShade.Material | None] = [None] * len(prims)
        for purpose in self.ctx.binding_purposes:
            left = [i for i, material in enumerate(found) if material is None]
            if not left:
                break
            materials, _ = UsdShade.MaterialBindingAPI.ComputeBoundMaterials([prims[i] for i in left], purpose or UsdShade.Tokens.allPurpose)
            for i, material in zip(left, materials, strict=True):
                if material and material.GetPrim().IsValid():
                    found[i] = material
        return found

    def look(self, stated: Prim, material: UsdShade.Material | None, is_mesh: bool) -> Look:
        """What a shape of this prim looks like."""
        if material is None:
            return self._display_colour(stated, is_mesh)
        prim = stated.prim
        path = str(material.GetPath())
        if path not in self._looks:
            self._looks[path] = self._write(material)
        look = self._looks[path]
        if look.displacement is not None and not is_mesh:
            self.ctx.report.left_out(prim, "displacement", "only meshes have one here")
        return look

    def _write(self, material: UsdShade.Material) -> Look:
        prim = material.GetPrim()
        self.ctx.report.count(prim, Fate.USED)
        shader, kind = self._surface(material)
        if shader is None:
            why = f"its surface shader is `{kind}`" if kind else "it has no surface shader"
            self.ctx.report.left_out(prim, "a material", f"{why}: grey and matte")
            return Look()
        name = self.ctx.name("material", str(prim.GetPath()))
        node = Node("material").named(name)
        writer = SurfaceWriter(self.ctx, material, shader, node)
        WRITERS[kind](writer)
        uses = writer.uses
        displacement = self._displacement(material, kind, shader, uses)
        for other in sorted(uses.other_uvs):
            self.ctx.report.approximated(prim, f"the texture coordinates {other}", f"shapes have one set: those of {uses.uv} are taken")
        for lost in sorted(uses.lost_attributes):
            self.ctx.report.approximated(prim, f"the primvar {lost}", "meshes have one colour: the fallback is taken")
        self.nodes.append(node)
        return Look(name, uses.uv, uses.attributes, displacement, writer.emits)

    def _surface(self, material: UsdShade.Material) -> tuple[UsdShade.Shader | None, str]:
        """The first surface shader that can be read, and its kind; else what there is instead."""
        seen = ""
        for context in CONTEXTS:
            source = material.ComputeSurfaceSource(context)[0]
            if not source:
                continue
            identifier = str(source.GetIdAttr().Get() or source.GetImplementationSource())
            kind = node_kind(identifier)
            if kind in WRITERS:
                return source, kind
            seen = seen or identifier
        return None, seen

    def _displacement(self, material: UsdShade.Material, kind: str, surface: UsdShade.Shader, uses: Uses) -> Node | None:
        """Displacement of UsdPreviewSurface: a number in units of the stage, along the normal."""
        net = Network(self.ctx, material)
        found = (material.ComputeDisplacementSource(context)[0] for context in CONTEXTS)
        source = next((one for one in found if one), None)
        vector = False
        if source and node_kind(str(source.GetIdAttr().Get() or "")) != "UsdPreviewSurface":
            shader, factor = source, net.number(source, "scale", 1.0)
            vector = str(source.GetIdAttr().Get() or "") == "ND_displacement_vector3"
        elif kind == "UsdPreviewSurface":
            shader, factor = source or surface, 1.0
        else:
            return None
        value, length, middle = _height(net, shader)
        if value is None or isinstance(value, Const):
            if value is not None and value.number:
                self.ctx.report.left_out(material.GetPrim(), "an even displacement", "it needs a texture here")
            return None
        if isinstance(value, Image) and value.take == "red":
            value = dataclasses.replace(value, take="")  # of a height the first channel counts
        node = Node("displacement").numbers([as_float(length * factor) * self.ctx.metres_per_scene_unit]).word("m")
        write(node.child("map"), value, uses, True)
        if vector:
            node.child("kind").word("vector")
        node.set("midpoint", as_float(middle))
        return node

    def _display_colour(self, stated: Prim, is_mesh: bool) -> Look:
        """Without a material a shape has its displayColor and displayOpacity."""
        prim, colour, opacity = stated.prim, *(stated.primvar(n, self.ctx.times.first) for n in ("displayColor", "displayOpacity"))
        if colour is None and opacity is None:
            return Look()
        rgb, varies = self._mean(colour, 3)
        alpha, alpha_varies = self._mean(opacity, 1)
        if rgb is None and alpha is None:
            return Look()
        if varies or alpha_varies:
            if is_mesh:
                return self._painted(varies, alpha_varies, rgb, alpha)
            self.ctx.report.approximated(prim, "a displayColor that varies", "its mean is taken: only meshes have attributes")
        key = (*(rgb or (-1.0,) * 3), *(alpha or (1.0,)))
        if key not in self._colours:
            name = self.ctx.name("material", f"display-{len(self._colours) + 1}")
            node = Node("material").named(name).word("diffuse")
            uses = Uses()
            if rgb:
                write(node.child("reflectance"), Const(rgb), uses, False)
            if alpha and alpha[0] < 1:
                node.set("opacity", as_float(alpha[0]))
            self.nodes.append(node)
            self._colours[key] = Look(name)
        return self._colours[key]

    def _mean(self, primvar: Stated | None, size: int) -> tuple[tuple[float, ...] | None, bool]:
        """The mean of a primvar's values within 0 and 1, and whether they differ."""
        if primvar is None:
            return None, False
        rows = np.asarray(primvar.values, np.float64).reshape(-1, size)
        if not len(rows) or not np.isfinite(rows).all():
            return None, False
        rows = np.clip(rows, 0, 1)
        varies = len(rows) > 1 and bool((rows != rows[0]).any())
        return tuple(as_float(x) for x in (rows.mean(axis=0) if varies else rows[0])), varies

    def _painted(self, colour: bool, opacity: bool, rgb: tuple[float, ...] | None, alpha: tuple[float, ...] | None) -> Look:
        """A material that shows displayColor as the mesh has it."""
        key = (-2.0, float(colour), float(opacity), *(() if colour else rgb or ()), *(() if opacity else alpha or ()))
        if key not in self._colours:
            uses = Uses()
            name = self.ctx.name("material", f"painted-{len(self._colours) + 1}")
            node = Node("material").named(name).word("diffuse")
            if colour:
                write(node.child("reflectance"), Attribute("displayColor", 3, (0.5, 0.5, 0.5)), uses, False)
            elif rgb:
                write(node.child("reflectance"), Const(rgb), uses, False)
            if opacity:
                write(node.child("opacity"), Attribute("displayOpacity", 1, (1.0,)), uses, True)
            elif alpha and alpha[0] < 1:
                node.set("opacity", alpha[0])
            self.nodes.append(node)
            self._colours[key] = Look(name, None, uses.attributes)
        return self._colours[key]

    def glowing(self, path: str, glow: Glow) -> Look:
        """Black, and as bright as a light says."""
        name = self.ctx.name("material", path)
        node = Node("material").named(name).word("openpbr").set("base-weight", 0).set("specular-weight", 0)
        node.set("emission-luminance", glow.nits, "nits")
        if glow.colour:
            node.child("emission-color", *glow.colour)
        self.nodes.append(node)
        return Look(name, emits=True)


def _height(net: Network, shader: UsdShade.Shader) -> tuple[Value | None, float, float]:
    """A displacement as length · (map - middle). Heights of pictures may lie beyond 0 and 1: s · map + b = s · (map + b / s)."""
    found = net.source(shader, "displacement")
    if found is not None and found[1]:
        texture = UsdShade.Shader(found[0].GetPrim())
        channel = {"r": 0, "g": 1, "b": 2, "a": 3}.get(found[1])
        if "UsdUVTexture" in str(texture.GetIdAttr().Get()) and channel is not None:
            image = nodes.picture(net, texture)
            scale, bias = net.raw(texture, "scale", (1.0,) * 4)[channel], net.raw(texture, "bias", (0.0,) * 4)[channel]
            if image is not None and scale != 0:
                return dataclasses.replace(image, take=nodes.CHANNELS[found[1]]), scale, -bias / scale
    value = net.value(shader, "displacement")
    if isinstance(value, Line) and value.scale != 0:
        return value.value, value.scale, -value.bias / value.scale
    return value, 1.0, 0.0
