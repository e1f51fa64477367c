"""Files that a scene reads: those written beside it, and those that the stage names."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import itertools
import os
import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Union

import numpy as np

from .scene_text import FileRef

Buffer = Union[bytes, memoryview, "np.ndarray"]


@dataclasses.dataclass(frozen=True)
class Made:
    """A file that is made when it is written, some bytes at a time: a large one need not lie in memory."""

    size: int  # bytes, about
    like: Hashable  # what files have in common whose bytes are the same; told without making them
    pieces: Callable[[], Iterator[Buffer]]  # all bytes in order; a piece holds until the next one is asked for


_COMPARED = 8 << 20  # bytes; larger files are not compared with those that are there
_numbers = itertools.count()
_UNWANTED = re.compile(r"[^A-Za-z0-9._-]+")
_START = 512  # bytes that tell files apart


def as_bytes(part: Buffer) -> bytes | memoryview:
    """What a part holds, without a copy where it lies in order."""
    return np.ascontiguousarray(part).reshape(-1).view(np.uint8).data if isinstance(part, np.ndarray) else part


def whole(pieces: Iterable[Buffer]) -> bytes:
    return b"".join(bytes(as_bytes(piece)) for piece in pieces)  # copies, as the next piece may take the place of the last


def at_hand(parts: Sequence[Buffer]) -> Made:
    """A file of bytes that are there."""
    size = sum(len(part) if isinstance(part, bytes) else part.nbytes for part in parts)
    start = b""
    for part in parts:
        start += as_bytes(part)[: _START - len(start)]
        if len(start) >= _START:
            break
    return Made(size, (size, start), lambda: iter(parts))


def _new_file(path: Path) -> tuple[int, str]:
    """Opens a file that was not there, beside a path and with the rights that new files have."""
    while True:
        name = os.path.join(path.parent, f".{path.name[:40]}.{os.getpid()}-{next(_numbers)}.tmp")
        with contextlib.suppress(FileExistsError):  # of an earlier process that was killed
            return os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666), name


def _write_all(stream: io.RawIOBase | io.FileIO, piece: bytes | memoryview) -> None:
    rest = memoryview(piece)
    while len(rest):
        rest = rest[stream.write(rest) or 0 :]


def write_atomically(path: Path, parts: Iterable[Buffer]) -> None:
    """Writes a file under another name and renames it, so that nobody ever reads half of it. Raises OSError."""
    descriptor, name = _new_file(path)
    try:
        with os.fdopen(descriptor, "wb", buffering=0) as stream:
            for part in parts:
                _write_all(stream, as_bytes(part))
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


class SideFiles:
    """Files that are kept until the scene is written. Equal ones are one file."""

    def __init__(self) -> None:
        self.made: dict[str, Made] = {}
        self._alike: dict[tuple[str, Hashable], list[str]] = {}  # files by extension and what they are like
        self._by_content: dict[tuple[str, bytes], str] = {}  # of those that are alike
        self._stems: dict[str, int] = {}

    def add(self, stem: str, extension: str, content: Sequence[Buffer] | Made) -> FileRef:
        """A file named after `stem`, as far as file systems like it."""
        made = content if isinstance(content, Made) else at_hand(content)
        alike = self._alike.setdefault((extension, made.like), []) if made.size <= _COMPARED else []
        if alike:
            return self._add_alike(stem, extension, made, alike)
        name = self._free_name(stem, extension)
        self.made[name] = made
        alike.append(name)
        return FileRef(name, own=True)

    def _add_alike(self, stem: str, extension: str, made: Made, alike: list[str]) -> FileRef:
        """A file that may have the bytes of one that is there."""
        if len(alike) == 1:
            first = self.content(alike[0])
            self.made[alike[0]] = at_hand([first])
            self._by_content[(extension, first)] = alike[0]
        content = (extension, whole(made.pieces()))
        if content not in self._by_content:
            name = self._by_content[content] = self._free_name(stem, extension)
            self.made[name] = at_hand([content[1]])
            alike.append(name)
        return FileRef(self._by_content[content], own=True)

    def content(self, name: str) -> bytes:
        return whole(self.made[name].pieces())

    def _free_name(self, stem: str, extension: str) -> str:
        plain = _UNWANTED.sub("_", stem).strip("._") or "file"
        plain = plain[-80:]
        taken = self._stems.get(plain.lower(), 0)
        self._stems[plain.lower()] = taken + 1
        name = f"{plain}-{taken + 1}.{extension}" if taken else f"{plain}.{extension}"
        return name if name not in self.made else self._free_name(stem + "_", extension)

    def write(self, folder: Path) -> None:
        """Writes all files into `folder`, which is made. Raises OSError."""
        if not self.made:
            return
        folder.mkdir(parents=True, exist_ok=True)
        for name, made in self.made.items():
            write_atomically(folder / name, made.pieces())
