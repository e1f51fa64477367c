"""Files that a scene reads: those written beside it, and those that the stage names."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import itertools
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Union

import numpy as np

from .scene_text import FileRef

Buffer = Union[bytes, memoryview, "np.ndarray"]


@dataclasses.dataclass(frozen=True)
class Stream:
    """Bytes that are made when they are written, some at a time: those of a large mesh need not lie in memory."""

    nbytes: int
    blocks: Callable[[], Iterator[Buffer]]
    first: Callable[[int], Buffer]  # so many bytes from the start on, or more; fewer only where there are no more


Part = Union[bytes, memoryview, "np.ndarray", Stream]
_COMPARED = 8 << 20  # bytes; larger files are not compared with those that are there
_numbers = itertools.count()
_LIKE = 512  # bytes, by whose start files are told apart before they are made


def as_bytes(part: Buffer) -> bytes | memoryview:
    """What a part holds, without a copy where it lies in order."""
    return np.ascontiguousarray(part).reshape(-1).view(np.uint8).data if isinstance(part, np.ndarray) else part


def size_of(part: Part) -> int:
    return len(part) if isinstance(part, bytes) else part.nbytes


def pieces(parts: Iterable[Part]) -> Iterator[bytes | memoryview]:
    """All bytes in order. A piece holds until the next one is asked for."""
    for part in parts:
        for piece in part.blocks() if isinstance(part, Stream) else (part,):
            yield as_bytes(piece)


def start_of(parts: Iterable[Part]) -> bytes:
    """The first bytes, without making all of them."""
    found = b""
    for part in parts:
        found += as_bytes(part.first(_LIKE - len(found)) if isinstance(part, Stream) else part)
        if len(found) >= _LIKE:
            break
    return found[:_LIKE]


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


def write_atomically(path: Path, parts: Iterable[Part]) -> None:
    """Writes a file under another name and renames it, so that nobody ever reads half of it. Raises OSError."""
    descriptor, name = _new_file(path)
    try:
        with os.fdopen(descriptor, "wb", buffering=0) as stream:
            for piece in pieces(parts):
                _write_all(stream, piece)
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


class SideFiles:
    """Files in memory until the scene is written. Equal ones are one file."""

    def __init__(self) -> None:
        self.parts: dict[str, list[Part]] = {}
        self._alike: dict[tuple[str, int, bytes], list[str]] = {}  # files by extension, size and start
        self._by_content: dict[tuple[str, bytes], str] = {}  # of those that are alike
        self._stems: dict[str, int] = {}

    def add(self, stem: str, extension: str, parts: Sequence[Part]) -> FileRef:
        """A file named after `stem`, as far as file systems like it."""
        size = sum(size_of(part) for part in parts)
        if size > _COMPARED:
            name = self._free_name(stem, extension)
            self.parts[name] = list(parts)
            return FileRef(name, own=True)
        alike = self._alike.setdefault((extension, size, start_of(parts)), [])
        if not alike:
            name = self._free_name(stem, extension)
            self.parts[name] = list(parts)
            alike.append(name)
            return FileRef(name, own=True)
        if len(alike) == 1:
            self._make(alike[0], extension)
        content = (extension, b"".join(pieces(parts)))
        if content not in self._by_content:
            name = self._by_content[content] = self._free_name(stem, extension)
            self.parts[name] = [content[1]]
            alike.append(name)
        return FileRef(self._by_content[content], own=True)

    def _make(self, name: str, extension: str) -> None:
        """A file as its bytes, to compare others with it."""
        whole = self.content(name)
        self.parts[name] = [whole]
        self._by_content[(extension, whole)] = name

    def content(self, name: str) -> bytes:
        return b"".join(bytes(piece) for piece in pieces(self.parts[name]))

    def _free_name(self, stem: str, extension: str) -> str:
        plain = re.sub(r"[^A-Za-z0-9._-]+", "_", stem).strip("._") or "file"
        plain = plain[-80:]
        taken = self._stems.get(plain.lower(), 0)
        self._stems[plain.lower()] = taken + 1
        name = f"{plain}-{taken + 1}.{extension}" if taken else f"{plain}.{extension}"
        return name if name not in self.parts else self._free_name(stem + "_", extension)

    def write(self, folder: Path) -> None:
        """Writes all files into `folder`, which is made. Raises OSError."""
        if not self.parts:
            return
        folder.mkdir(parents=True, exist_ok=True)
        for name, parts in self.parts.items():
            write_atomically(folder / name, parts)
