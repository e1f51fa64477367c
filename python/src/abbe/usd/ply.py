"""Meshes, points and places as binary PLY, and cages of subdivision surfaces as OBJ with their tags."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .files import Buffer
from .weld import BLOCK, blocks

Floats = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int32]
Group = tuple[list[str], int, Callable[[slice], Floats]]  # names of properties, how many rows, and the rows of a block


def _header(count: int, columns: Iterable[tuple[str, str]], tail: Iterable[str]) -> bytes:
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    lines += [f"property {kind} {name}" for name, kind in columns]
    return "\n".join([*lines, *tail, "end_header\n"]).encode()


def _table(columns: Sequence[tuple[str, npt.NDArray[np.generic]]]) -> npt.NDArray[np.void]:
    """Columns of equal length as rows in the order of bytes that PLY has."""
    kinds = [(name, "<f8" if values.dtype == np.float64 else "<f4") for name, values in columns]
    rows = np.empty(len(columns[0][1]), dtype=kinds)
    for name, values in columns:
        rows[name] = values
    return rows


def rows_of(columns: Sequence[tuple[str, npt.NDArray[np.generic]]]) -> list[Buffer]:
    """Points with any properties: what `curves`, `points` and `instances` read."""
    kinds = [(name, "double" if values.dtype == np.float64 else "float") for name, values in columns]
    return [_header(len(columns[0][1]), kinds, []), _table(columns).tobytes()]


def strands(columns: Sequence[tuple[str, npt.NDArray[np.generic]]], counts: Ints) -> list[Buffer]:
    """Curves: points one strand after the other, and how many belong to each."""
    kinds = [(name, "float") for name, _ in columns]
    tail = [f"element strand {len(counts)}", "property uint count"]
    return [_header(len(columns[0][1]), kinds, tail), _table(columns).tobytes(), counts.astype("<u4").tobytes()]


def _even_faces(corners: Ints, size: int) -> Iterator[Buffer]:
    """Faces that have as many corners each, up to 255."""
    kind = np.dtype([("length", "u1"), ("corners", "<i4", (size,))])
    faces = np.ascontiguousarray(corners, "<i4").reshape(-1, size)
    rows = np.empty(min(len(faces), BLOCK), kind)
    rows["length"] = size
    for block in blocks(len(faces)):
        some = rows[: block.stop - block.start]
        some["corners"] = faces[block]
        yield some


def _face_bytes(counts: Ints, corners: Ints) -> tuple[str, npt.NDArray[np.uint8]]:
    """Faces of any lengths, and the type of these."""
    corners = np.ascontiguousarray(corners, "<i4")
    if len(counts) and int(counts.max()) > 255:
        out = np.empty(4 * (len(counts) + len(corners)), np.uint8)
        words = out.view("<i4")
        starts = np.cumsum(counts, dtype=np.int64) - counts + np.arange(len(counts))
        rest = np.ones(len(words), bool)
        rest[starts] = False
        words[starts], words[rest] = counts, corners
        return "uint", out
    starts = 4 * (np.cumsum(counts, dtype=np.int64) - counts) + np.arange(len(counts))
    out = np.empty(len(counts) + 4 * len(corners), np.uint8)
    rest = np.ones(len(out), bool)
    rest[starts] = False
    out[starts], out[rest] = counts, corners.view(np.uint8)
    return "uchar", out


def mesh(groups: Sequence[Group], counts: Ints, corners: Ints, size: int | None) -> Iterator[Buffer]:
    """A polygon mesh, some bytes at a time: x y z and other properties of its vertices, faces by the number and the indices of their
    corners.

    `size`: corners of each face, where all have as many.
    """
    names = [name for group in groups for name in group[0]]
    count = groups[0][1]
    even = size if size is not None and size <= 255 else None
    length, faces = ("uchar", None) if even is not None else _face_bytes(counts, corners)
    tail = [f"element face {len(counts)}", f"property list {length} int vertex_indices"]
    yield _header(count, [(name, "float") for name in names], tail)
    rows = np.empty((min(count, BLOCK), len(names)), "<f4")
    for block in blocks(count):
        some, at = rows[: block.stop - block.start], 0
        for own, _, values in groups:
            some[:, at : at + len(own)] = values(block)
            at += len(own)
        yield some
    if even is not None:
        yield from _even_faces(corners, even)
    elif faces is not None:
        yield faces


def _lines(prefix: str, rows: npt.NDArray[np.generic]) -> str:
    line = prefix + " %.9g" * rows.shape[1] + "\n"
    return str((line * len(rows)) % tuple(rows.reshape(-1).tolist()))


def cage(
    points: Floats,
    counts: Ints,
    corners: Ints,
    uvs: Floats | None,
    uv_corners: npt.NDArray[np.integer[Any]] | None,
    groups: Sequence[tuple[str, npt.NDArray[np.intp]]],
    tags: Sequence[str],
) -> list[Buffer]:
    """An OBJ file: points, texture coordinates by corners, faces in the order of `groups`, tags as they are."""
    out = [_lines("v", points)]
    if uvs is not None:
        out.append(_lines("vt", uvs))
    starts = np.cumsum(counts) - counts
    for name, faces in groups:
        if name:
            out.append(f"g {name}\n")
        for f in faces.tolist():
            at = slice(int(starts[f]), int(starts[f] + counts[f]))
            if uv_corners is None:
                out.append("f " + " ".join(str(v + 1) for v in corners[at].tolist()) + "\n")
            else:
                pairs = zip(corners[at].tolist(), uv_corners[at].tolist(), strict=True)
                out.append("f " + " ".join(f"{v + 1}/{t + 1}" for v, t in pairs) + "\n")
    out += [tag + "\n" for tag in tags]
    return ["".join(out).encode()]
