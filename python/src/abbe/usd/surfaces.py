"""Surface shaders: UsdPreviewSurface, OpenPBR and Autodesk's standard surface become `material openpbr`."""

from __future__ import annotations

from collections.abc import Callable

from pxr import UsdShade

from . import nodes
from .context import Context, as_float
from .network import Network
from .scene_text import Node
from .texture import Const, Product, Ramp, Uses, Value, clamped, most, write

MAX_NITS = 1e12


class SurfaceWriter:
    """Writes parameters of one surface shader."""

    def __init__(self, ctx: Context, material: UsdShade.Material, shader: UsdShade.Shader, node: Node) -> None:
        self.ctx, self.material, self.shader, self.node = ctx, material, shader, node
        self.net = Network(ctx, material)
        self.uses = Uses()
        self.prim = shader.GetPrim()
        self.emits = False
        self.open = False  # opacity below 1
        self.textured: set[str] = set()

    def get(self, name: str, otherwise: Value | None = None) -> Value | None:
        return self.net.value(self.shader, name, otherwise)

    def number(self, name: str, otherwise: float) -> float:
        return self.net.number(self.shader, name, otherwise)

    def note(self, text: str) -> None:
        self.node.remark(text)

    def put(self, prop: str, value: Value | None, default: float | None, is_number: bool, high: float = 1.0) -> None:
        """Writes a property unless it has its default. Constants are brought into the range."""
        if value is None:
            return
        if isinstance(value, Const):
            inside = Const(tuple(min(high, max(0.0, x)) for x in value.values))
            if inside != value:
                self.note(self.ctx.report.approximated(self.prim, f"{prop} {value.values}", f"it is brought between 0 and {high:g}"))
            if default is not None and all(abs(x - default) < 1e-9 for x in inside.values):
                return
            value = inside
        else:
            self.textured.add(prop)
        write(self.node.child(prop), value, self.uses, is_number)

    def colour(self, prop: str, name: str, default: float) -> None:
        self.put(prop, self.get(name), default, False)

    def share(self, prop: str, name: str, default: float, otherwise: float | None = None) -> None:
        """A number between 0 and 1. `otherwise` is the shader's own default where it is another."""
        value = self.get(name)
        if value is None and otherwise is not None and otherwise != default:
            value = Const((otherwise,))
        self.put(prop, value, default, True)

    def fixed(self, prop: str, name: str, default: float, low: float, high: float, *unit: str, factor: float = 1.0) -> float:
        """A number that cannot be a texture; returns it."""
        value = self.number(name, default)
        inside = min(high, max(low, value))
        if inside != value:
            self.note(self.ctx.report.approximated(self.prim, f"{name} {value:g}", f"it is brought between {low:g} and {high:g}"))
        if inside != default or unit:
            self.node.set(prop, as_float(inside) * factor, *unit)
        return inside

    def emission(self, colour: Value | None, strength: float) -> None:
        """What the surface gives off: nits where the colour is 1."""
        if colour is None or strength <= 0:
            return
        if isinstance(colour, Const):
            top = max(colour.rgb())
            if not top > 0:
                return
            strength, colour = strength * top, Const(tuple(max(0.0, x) / top for x in colour.rgb()))
        if self.open:
            self.note(self.ctx.report.left_out(self.prim, "what it emits", "a surface with holes cannot emit"))
            return
        coat = {"coat-weight", "coat-color", "coat-roughness", "fuzz-weight", "fuzz-color", "fuzz-roughness"} & self.textured
        if coat:
            self.note(self.ctx.report.left_out(self.prim, "what it emits", f"{', '.join(sorted(coat))} of a surface that emits are no textures"))
            return
        if strength > MAX_NITS:
            self.note(self.ctx.report.approximated(self.prim, "what it emits", "it has 1e12 nits, the most there is"))
            strength = MAX_NITS
        self.node.set("emission-luminance", as_float(strength), "nits")
        self.put("emission-color", colour, 1.0, False)
        self.emits = self.ctx.emits = True

    def opacity(self, value: Value | None, threshold: float = 0.0) -> None:
        if value is None:
            return
        if threshold > 0:
            if isinstance(value, Const):
                value = Const((1.0 if value.number >= threshold else 0.0,))
            else:
                edge = min(1.0, threshold * (1 - 1e-6))
                value = _step(value, edge)
        if isinstance(value, Const) and value.number >= 1:
            return
        self.open = True
        self.put("opacity", value, 1.0, True)

    def normal(self, name: str, prop: str = "normal") -> None:
        found = nodes.normal_map(self.net, self.shader, name)
        if found is None:
            return
        child = self.node.child(prop)
        write(child, found.image, self.uses, True)
        if found.strength != 1 and prop == "normal":
            child.key("strength", repr(as_float(found.strength)))

    def left_out(self, names: dict[str, tuple[float, str]]) -> None:
        """Remarks on inputs that are not at their default and have no counterpart."""
        for name, (default, why) in names.items():
            value = self.get(name)
            if value is not None and value != Const((default,)) and value != Const((default,) * 3):
                self.note(self.ctx.report.left_out(self.prim, f"{name} of {self.shader.GetIdAttr().Get()}", why))


