"""Copies: native instances and point instancers become objects and their places."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom

from . import ply
from .context import Context, Matrix, Place, is_finite, write_transform
from .scene_text import Node, number

Array = npt.NDArray[Any]

FEW = 16  # places that are nodes of their own; more are a file
MOST_MOVING = 4096  # instances of a point instancer that may move by themselves


def decompose(m: Matrix) -> tuple[Array, Array, Array] | None:
    """Place, quaternion x y z w and sizes of maps (n × 4 × 4, row vectors) that turn after they scale; else None."""
    a = m[:, :3, :3]
    size = np.linalg.norm(a, axis=2)
    if (size <= 0).any():
        return None
    r = a / size[:, :, None]
    mirrored = np.linalg.det(r) < 0
    size[mirrored, 0] *= -1
    r[mirrored, 0] *= -1
    if np.abs(r @ r.transpose(0, 2, 1) - np.eye(3)).max(initial=0) > 1e-5:
        return None
    return m[:, 3, :3], _quaternions(r.transpose(0, 2, 1)), size


def _quaternions(r: Array) -> Array:
    """Of rotations for column vectors, by the largest of the four components [Shepperd1978]."""
    trace = np.trace(r, axis1=1, axis2=2)
    squares = np.stack([r[:, 0, 0], r[:, 1, 1], r[:, 2, 2], trace], axis=1)
    largest = squares.argmax(axis=1)
    q = np.empty((len(r), 4))
    for i in range(3):
        at = largest == i
        j, k = (i + 1) % 3, (i + 2) % 3
        v = np.sqrt(np.maximum(0, 1 + r[at, i, i] - r[at, j, j] - r[at, k, k])) / 2
        q[at, i] = v
        q[at, j] = (r[at, j, i] + r[at, i, j]) / (4 * v)
        q[at, k] = (r[at, k, i] + r[at, i, k]) / (4 * v)
        q[at, 3] = (r[at, k, j] - r[at, j, k]) / (4 * v)
    at = largest == 3
    w = np.sqrt(1 + trace[at]) / 2
    q[at, 3] = w
    q[at, 0] = (r[at, 2, 1] - r[at, 1, 2]) / (4 * w)
    q[at, 1] = (r[at, 0, 2] - r[at, 2, 0]) / (4 * w)
    q[at, 2] = (r[at, 1, 0] - r[at, 0, 1]) / (4 * w)
    return q


def places_file(ctx: Context, stem: str, places: Array, turns: Array, sizes: Array) -> Any:
    columns: list[tuple[str, Array]] = [(n, places[:, i]) for i, n in enumerate("xyz")]
    if len(turns) and (turns != [0, 0, 0, 1]).any():
        columns += [(f"q{n}", turns[:, i]) for i, n in enumerate("xyzw")]
    if len(sizes) and (sizes != 1).any():
        columns += [(f"s{n}", sizes[:, i]) for i, n in enumerate("xyz")]
    return ctx.files.add(stem, "ply", ply.rows_of(columns))


def write_instances(ctx: Context, name: str, placed: list[tuple[Usd.Prim, Place]]) -> list[Node]:
    """Places of an object: nodes of their own if they are few or move, else a file."""
    still = [(prim, place) for prim, place in placed if len(ctx.keys(place)) == 1]
    nodes = []
    if len(still) > FEW:
        maps = np.array([place.at(ctx.times.first) for _, place in still])
        parts = decompose(maps) if is_finite(maps) else None
        if parts is not None:
            node = Node("instances").named(name)
            node.child("points").file(places_file(ctx, f"{name}.places", *parts))
            nodes.append(node)
            placed = [(prim, place) for prim, place in placed if len(ctx.keys(place)) > 1]
    for prim, place in placed:
        node = Node("instance").named(name)
        if write_transform(ctx, node, place, prim):
            nodes.append(node)
    return nodes


class BadInstancer(Exception):
    """What is wrong with a point instancer."""


def _array(attribute: Any, time: float, width: int, count: int, name: str) -> Array | None:
    values = attribute.Get(time)
    if values is None or not len(values):
        return None
    if len(values) != count:
        raise BadInstancer(f"{name} has {len(values)} values for {count} instances")
    array = np.asarray(values, np.float64).reshape(count, width)
    if not np.isfinite(array).all():
        raise BadInstancer(f"a value of {name} is not finite")
    return array


def read_instancer(ctx: Context, instancer: UsdGeom.PointInstancer) -> tuple[Array, Array]:
    """The prototype of each instance, and which ones are shown. Raises BadInstancer."""
    time = ctx.times.first
    indices = instancer.GetProtoIndicesAttr().Get(time)
    count = 0 if indices is None else len(indices)
    if count > ctx.options.max_instances:
        raise BadInstancer(f"{count} instances are more than {ctx.options.max_instances}: `--max-instances` allows more")
    targets = instancer.GetPrototypesRel().GetForwardedTargets()
    protos = np.asarray(indices if count else [], np.int64)
    if count and (int(protos.min()) < 0 or int(protos.max()) >= len(targets)):
        raise BadInstancer(f"protoIndices names prototype {int(protos.max())}, but there are {len(targets)}")
    mask = instancer.ComputeMaskAtTime(time)
    shown = np.asarray(mask, bool) if mask is not None and len(mask) == count else np.ones(count, bool)
    return protos, shown


def instancer_places(ctx: Context, instancer: UsdGeom.PointInstancer, count: int) -> tuple[Array, Array, Array]:
    """Places, quaternions and sizes when the shutter opens. Raises BadInstancer."""
    time = ctx.times.first
    places = _array(instancer.GetPositionsAttr(), time, 3, count, "positions")
    if places is None and count:
        raise BadInstancer(f"there are no positions for {count} instances")
    turns = _array(instancer.GetOrientationsfAttr(), time, 4, count, "orientationsf")
    if turns is None:
        turns = _array(instancer.GetOrientationsAttr(), time, 4, count, "orientations")
    sizes = _array(instancer.GetScalesAttr(), time, 3, count, "scales")
    if turns is None:
        turns = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    else:
        length = np.linalg.norm(turns, axis=1, keepdims=True)
        if (length == 0).any():
            raise BadInstancer(f"orientation {int(length.argmin())} is 0")
        turns = turns / length
    return places if places is not None else np.zeros((0, 3)), turns, sizes if sizes is not None else np.ones((count, 3))


def moves(ctx: Context, instancer: UsdGeom.PointInstancer) -> list[float]:
    """The keys at which instances stand elsewhere; one if they stand still."""
    samples: set[float] = set()
    for attribute in (instancer.GetPositionsAttr(), instancer.GetOrientationsAttr(), instancer.GetOrientationsfAttr(), instancer.GetScalesAttr()):
        own = attribute.GetTimeSamples()
        samples |= set(own) if len(own) > 1 else set()
    keys = ctx.times.of_samples(sorted(samples))
    velocities = instancer.GetVelocitiesAttr().HasAuthoredValue() or instancer.GetAngularVelocitiesAttr().HasAuthoredValue()
    if velocities and len(keys) == 1 and ctx.times.last > ctx.times.first:
        keys = [ctx.times.first, ctx.times.last]
    return keys


def moving_instances(ctx: Context, instancer: UsdGeom.PointInstancer, keys: list[float], shown: Array, names: list[str], protos: Array) -> list[Node]:
    """An instance for each, with its own keys. Raises BadInstancer."""
    base = Usd.TimeCode((ctx.times.first + ctx.times.last) / 2)
    at_keys = []
    for key in keys:
        maps = instancer.ComputeInstanceTransformsAtTime(
            Usd.TimeCode(key), base if not ctx.times.animated else Usd.TimeCode(key),
            UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask,
        )  # fmt: skip
        array = np.asarray(maps, np.float64).reshape(-1, 4, 4)
        if len(array) != len(protos) or not is_finite(array):
            raise BadInstancer("its instances change in number, or stand at no finite place, while the shutter is open")
        at_keys.append(array)
    nodes = []
    for i in np.flatnonzero(shown).tolist():
        if not names[int(protos[i])]:
            continue
        node = Node("instance").named(names[int(protos[i])])
        transform = node.child("transform")
        for key, maps in zip(keys, at_keys, strict=True):
            rows = maps[i].T.copy()
            rows[3] = (0, 0, 0, 1)
            transform.child("at", number(ctx.times.seconds(key)), "s").child("matrix").numbers(rows.reshape(-1))
        nodes.append(node)
    return nodes
