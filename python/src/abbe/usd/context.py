"""What all converters share: options, the stage, times, names, files and the report."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Gf, Usd, UsdGeom

try:
    from pxr import Ts
except ImportError:  # before OpenUSD 25.05, which has no splines
    Ts = None

from .files import SideFiles
from .own import Census, Owned
from .report import Report
from .scene_text import Node, number

NIT_PER_ONE = 72983.0  # nits that show as 1 without an exposure (docs/conventions.md)
UNITS = {1e-9: "nm", 1e-6: "um", 1e-3: "mm", 1e-2: "cm", 1.0: "m", 1e3: "km", 0.0254: "in", 0.3048: "ft"}
SHORT = 1 << 14  # points that fit into the cache
MAX_KEYS = 4096  # of one motion
CURVED = 16  # straight pieces of a span of a spline
STEP = 1e-3  # of a time code, in which something jumps that is held before

_CORNERS = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])  # of a box: which end of each axis

Matrix = npt.NDArray[np.float64]  # 4 × 4, of row vectors as USD has them
_IDENTITY: Matrix = np.eye(4)
_IDENTITY.flags.writeable = False
_STILL: list[list[float]] = _IDENTITY.tolist()
_RESET = "!resetXformStack!"
_ALONE = ("xformOp:translate", "xformOp:transform")
_EARLIEST = Usd.TimeCode.EarliestTime()


@dataclasses.dataclass(frozen=True)
class Options:
    """What is wanted of a stage. Times are time codes of the stage."""

    camera: str | None = None
    frame: float | None = None
    frames: tuple[float, float] | None = None  # first and last, for an animation
    purposes: tuple[str, ...] | None = None  # None: those of the render settings, else default and render
    variants: tuple[tuple[str, str, str], ...] = ()  # path of a prim or empty for the default prim, set, choice
    max_instances: int = 100_000_000  # of one point instancer


@dataclasses.dataclass
class Times:
    """The moments that count, in time codes."""

    first: float = 0.0  # when the shutter first opens
    last: float = 0.0  # when it last closes
    open: float = 0.0  # relative to a frame
    close: float = 0.0
    per_second: float = 24.0
    animated: bool = False  # a range of frames

    def seconds(self, code: float) -> float:
        return code / self.per_second

    def of_samples(self, samples: Sequence[float]) -> list[float]:
        """The keys of something with these samples: both ends and all samples between; one if it stands still."""
        if self.last <= self.first or len(samples) < 2:
            return [self.first]
        between = [t for t in samples if self.first < t < self.last]
        if not between and (samples[-1] <= self.first or samples[0] >= self.last):
            return [self.first]
        return [self.first, *between, self.last]


def as_float(x: float) -> float:
    """A number that is stored in single precision, as the shortest double that says the same."""
    return float(str(np.float32(x)))


def matrix_of(m: Gf.Matrix4d) -> Matrix:
    return np.array(m, dtype=np.float64)


def _alone(operation: Usd.Attribute) -> Matrix | None:
    """The map of the only operation of a prim, one that moves it or is a matrix; None where that takes more than a look.

    Most prims have no more, and USD takes twice as long to put one operation together as to state it.
    """
    if operation.ValueMightBeTimeVarying():
        return None
    value = operation.Get()
    if isinstance(value, Gf.Matrix4d):
        return matrix_of(value)
    if not isinstance(value, (Gf.Vec3d, Gf.Vec3f)):
        return None
    still = _IDENTITY.copy()
    still[3, :3] = value
    return still


class Place:
    """Where a prim stands: its own operations and those of what holds it, at any time."""

    __slots__ = ("_cache", "_fixed", "_parent", "_xformable", "samples")

    def __init__(self, parent: Place | None, prim: Usd.Prim | None = None, fixed: Matrix | None = None) -> None:
        """`prim` is one that can be placed."""
        self._parent = parent
        self._xformable = None
        self._fixed = _IDENTITY if fixed is None else fixed
        self._cache: dict[float, Matrix] = {}
        self.samples: list[float] = parent.samples if parent else []
        if prim is None:
            return
        order = prim.GetAttribute("xformOpOrder").Get()
        if not order:
            return
        if len(order) == 1 and order[0] in _ALONE and (fixed := _alone(prim.GetAttribute(order[0]))) is not None:
            self._fixed = fixed
            return
        xformable = UsdGeom.Xformable(prim)
        if _RESET in order:
            while self._parent is not None and self._parent._parent is not None:
                self._parent = self._parent._parent
            self.samples = []
        own = sample_times(xformable) if xformable.TransformMightBeTimeVarying() else []
        if len(own) > 1:
            self.samples = sorted({*self.samples, *own})
            self._xformable = xformable
        else:
            self._fixed = matrix_of(xformable.GetLocalTransformation(_EARLIEST))

    def at(self, time: float) -> Matrix:
        key = time if self.samples else 0.0
        if key not in self._cache:
            local = self._fixed if self._xformable is None else matrix_of(self._xformable.GetLocalTransformation(time))
            self._cache[key] = local if self._parent is None else local @ self._parent.at(time)
        return self._cache[key]


def spline_times(attribute: Any) -> list[float]:
    """Times between which an attribute with a spline is nearly straight. A step is one over a thousandth of a frame."""
    if not hasattr(attribute, "HasSpline") or not attribute.HasSpline():
        return []
    knots = attribute.GetSpline().GetKnots()
    times = sorted(float(time) for time in knots)
    found = times[-1:]
    for a, b in itertools.pairwise(times):
        kind = knots[a].GetNextInterpolation()
        if kind == Ts.InterpHeld:
            found += [a, max(a, b - STEP)]
        else:
            pieces = 1 if kind == Ts.InterpLinear else CURVED
            found += [a + (b - a) * i / pieces for i in range(pieces)]
    return found


def sample_times(xformable: Any) -> list[float]:
    """Of the operations of a prim: those of samples, and those of splines."""
    times = set(xformable.GetTimeSamples())
    for operation in xformable.GetOrderedXformOps():
        times.update(spline_times(operation.GetAttr()))
    return sorted(times)


class Context:
    """A conversion on its way."""

    def __init__(self, stage: Usd.Stage, options: Options, report: Report) -> None:
        self.stage = stage
        self.options = options
        self.report = report
        self.files = SideFiles()
        self.times = Times()
        self.purposes: tuple[str, ...] = ("default", "render")
        self.binding_purposes: tuple[str, ...] = ("full", "")
        self.up = "z" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else "y"
        self.metres = float(UsdGeom.GetStageMetersPerUnit(stage))  # in a unit of the stage
        self.unit, self.scale = "m", 1.0  # of the scene; stage lengths times scale are in it
        self._choose_unit()
        self.had_lights = False  # the stage, whatever became of them
        self.lit = False  # the scene, by a light
        self.emits = False
        self.owned = Owned(stage)
        self.census = Census(stage)
        self._bounds = empty_bounds()
        self._grown: list[tuple[npt.NDArray[Any], Matrix]] = []  # points, and where they stand, that the bounds have not yet
        self._names: dict[str, set[str]] = {}

    def _choose_unit(self) -> None:
        if not (math.isfinite(self.metres) and 1e-12 <= self.metres <= 1e12):
            self.report.error("E0802", None, f"metersPerUnit is {self.metres}", "it is the length of a unit in metres, above 0")
            self.metres = 1.0
        for metres, unit in UNITS.items():
            if abs(self.metres / metres - 1) < 1e-6:
                self.unit, self.metres = unit, metres
                return
        self.scale = self.metres

    @property
    def metres_per_scene_unit(self) -> float:
        return self.metres / self.scale

    def root(self) -> Place:
        return Place(None, fixed=np.diag([self.scale, self.scale, self.scale, 1.0]))

    def name(self, kind: str, path: str) -> str:
        """A name for a definition, after the path of a prim."""
        stem = path.strip("/") or kind
        taken = self._names.setdefault(kind, set())
        name, n = stem, 1
        while name in taken:
            n += 1
            name = f"{stem}~{n}"
        taken.add(name)
        return name

    def grow(self, points: npt.NDArray[Any], place: Place) -> None:
        """Counts points into the bounds of the scene, for a camera that shows all of it."""
        if len(points):
            self._grown.append((points, place.at(self.times.first)))

    @property
    def bounds(self) -> Matrix:
        """The least and the greatest corner of what was counted."""
        if self._grown:
            ends = _ends([points for points, _ in self._grown])
            corners = np.ones((len(ends), 8, 4))
            corners[:, :, :3] = ends[:, _CORNERS, (0, 1, 2)]
            world = (corners @ np.stack([m for _, m in self._grown]))[:, :, :3].reshape(-1, 3)
            self._grown = []
            np.minimum(self._bounds[0], world.min(axis=0), out=self._bounds[0])
            np.maximum(self._bounds[1], world.max(axis=0), out=self._bounds[1])
        return self._bounds

    @bounds.setter
    def bounds(self, value: Matrix) -> None:
        self._bounds, self._grown = value, []

    def keys(self, place: Place) -> list[float]:
        return self.times.of_samples(place.samples)


def empty_bounds() -> Matrix:
    return np.array([[math.inf] * 3, [-math.inf] * 3])


def _ends_of_blocks(points: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    blocks = [np.ascontiguousarray(points[a : a + SHORT].T) for a in range(0, len(points), SHORT)]
    low, high = (np.stack([f.reduce(rows, axis=1) for rows in blocks]) for f in (np.minimum, np.maximum))
    return low.min(axis=0), high.max(axis=0)


def _ends(clouds: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """The least and the greatest corner of each cloud of points: of small ones together, of large ones by blocks that fit into the cache.

    Coordinates are brought into rows of their own first, along which reductions are several times as fast.
    """
    ends = np.empty((len(clouds), 2, 3))
    batch: list[int] = []

    def finish() -> None:
        if not batch:
            return
        rows = np.ascontiguousarray(np.concatenate([clouds[i] for i in batch]).T)
        starts = np.cumsum([0, *(len(clouds[i]) for i in batch[:-1])])
        ends[batch, 0] = np.minimum.reduceat(rows, starts, axis=1).T
        ends[batch, 1] = np.maximum.reduceat(rows, starts, axis=1).T
        batch.clear()

    size = 0
    for i, points in enumerate(clouds):
        if len(points) > SHORT:
            ends[i] = _ends_of_blocks(points)
            continue
        batch.append(i)
        size += len(points)
        if size > SHORT:
            finish()
            size = 0
    finish()
    return ends


def is_finite(m: Matrix) -> bool:
    return bool(np.isfinite(m).all())


def is_similarity(m: Matrix, tolerance: float = 1e-4) -> bool:
    """Whether a map only turns, moves, mirrors, and scales evenly."""
    a = m[:3, :3] @ m[:3, :3].T
    size = a.trace() / 3
    return size > 0 and bool((np.abs(a - np.eye(3) * size) <= tolerance * size).all())


def _steps(node: Node, rows: list[list[float]]) -> None:
    (a, b, c, _), (d, e, f, _), (g, h, i, _), (x, y, z, _) = rows
    if b or c or d or f or g or h:
        node.child("matrix").numbers((a, d, g, x, b, e, h, y, c, f, i, z, 0, 0, 0, 1))
        return
    still = a == e == i == 1
    if not still:
        node.child("scale").numbers((a,) if a == e == i else (a, e, i))
    if x or y or z or still:
        node.child("translate").numbers((x + 0.0, y + 0.0, z + 0.0))


def _determinant(rows: list[list[float]]) -> float:
    """Of the linear part of a map."""
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = rows[:3]
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _refined(place: Place, keys: list[float]) -> Iterator[float]:
    """More keys where something turns far between two: maps are interpolated by the shorter way."""
    for a, b in itertools.pairwise(keys):
        yield a
        size = max(1e-30, float(np.linalg.norm(place.at(a)[:3, :3])))
        turn = float(np.linalg.norm(place.at(a)[:3, :3] - place.at((a + b) / 2)[:3, :3])) / size
        pieces = min(64, math.ceil(turn / 0.1))  # some 15 degrees each
        for i in range(1, pieces):
            yield a + (b - a) * i / pieces
    yield keys[-1]


def write_transform(ctx: Context, node: Node, place: Place, prim: Any, before: Matrix | None = None) -> bool:
    """Writes where something stands, with keys if it moves. False, with a remark, where that cannot be."""
    maps: list[list[list[float]]] = []
    keys = ctx.keys(place)
    if len(keys) > 1:
        keys = list(_refined(place, keys))[:MAX_KEYS]
    for time in keys:
        m: list[list[float]] = (place.at(time) if before is None else before @ place.at(time)).tolist()
        if not all(map(math.isfinite, itertools.chain.from_iterable(m))):
            ctx.report.error("E0802", prim, "its transform is not finite", "look at its xformOps")
            return False
        if abs(_determinant(m)) < 1e-30:
            ctx.report.left_out(prim, "what has no extent", "its transform has a determinant of 0")
            return False
        maps.append(m)
    if all(m == maps[0] for m in maps):
        if maps[0] != _STILL:
            _steps(node.child("transform"), maps[0])
        return True
    transform = node.child("transform")
    for time, m in zip(keys, maps, strict=True):
        key = transform.child("at", number(ctx.times.seconds(time)), "s")
        _steps(key, m)
    return True