def _step(value: Value, edge: float) -> Value:
    return Ramp(value, ((edge, Const((0.0,))), (edge, Const((1.0,)))))


def preview_surface(w: SurfaceWriter) -> None:
    """UsdPreviewSurface: α is the square of the roughness in both; emission is in nits."""
    w.node.word("openpbr")
    base = w.get("diffuseColor", Const((0.18,)))
    if int(w.net.raw(w.shader, "useSpecularWorkflow", 0)):
        specular = w.get("specularColor", Const((0.0,)))
        w.put("base-color", base, 0.8, False)
        top = most(specular) if specular is not None else 0.0
        # F0 of the index 1.5 is 0.04: weight times colour times that is the specular colour.
        w.node.set("specular-weight", as_float(top / 0.04))
        if isinstance(specular, Const) and top > 0:
            specular = Const(tuple(x / top for x in specular.rgb()))
        if top > 0:
            w.put("specular-color", specular, 1.0, False)
        w.note(w.ctx.report.approximated(w.prim, "useSpecularWorkflow", "its coloured gloss is that of a dielectric"))
    else:
        w.put("base-color", base, 0.8, False)
        w.share("base-metalness", "metallic", 0.0)
        ior = w.number("ior", 1.5)
        if ior != 1.5:
            w.node.set("specular-ior", as_float(min(10.0, max(0.2, ior))))
    w.put("specular-roughness", w.get("roughness", Const((0.5,))), 0.3, True)
    coat = w.get("clearcoat")
    if coat is not None and coat != Const((0.0,)):
        w.put("coat-weight", coat, 0.0, True)
        w.put("coat-roughness", w.get("clearcoatRoughness", Const((0.01,))), 0.0, True)
        w.node.set("coat-ior", 1.5).set("coat-darkening", 0)
    w.normal("normal")
    opacity = w.get("opacity")
    threshold = w.number("opacityThreshold", 0.0)
    transparent = str(w.net.raw(w.shader, "opacityMode", "transparent")) == "transparent"
    w.opacity(opacity, threshold)
    if w.open and transparent and threshold == 0:
        w.note(w.ctx.report.approximated(w.prim, "opacityMode transparent", "its gloss fades along with the rest"))
    w.emission(w.get("emissiveColor"), 1.0)
    w.left_out({"occlusion": (1.0, "occlusion is computed")})


def _inside_of_openpbr(w: SurfaceWriter, thin: bool) -> None:
    """Transmission, and scattering below the surface: a solid has one of them."""
    metres = w.ctx.metres
    transmission = w.get("transmission_weight")
    clear = transmission is not None and transmission != Const((0.0,))
    subsurface = w.get("subsurface_weight")
    scatters = subsurface is not None and subsurface != Const((0.0,))
    if clear and scatters and not thin and transmission != Const((1.0,)):
        w.note(w.ctx.report.left_out(w.prim, "subsurface_weight", "a solid of clear and scattering parts has no single inside (E0700)"))
        scatters = False
    if clear:
        w.put("transmission-weight", transmission, 0.0, True)
        depth = w.number("transmission_depth", 0.0)
        colour = w.get("transmission_color")
        if depth > 0 and not thin:
            w.node.set("transmission-depth", as_float(depth) * metres, "m")
            if colour is not None and not isinstance(colour, Const):
                w.note(w.ctx.report.left_out(w.prim, "a texture of transmission_color", "the inside is the same everywhere (E0702)"))
                colour = None
            scatter = w.get("transmission_scatter")
            if isinstance(scatter, Const) and any(scatter.values):
                w.put("transmission-scatter", scatter, 0.0, False)
                w.node.set("transmission-scatter-anisotropy", max(-0.99, min(0.99, w.number("transmission_scatter_anisotropy", 0.0))))
        w.put("transmission-color", colour, 1.0, False)
        if w.number("transmission_dispersion_scale", 0.0) > 0:
            w.fixed("transmission-dispersion-scale", "transmission_dispersion_scale", 0.0, 0.0, 1.0)
            w.fixed("transmission-dispersion-abbe-number", "transmission_dispersion_abbe_number", 20.0, 5.0, 1e6)
    if scatters:
        w.put("subsurface-weight", subsurface, 0.0, True)
        colour = w.get("subsurface_color")
        if colour is not None and not isinstance(colour, Const) and not thin:
            w.note(w.ctx.report.left_out(w.prim, "a texture of subsurface_color", "the inside is the same everywhere (E0702)"))
            colour = None
        w.put("subsurface-color", colour, 0.8, False)
        if not thin:
            w.node.set("subsurface-radius", max(1e-9, w.number("subsurface_radius", 1.0) * metres), "m")
            w.put("subsurface-radius-scale", w.get("subsurface_radius_scale"), None, False)
        w.fixed("subsurface-scatter-anisotropy", "subsurface_scatter_anisotropy", 0.0, -0.99, 0.99)


