"""Vertices that are split where values of corners differ: which corners of a point may share one.

All goes by blocks of corners that fit into the cache of a processor: arrays as long as the mesh cost more to make than to fill.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

BLOCK = 1 << 16  # corners
ROUNDS = 24  # in each of which every point gets one vertex more; what is left then is sorted


@dataclasses.dataclass
class Primvar:
    """Numbers of a mesh, brought to its points or to its corners."""

    values: Array  # rows
    index: Array | None  # of each point, or of each corner; None: rows are in order
    by_corner: bool

    def at_points(self, count: int) -> Array:
        return self.values[:count] if self.index is None else self.values.take(self.index, axis=0)

    def at_corners(self, corners: Array) -> Array:
        return self.values.take(corners if self.index is None else self.index.take(corners), axis=0)


def blocks(count: int) -> list[slice]:
    return [slice(a, min(count, a + BLOCK)) for a in range(0, count, BLOCK)]


def _bits(values: Array) -> Array:
    """Rows of single precision as bits: pairs as one number each."""
    rows = np.ascontiguousarray(values, np.float32)
    if rows.shape[1] == 2:
        pairs = rows.view(np.uint64)
        if pairs.flags.aligned:
            return pairs
    return rows.view(np.uint32)


class Comparison:
    """Whether corners have the same values as others, in all primvars of corners."""

    def __init__(self, primvars: list[Primvar]) -> None:
        self._sides = [(_bits(p.values), p.index) for p in primvars]

    def unlike(self, corners: slice | Array, mates: Array) -> Array | None:
        """A mask of the corners that differ from their mates; None where none does."""
        mask: Array | None = None
        for rows, index in self._sides:
            if index is None:
                mine = rows[corners] if isinstance(corners, slice) else rows.take(corners, axis=0, mode="clip")
                found = _any_column(mine != rows.take(mates, axis=0, mode="clip"))
            else:
                found = self._unlike_indices(rows, index[corners], index.take(mates, mode="clip"))
            if found is not None:
                mask = found if mask is None else mask | found
        return mask

    @staticmethod
    def _unlike_indices(rows: Array, a: Array, b: Array) -> Array | None:
        """Rows are looked at only where their numbers differ: two may be equal."""
        odd = np.flatnonzero(a != b)
        if not len(odd):
            return None
        differ = _any_column(rows.take(a[odd], axis=0) != rows.take(b[odd], axis=0))
        if differ is None:
            return None
        mask = np.zeros(len(a), bool)
        mask[odd] = differ
        return mask


def _any_column(differ: Array) -> Array | None:
    """A row's answer from those of its numbers; None where none is true."""
    if not np.logical_or.reduce(differ, axis=None):
        return None
    mask = differ[:, 0]
    for i in range(1, differ.shape[1]):
        mask = mask | differ[:, i]
    return mask


def corners_of_points(corners: Array, point_count: int) -> Array:
    """One corner of each point, the last one; -1 of points that no face has."""
    found = np.full(point_count, -1, np.int32 if len(corners) < 2**31 else np.int64)
    for block in blocks(len(corners)):
        found[corners[block]] = np.arange(block.start, block.stop, dtype=found.dtype)
    return found


def odd_corners(comparison: Comparison, corners: Array, mate_of_point: Array) -> Array:
    """The corners whose values are not those of their point's mate."""
    odd = []
    for block in blocks(len(corners)):
        mask = comparison.unlike(block, mate_of_point.take(corners[block], mode="clip"))
        if mask is not None:
            odd.append(np.flatnonzero(mask) + block.start)
    return np.concatenate(odd) if odd else np.zeros(0, np.int64)


def weld(corners: Array, point_count: int, primvars: list[Primvar]) -> tuple[Array, Array | None, Array]:
    """Splits points at whose corners primvars differ.

    Returns the vertex of each corner; the point of each vertex, None where vertices are points; and one corner of each vertex.
    Values are compared by their bits. A vertex is made for each point from one of its corners. Of the few corners that disagree
    with it one of each point makes a further vertex, and so on, until none is left.
    """
    mate = corners_of_points(corners, point_count)
    comparison = Comparison(primvars)
    odd = odd_corners(comparison, corners, mate)
    unused = int(mate.min()) < 0 if point_count else False
    if not unused and not len(odd):
        return corners, None, mate
    used = mate[mate >= 0] if unused else mate
    number = (np.cumsum(mate >= 0, dtype=np.int32) - 1).astype(np.int32) if unused else None
    vertex = corners.copy() if number is None else number.take(corners)
    if not len(odd):
        return vertex, corners.take(used), used
    further = _split(comparison, corners, mate.copy(), odd, vertex, len(used), primvars)
    used = np.concatenate([used, *further])
    return vertex, corners.take(used), used


def _split(comparison: Comparison, corners: Array, mate: Array, odd: Array, vertex: Array, total: int, primvars: list[Primvar]) -> list[Array]:
    """Gives vertices from number `total` on to the odd corners. Returns the corners that they are made of."""
    further = []
    number = np.zeros(len(mate), np.int32)
    for _ in range(ROUNDS):
        at = corners.take(odd)
        mate[at] = odd
        mates = mate.take(at)
        fresh = odd[mates == odd]
        number[corners.take(fresh)] = np.arange(total, total + len(fresh), dtype=np.int32)
        further.append(fresh)
        total += len(fresh)
        left = []
        for block in blocks(len(odd)):
            mask = comparison.unlike(odd[block], mates[block])
            some, of_points = odd[block], at[block]
            if mask is not None:
                left.append(some[mask])
                some, of_points = some[~mask], of_points[~mask]
            vertex[some] = number.take(of_points)
        if not left:
            return further
        odd = np.concatenate(left)
    columns = [corners[odd].astype(np.float64)[:, None]]
    columns += [p.at_corners(odd).astype(np.float64) for p in primvars]
    _, first, inverse = np.unique(np.hstack(columns) + 0.0, axis=0, return_index=True, return_inverse=True)
    vertex[odd] = total + inverse.reshape(-1)
    return [*further, odd[first]]
