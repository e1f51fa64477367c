"""A stage from its root to the nodes of a scene."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdRender, UsdShade, UsdSkel, UsdVol

from . import cameras, instancing, preview
from .context import Context, Place, empty_bounds, write_transform
from .lights import LIGHTS, Emission, convert_light, emission_colour, glow_of_mesh
from .materials import Glow, Look, Materials
from .mesh import convert_mesh
from .own import Prim
from .report import Fate
from .scene_text import Node
from .shapes import FORMULAS, convert_formula
from .strands import CURVES, convert_curves, convert_points
from .volumes import convert_volume

MAX_LEVELS = 32  # of objects in objects
SILENT = ("", "Xform", "Scope", "GeomSubset", "Material", "Shader", "NodeGraph", "SkelRoot", "Skeleton", "SkelAnimation",
          "BlendShape", "RenderSettings", "RenderProduct", "RenderVar", "Camera", "OpenVDBAsset", "Field3DAsset", "Model")  # fmt: skip
_PLACED = ("Mesh", "Xform")  # the most frequent types of what stands somewhere


@dataclasses.dataclass(slots=True)
class Visit:
    prim: Usd.Prim
    place: Place
    purpose: str
    loose: bool = False  # below a prototype, which need not be defined to be shown
    stated: Prim | None = None  # what `find` asked of it

    def asked(self) -> Prim:
        assert self.stated is not None
        return self.stated


@dataclasses.dataclass
class Found:
    """What stands below a root, before it is converted."""

    shapes: list[Visit] = dataclasses.field(default_factory=list)
    lights: list[Visit] = dataclasses.field(default_factory=list)
    volumes: list[Visit] = dataclasses.field(default_factory=list)
    instances: list[Visit] = dataclasses.field(default_factory=list)
    instancers: list[Visit] = dataclasses.field(default_factory=list)


class Converter:
    def __init__(self, ctx: Context) -> None:
        self.ctx = ctx
        self.materials = Materials(ctx)
        self.objects: list[Node] = []
        self._object_of: dict[tuple[str, ...], str] = {}
        self._bounds_of: dict[str, Any] = {}
        self._depth = 0
        self._cameras: dict[str, Place] = {}
        self._geometry_lights: dict[str, Usd.Prim] = {}

    def run(self) -> list[Node]:
        """All nodes of the scene, the header first."""
        ctx = self.ctx
        settings = cameras.read_settings(ctx)
        if ctx.options.purposes is not None:
            ctx.purposes = ctx.options.purposes
        camera = cameras.choose_camera(ctx, settings)
        cameras.set_times(ctx, camera, settings)
        self._bake_skins()
        self._find_geometry_lights()
        root = ctx.stage.GetPseudoRoot()
        content = self.content([Visit(child, ctx.root(), "default") for child in children_of(root)])
        header = Node("scene", "1").key("length", ctx.unit)
        if ctx.up == "z":
            header.key("up", "z")
        header.remark(f"Imported from {ctx.stage.GetRootLayer().GetDisplayName()}, an OpenUSD stage.")
        lights = [] if ctx.lit or ctx.emits else preview.preview_lights(ctx)
        if lights and ctx.had_lights:
            ctx.report.approximated(None, "a stage none of whose lights shines", "a neutral sky and a soft key light show it")
        views = cameras.write_cameras(ctx, settings, camera, self._cameras)
        if not any(node.name == "camera" for node in views):
            shown = preview.preview_camera(ctx)
            views = [shown[0], *(views or shown[1:])]
        render = [Node("render").set("fps", ctx.times.per_second)] if ctx.times.animated and ctx.times.per_second != 24 else []
        return [header, *views, *render, *lights, *self.materials.nodes, *self.objects, *content]

    def _bake_skins(self) -> None:
        """Skinned meshes become meshes with samples of points, in the session of the stage."""
        ctx = self.ctx
        roots = ctx.census.all(UsdSkel.Root)
        if not roots:
            return
        target = ctx.stage.GetEditTarget()
        ctx.stage.SetEditTarget(ctx.stage.GetSessionLayer())
        interval = Gf.Interval.GetFullInterval()  # samples before and behind the shutter count, too
        for root in roots:
            if not UsdSkel.BakeSkinning(UsdSkel.Root(root), interval):
                ctx.report.left_out(root, "its skins", "USD could not bake them: meshes stand as they are bound")
        ctx.stage.SetEditTarget(target)

    def _find_geometry_lights(self) -> None:
        for prim in self.ctx.census.all(UsdLux.GeometryLight):
            for target in UsdLux.GeometryLight(prim).GetGeometryRel().GetForwardedTargets():
                self._geometry_lights[str(target)] = prim

    def find(self, visits: list[Visit]) -> Found:
        """Goes through all that is shown. No recursion: stages may be deep."""
        found = Found()
        stack = list(reversed(visits))
        while stack:
            visit = stack.pop()
            prim = visit.prim
            visit.stated = stated = Prim(self.ctx.owned, prim)
            if not self._is_shown(visit):
                continue
            if "xformOpOrder" in stated.names and (stated.kind in _PLACED or prim.IsA(UsdGeom.Xformable)):
                visit.place = Place(visit.place, prim)
            if prim.IsInstance():
                found.instances.append(visit)
                continue
            if self._sort(visit, found) and stated.has_children:
                stack += [Visit(child, visit.place, visit.purpose, visit.loose) for child in reversed(children_of(prim, visit.loose))]
        return found

    def _is_shown(self, visit: Visit) -> bool:
        """Whether visibility and purpose show it; sets the purpose that is inherited."""
        prim, ctx, stated = visit.prim, self.ctx, visit.asked()
        if "purpose" not in stated.names and "visibility" not in stated.names:
            # Of a plain type, so that it is a mesh or nothing that purposes choose.
            if (stated.kind == "Mesh" or (stated.kind and prim.IsInstance())) and visit.purpose not in ctx.purposes:
                self._hide(prim)
                return False
            return True
        if not prim.IsA(UsdGeom.Imageable):
            return True
        imageable = UsdGeom.Imageable(prim)
        own = imageable.GetPurposeAttr()
        if own.HasAuthoredValue():
            visit.purpose = str(own.Get())
        hidden = imageable.GetVisibilityAttr().Get(ctx.times.first) == UsdGeom.Tokens.invisible
        if hidden and not prim.IsA(UsdGeom.Camera):
            self._hide(prim)
            return False
        is_leaf = prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.PointInstancer) or prim.IsInstance()
        if is_leaf and visit.purpose not in ctx.purposes:
            self._hide(prim)
            return False
        return True

    def _hide(self, prim: Usd.Prim) -> None:
        self.ctx.report.count(prim, Fate.HIDDEN)
        for below in Usd.PrimRange(prim):
            if below.IsA(UsdGeom.Gprim) and below != prim:
                self.ctx.report.count(below, Fate.HIDDEN)

    def _sort(self, visit: Visit, found: Found) -> bool:
        """Puts a prim where it belongs. True if its children are to be looked at."""
        prim, kind = visit.prim, visit.asked().kind
        if kind == "Mesh" or kind in FORMULAS or kind in CURVES or kind == "Points":
            found.shapes.append(visit)
        elif kind == "PointInstancer":
            found.instancers.append(visit)
            return False  # prototypes are below it
        elif prim.HasAPI(UsdLux.LightAPI) or kind in LIGHTS or kind == "PortalLight":
            if kind != "GeometryLight":
                found.lights.append(visit)
            else:
                self.ctx.report.count(prim, Fate.USED)
        elif prim.IsA(UsdVol.Volume):
            found.volumes.append(visit)
            return False
        elif prim.IsA(UsdGeom.Camera):
            self._cameras[str(prim.GetPath())] = visit.place
        elif prim.IsA(UsdGeom.Gprim):
            self.ctx.report.left_out(prim, f"a shape of type {kind}", "meshes, curves, points and simple shapes are read")
            self.ctx.report.count(prim, Fate.LEFT_OUT)
        elif kind not in SILENT and not prim.IsA(UsdShade.ConnectableAPI) and not prim.IsA(UsdRender.SettingsBase):
            self.ctx.report.left_out(prim, f"a prim of type {kind}", "it has no meaning here")
            self.ctx.report.count(prim, Fate.LEFT_OUT)
        elif kind in ("Xform", "Scope", ""):
            self.ctx.report.count(prim, Fate.CARRIED)
        return True

    def content(self, visits: list[Visit]) -> list[Node]:
        """The nodes of all that is found below some prims."""
        found = self.find(visits)
        nodes: list[Node] = []
        for visit in found.lights:
            self.ctx.report.count(visit.prim, Fate.CARRIED)
            nodes += convert_light(self.ctx, visit.prim, visit.place)
        nodes += self._shapes(found.shapes)
        bound = self.materials.bound([v.prim for v in found.volumes])
        for visit, material in zip(found.volumes, bound, strict=True):
            if self._depth:
                self.ctx.report.left_out(visit.prim, "a volume in a prototype", "volumes stand in the world alone")
                continue
            made = convert_volume(self.ctx, visit.prim, visit.place, material)
            if made:
                self.ctx.report.count(visit.prim, Fate.CARRIED)
            nodes += made
        nodes += self._instances(found.instances)
        for visit in found.instancers:
            nodes += self._instancer(visit)
        return nodes

    def _shapes(self, visits: list[Visit]) -> list[Node]:
        nodes: list[Node] = []
        bound = self.materials.bound([v.prim for v in visits])
        for visit, material in zip(visits, bound, strict=True):
            prim, stated = visit.prim, visit.asked()
            kind = stated.kind
            self.ctx.report.count_path(stated.path, kind, Fate.CARRIED)
            glow = self._glow(visit)
            look = glow or self.materials.look(stated, material, kind == "Mesh")
            if kind == "Mesh":
                made = convert_mesh(self.ctx, stated, visit.place, look, self._subset_look if glow is None else _always(glow))
            elif kind in FORMULAS:
                made = convert_formula(self.ctx, prim, visit.place, look)
            elif kind in CURVES:
                made = convert_curves(self.ctx, prim, visit.place, look)
            else:
                made = convert_points(self.ctx, prim, visit.place, look)
            if not made:
                self.ctx.report.count(prim, Fate.LEFT_OUT)
            nodes += made
        return nodes

    def _subset_look(self, subset: UsdGeom.Subset) -> Look:
        prim = subset.GetPrim()
        material = self.materials.bound([prim])[0]
        if material is None:
            material = self.materials.bound([prim.GetParent()])[0]
        return self.materials.look(Prim(self.ctx.owned, prim if material else prim.GetParent()), material, True)

    def _glow(self, visit: Visit) -> Look | None:
        """The look of a mesh that is a light."""
        prim = visit.prim
        light = self._geometry_lights.get(visit.asked().path)
        if light is None and not visit.asked().is_plain and prim.HasAPI(UsdLux.LightAPI):
            light = prim
        if light is None:
            return None
        if prim.GetTypeName() != "Mesh":
            self.ctx.report.left_out(light, "a light of a shape that is no mesh", "meshes are lights")
            return None
        emission = glow_of_mesh(self.ctx, prim, light, visit.place)
        return None if emission is None else self.materials.glowing(str(light.GetPath()), _glow_words(emission))

    def _instances(self, visits: list[Visit]) -> list[Node]:
        """Native instances, by the object that they show."""
        bound = self.materials.bound([v.prim for v in visits])
        groups: dict[str, list[tuple[Usd.Prim, Place]]] = {}
        for visit, material in zip(visits, bound, strict=True):
            self.ctx.report.count(visit.prim, Fate.CARRIED)
            key = (str(visit.prim.GetPrototype().GetPath()), str(material.GetPath()) if material else "", visit.purpose, *self._inherited(visit.prim))
            name = self._object(key, visit.prim, [Visit(c, Place(None), visit.purpose, visit.loose) for c in children_of(visit.prim, visit.loose)])
            if name:
                self.ctx.grow(self._bounds_of[name], visit.place)
                groups.setdefault(name, []).append((visit.prim, visit.place))
        nodes: list[Node] = []
        for name, placed in groups.items():
            nodes += instancing.write_instances(self.ctx, name, placed)
        return nodes

    def _inherited(self, prim: Usd.Prim) -> tuple[str, ...]:
        """What an instance hands down to what it shows, besides its material."""
        api = UsdGeom.PrimvarsAPI(prim)
        found = (api.FindPrimvarWithInheritance(f"primvars:{n}") for n in ("displayColor", "displayOpacity"))
        return tuple(str(p.Get(self.ctx.times.first)) if p and p.HasValue() else "" for p in found)

    def _object(self, key: tuple[str, ...], prim: Usd.Prim, visits: list[Visit]) -> str:
        """The name of the object for a prototype, made when it is first asked for. Empty if nothing is in it."""
        if key in self._object_of:
            return self._object_of[key]
        if self._depth >= MAX_LEVELS:
            self.ctx.report.error("E0802", prim, "instances that are too deep", f"objects hold each other {MAX_LEVELS} levels deep")
            return ""
        self._object_of[key] = ""  # one that holds itself is empty there
        self._depth += 1
        bounds, self.ctx.bounds = self.ctx.bounds, empty_bounds()
        content = self.content(visits)
        inner, self.ctx.bounds = self.ctx.bounds, bounds
        self._depth -= 1
        if content:
            name = self.ctx.name("object", str(prim.GetPath()))
            node = Node("object").named(name)
            node.children = content
            self.objects.append(node)
            self._object_of[key] = name
            self._bounds_of[name] = inner if np.isfinite(inner).all() else np.zeros((1, 3))
        return self._object_of[key]

    def _instancer(self, visit: Visit) -> list[Node]:
        prim, ctx = visit.prim, self.ctx
        instancer = UsdGeom.PointInstancer(prim)
        try:
            protos, shown = instancing.read_instancer(ctx, instancer)
            count = len(protos)
            targets = instancer.GetPrototypesRel().GetForwardedTargets()
            names = [self._prototype(visit, target) for target in targets]
            keys = instancing.moves(ctx, instancer)
            if len(keys) > 1 and count > instancing.MOST_MOVING:
                ctx.report.approximated(
                    prim, "instances that move by themselves", f"they stand still: {count} are more than {instancing.MOST_MOVING}"
                )
                keys = keys[:1]
            if len(keys) > 1:
                nodes = self._moving(visit, instancer, keys, shown, names, protos)
            else:
                nodes = self._standing(visit, instancer, shown, names, protos)
        except instancing.BadInstancer as fault:
            ctx.report.error("E0802", prim, "the point instancer makes no sense", str(fault))
            return []
        ctx.report.count(prim, Fate.CARRIED if nodes else Fate.LEFT_OUT)
        if not nodes:
            ctx.report.left_out(prim, "a point instancer that shows nothing", "it has no instances, or its prototypes nothing to show")
        return nodes

    def _prototype(self, visit: Visit, target: Any) -> str:
        prim = self.ctx.stage.GetPrimAtPath(target)
        if not prim.IsValid():
            self.ctx.report.error("E0802", visit.prim, f"the prototype {target} is not there", "look at `prototypes`")
            return ""
        bound = self.materials.bound([prim])[0]
        key = ("prototype", str(target), str(bound.GetPath()) if bound else "", visit.purpose, *self._inherited(prim))
        return self._object(key, prim, [Visit(prim, Place(None), visit.purpose, True)])

    def _standing(self, visit: Visit, instancer: UsdGeom.PointInstancer, shown: Any, names: list[str], protos: Any) -> list[Node]:
        """Instances at rest: a file of places for each prototype."""
        ctx = self.ctx
        places, turns, sizes = instancing.instancer_places(ctx, instancer, len(protos))
        nodes = []
        flat = shown & (sizes == 0).any(axis=1)
        if flat.any():
            ctx.report.left_out(visit.prim, "instances of no size", "a scale is 0")
            shown = shown & ~flat
        for i, name in enumerate(names):
            mine = np.flatnonzero(shown & (protos == i))
            if not name or not len(mine):
                continue
            node = Node("instances").named(name)
            stem = f"{visit.prim.GetPath()}.{i}"
            node.child("points").file(instancing.places_file(ctx, stem, places[mine], turns[mine], sizes[mine]))
            if write_transform(ctx, node, visit.place, visit.prim):
                nodes.append(node)
            reach = np.abs(self._bounds_of[name]).max() * np.sqrt(3) * np.abs(sizes[mine]).max()
            ctx.grow(np.array([places[mine].min(axis=0) - reach, places[mine].max(axis=0) + reach]), visit.place)
        return nodes

    def _moving(self, visit: Visit, instancer: UsdGeom.PointInstancer, keys: list[float], shown: Any, names: list[str], protos: Any) -> list[Node]:
        nodes = instancing.moving_instances(self.ctx, instancer, keys, shown, names, protos)
        if not nodes:
            return []
        group = Node("group").named(self.ctx.name("group", str(visit.prim.GetPath())))
        if not write_transform(self.ctx, group, visit.place, visit.prim):
            return []
        group.children += nodes
        return [group]


def _always(look: Look) -> Callable[[UsdGeom.Subset], Look]:
    return lambda subset: look


def children_of(prim: Usd.Prim, loose: bool = False) -> list[Usd.Prim]:
    """What is below a prim, instances included. Prototypes may stand below an `over` or a class."""
    predicate = Usd.PrimIsActive & Usd.PrimIsLoaded if loose else Usd.PrimDefaultPredicate
    return list(prim.GetFilteredChildren(Usd.TraverseInstanceProxies(predicate)))


def _glow_words(e: Emission) -> Glow:
    material = Node("material")
    if e.colour:
        emission_colour(material, e)
    words = tuple(str(v) for v in material.children[0].values) if material.children else ()
    return Glow(float(f"{e.nits:.12g}"), words)