def open_pbr(w: SurfaceWriter) -> None:
    """OpenPBR: the same parameters, with hyphens; lengths are in units of the stage, films in micrometres."""
    w.node.word("openpbr")
    thin = bool(w.net.raw(w.shader, "geometry_thin_walled", False))
    w.share("base-weight", "base_weight", 1.0)
    w.colour("base-color", "base_color", 0.8)
    w.share("base-diffuse-roughness", "base_diffuse_roughness", 0.0)
    w.share("base-metalness", "base_metalness", 0.0)
    w.put("specular-weight", w.get("specular_weight"), 1.0, True, 1e9)
    w.colour("specular-color", "specular_color", 1.0)
    w.share("specular-roughness", "specular_roughness", 0.3)
    w.share("specular-roughness-anisotropy", "specular_roughness_anisotropy", 0.0)
    w.fixed("specular-ior", "specular_ior", 1.5, 0.2, 10.0)
    _inside_of_openpbr(w, thin)
    w.share("coat-weight", "coat_weight", 0.0)
    w.colour("coat-color", "coat_color", 1.0)
    w.share("coat-roughness", "coat_roughness", 0.0)
    w.share("coat-roughness-anisotropy", "coat_roughness_anisotropy", 0.0)
    w.fixed("coat-ior", "coat_ior", 1.6, 0.2, 10.0)
    w.share("coat-darkening", "coat_darkening", 1.0)
    w.share("fuzz-weight", "fuzz_weight", 0.0)
    w.colour("fuzz-color", "fuzz_color", 1.0)
    w.share("fuzz-roughness", "fuzz_roughness", 0.5)
    film = w.get("thin_film_weight")
    if film is not None and film != Const((0.0,)):
        w.put("thin-film-weight", film, 0.0, True)
        w.node.set("thin-film-thickness", 1000 * w.number("thin_film_thickness", 0.5), "nm")
        w.fixed("thin-film-ior", "thin_film_ior", 1.4, 0.2, 10.0)
    if thin:
        w.node.set("geometry-thin-walled", "on")
    w.normal("geometry_normal")
    w.normal("geometry_coat_normal", "geometry-coat-normal")
    w.opacity(w.get("geometry_opacity"))
    w.emission(w.get("emission_color", Const((1.0,))), w.number("emission_luminance", 0.0))
    for name in ("geometry_tangent", "geometry_coat_tangent"):
        if w.net.source(w.shader, name) is not None and w.net.any(w.shader, name) is not None:
            w.note(w.ctx.report.left_out(w.prim, name, "the tangent is along the texture's u"))


def _inside_of_standard(w: SurfaceWriter, thin: bool) -> None:
    metres = w.ctx.metres
    transmission, subsurface = w.get("transmission"), w.get("subsurface")
    clear = transmission is not None and transmission != Const((0.0,))
    scatters = subsurface is not None and subsurface != Const((0.0,))
    if clear and scatters and not thin and transmission != Const((1.0,)):
        w.note(w.ctx.report.left_out(w.prim, "subsurface", "a solid of clear and scattering parts has no single inside (E0700)"))
        scatters = False
    if clear:
        w.put("transmission-weight", transmission, 0.0, True)
        depth, colour = w.number("transmission_depth", 0.0), w.get("transmission_color")
        if depth > 0 and not thin:
            w.node.set("transmission-depth", as_float(depth) * metres, "m")
            if colour is not None and not isinstance(colour, Const):
                w.note(w.ctx.report.left_out(w.prim, "a texture of transmission_color", "the inside is the same everywhere (E0702)"))
                colour = None
        w.put("transmission-color", colour, 1.0, False)
        abbe = w.number("transmission_dispersion", 0.0)
        if abbe > 0:
            w.node.set("transmission-dispersion-scale", 1)
            w.fixed("transmission-dispersion-abbe-number", "transmission_dispersion", 20.0, 5.0, 1e6)
        w.left_out({"transmission_extra_roughness": (0.0, "glass has one roughness")})
    if scatters:
        w.put("subsurface-weight", subsurface, 0.0, True)
        colour = w.get("subsurface_color", Const((1.0,)))
        if not isinstance(colour, Const) and not thin:
            w.note(w.ctx.report.left_out(w.prim, "a texture of subsurface_color", "the inside is the same everywhere (E0702)"))
            colour = Const((1.0,))
        w.put("subsurface-color", colour, 0.8, False)
        radius = w.get("subsurface_radius", Const((1.0,)))
        rgb = radius.rgb() if isinstance(radius, Const) else (1.0, 1.0, 1.0)
        top = max(*rgb, 1e-9)
        if not thin:
            w.node.set("subsurface-radius", max(1e-9, top * w.number("subsurface_scale", 1.0) * metres), "m")
            w.put("subsurface-radius-scale", Const(tuple(clamped(x / top) for x in rgb)), None, False)
        w.fixed("subsurface-scatter-anisotropy", "subsurface_anisotropy", 0.0, -0.99, 0.99)


def standard_surface(w: SurfaceWriter) -> None:
    """Autodesk's standard surface, by the translation that MaterialX has for it."""
    w.node.word("openpbr")
    thin = bool(w.net.raw(w.shader, "thin_walled", False))
    w.share("base-weight", "base", 1.0)
    w.colour("base-color", "base_color", 0.8)
    w.share("base-diffuse-roughness", "diffuse_roughness", 0.0)
    w.share("base-metalness", "metalness", 0.0)
    w.put("specular-weight", w.get("specular"), 1.0, True, 1e9)
    w.colour("specular-color", "specular_color", 1.0)
    w.share("specular-roughness", "specular_roughness", 0.3, 0.2)
    w.share("specular-roughness-anisotropy", "specular_anisotropy", 0.0)
    turn = w.number("specular_rotation", 0.0)
    if turn:
        w.node.set("geometry-tangent", max(-1.0, min(1.0, as_float(turn))))
    w.fixed("specular-ior", "specular_IOR", 1.5, 0.2, 10.0)
    _inside_of_standard(w, thin)
    coat = w.get("coat")
    if coat is not None and coat != Const((0.0,)):
        w.put("coat-weight", coat, 0.0, True)
        w.colour("coat-color", "coat_color", 1.0)
        w.share("coat-roughness", "coat_roughness", 0.0, 0.1)
        w.share("coat-roughness-anisotropy", "coat_anisotropy", 0.0)
        w.node.set("coat-ior", min(10.0, max(0.2, w.number("coat_IOR", 1.5))))
        w.share("coat-darkening", "coat_affect_color", 1.0, 0.0)
        w.left_out({"coat_affect_roughness": (0.0, "the coat roughens what lies below as light does")})
    sheen = w.get("sheen")
    if sheen is not None and sheen != Const((0.0,)):
        w.put("fuzz-weight", sheen, 0.0, True)
        w.colour("fuzz-color", "sheen_color", 1.0)
        w.share("fuzz-roughness", "sheen_roughness", 0.5, 0.3)
        w.note(w.ctx.report.approximated(w.prim, "sheen", "another model of fibres"))
    film = w.number("thin_film_thickness", 0.0)
    if film > 0:
        w.node.set("thin-film-weight", 1).set("thin-film-thickness", as_float(film), "nm")
        w.node.set("thin-film-ior", min(10.0, max(0.2, w.number("thin_film_IOR", 1.5))))
    if thin:
        w.node.set("geometry-thin-walled", "on")
    w.normal("normal")
    w.normal("coat_normal", "geometry-coat-normal")
    opacity = w.get("opacity")
    if isinstance(opacity, Const) and len(set(opacity.rgb())) > 1:
        w.note(w.ctx.report.approximated(w.prim, "a coloured opacity", "its mean is taken"))
        opacity = Const((sum(opacity.rgb()) / 3,))
    w.opacity(opacity)
    strength = w.get("emission")
    if isinstance(strength, Const):
        w.emission(w.get("emission_color", Const((1.0,))), strength.number)
    elif strength is not None:
        colour = w.get("emission_color", Const((1.0,)))
        w.emission(strength if colour is None else Product(strength, colour), 1.0)


WRITERS: dict[str, Callable[[SurfaceWriter], None]] = {
    "UsdPreviewSurface": preview_surface,
    "open_pbr_surface": open_pbr,
    "standard_surface": standard_surface,
}
