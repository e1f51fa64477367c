"""Python's values as text of the scene language. Whatever a text holds, it comes out as one word or one quoted text: nothing of it can
end a line or a block."""

from __future__ import annotations

import math
import os
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from abbe._schema import TYPES, Field, fields, find_field, find_type, language_name

_BARE = re.compile(r"[A-Za-z_][A-Za-z0-9_.:-]*\Z")
_NUMBER = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?\Z")
_UNIT = re.compile(r"[%µ°A-Za-z_][%µ°A-Za-z0-9_.:/^-]*\Z")
_PARAMETER = re.compile(r"\$[A-Za-z_][A-Za-z0-9_:-]*\Z")
_RESERVED = frozenset(("true", "false", "null", "inf", "-inf", "nan"))
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


class Node:
    """A definition in the place of a value: ``material=abbe.node("dielectric", ior="glass BK7")``; also a name with keys,
    ``abbe.node("gold", keys={"group": "horns"})``."""

    def __init__(self, type: str, *arguments: Any, keys: Mapping[str, Any] | None = None, **properties: Any) -> None:
        self.type = type
        self.arguments = arguments
        self.keys = dict(keys or {})
        self.properties = properties

    def __repr__(self) -> str:
        parts = [repr(self.type), *map(repr, self.arguments), *(f"{k}={v!r}" for k, v in self.properties.items())]
        return f"abbe.node({', '.join(parts)})"


def node(type: str, *arguments: Any, keys: Mapping[str, Any] | None = None, **properties: Any) -> Node:
    """A definition in the place of a value: ``material=abbe.node("dielectric", ior="glass BK7")``."""
    return Node(type, *arguments, keys=keys, **properties)


class Path:
    """A file of the scene, whose name is written relative to where the text goes."""

    def __init__(self, path: str) -> None:
        self.path = os.path.abspath(path)


class MemoryFile:
    """A file in memory: arrays that have a name while somebody keeps `handle`. In a text that others read they have no place."""

    def __init__(self, handle: Any, what: str) -> None:
        self.handle = handle
        self.what = what


class ImageArray:
    """What `abbe.image()` returns: the picture of a texture, or a texture where one may stand."""

    def __init__(self, file: MemoryFile, space: str | None, properties: Mapping[str, Any]) -> None:
        self.file = file
        self.space = space
        self.properties = dict(properties)

    def tokens(self) -> list[Token]:
        return [self.file, *([f"space={name_word(self.space)}"] if self.space is not None else [])]


Token = str | Path | MemoryFile


class Line:
    """A node of the language: words and a block."""

    def __init__(self, name: str, tokens: Iterable[Token] = (), block: list[Line] | None = None) -> None:
        self.tokens: list[Token] = [name, *tokens]
        self.block = block

    def folders(self) -> set[str]:
        """Those of the files that are named in it."""
        own = {os.path.dirname(token.path) for token in self.tokens if isinstance(token, Path)}
        return own.union(*(line.folders() for line in self.block or ()))

    def write(self, out: list[str], folder: str, indent: int, memory: bool) -> None:
        words = [_word(token, folder, memory) for token in self.tokens]
        head = "    " * indent + " ".join(words)
        if self.block is None:
            out.append(head)
            return
        out.append(head + " {")
        for line in self.block:
            line.write(out, folder, indent + 1, memory)
        out.append("    " * indent + "}")


def _word(token: Token, folder: str, memory: bool) -> str:
    if isinstance(token, str):
        return token
    if isinstance(token, Path):
        return quoted(_relative(token.path, folder))
    if memory:
        return quoted(str(token.handle.name))
    raise ValueError(f"{token.what} has no place in a text: save it as a PNG or an EXR, and name that")


def _relative(path: str, folder: str) -> str:
    inside = os.path.commonpath([path, folder]) == folder
    return os.path.relpath(path, folder) if inside else path


def quoted(text: str) -> str:
    """A quoted text of KDL. Characters that a text may not hold as they are become escapes."""
    out = []
    for c in text:
        if c in _ESCAPES:
            out.append(_ESCAPES[c])
        elif unicodedata.category(c) == "Cs":
            raise ValueError("a text holds half of a surrogate pair")
        elif unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp"):
            out.append(f"\\u{{{ord(c):x}}}")
        else:
            out.append(c)
    return '"' + "".join(out) + '"'


def name_word(name: str) -> str:
    """A name, in quotes where it needs them."""
    if not isinstance(name, str):
        raise TypeError(f"a name is a str, not {name!r}")
    if not name:
        raise ValueError("a name is empty")
    return name if _BARE.match(name) and name not in _RESERVED else quoted(name)


def number_word(value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, int) or hasattr(value, "__index__"):
        return str(value.__index__())
    x = float(value)
    if not math.isfinite(x):
        raise ValueError(f"{value!r} is no finite number")
    return repr(x)


def _is_number(value: Any) -> bool:
    return isinstance(value, (bool, int, float)) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0)


def _is_array(value: Any) -> bool:
    return hasattr(value, "dtype") and getattr(value, "ndim", 0) > 0


def _words_of_text(text: str) -> list[Token]:
    """Numbers, units and names stay words; anything else is a text as a whole, which is computed where a number is expected."""
    parts = text.split()
    if not parts:
        raise ValueError("a value is empty")
    words: list[Token] = []
    for part in parts:
        known = _NUMBER.match(part) or _PARAMETER.match(part) or (_UNIT.match(part) and part not in _RESERVED)
        if not known:
            return [quoted(text)]
        words.append(part)
    return words


class Encoder:
    """Values of properties, with the names that the scene has so far."""

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._names = frozenset(names)
        self.has_arrays = False  # whether values were arrays that became files in memory

    def property_lines(self, kind: str, type_name: str | None, properties: Mapping[str, Any]) -> list[Line]:
        lines = []
        for keyword, value in properties.items():
            field = find_field(kind, type_name, keyword)
            if value is not None:
                lines += self.lines(field, field["name"], value)
        return lines

    def lines(self, field: Field | None, name: str, value: Any) -> list[Line]:
        """The line of a property, or several where it is repeated."""
        kind = field["type"] if field else ""
        if kind == "transform":
            return [Line(name, block=self._steps(value))]
        if kind == "moments":
            return [Line(name, [*self.tokens(None, time)], self._block(field, block)) for time, block in value]
        if field and field.get("repeats") and isinstance(value, list):
            return [line for one in value for line in self.lines({**field, "repeats": False}, name, one)]
        if kind in ("points", "numbers", "indexRows", "table") and self._has_rows(value):
            return [Line(name, block=self._rows(kind, value))]
        if kind == "table" and isinstance(value, Mapping):
            return [Line(name, block=[row for word, one in value.items() for row in self._word_rows(language_name(word), one)])]
        if isinstance(value, Mapping):
            return [Line(name, block=self._block(field, value))]
        if isinstance(value, Node):
            return [self._node(field, name, value)]
        if isinstance(value, ImageArray) and kind != "file":
            if not field or not (field.get("texturable") or field.get("kind") == "texture"):
                raise TypeError(f"{name}: no texture may stand here")
            block = self.property_lines("texture", "image", value.properties)
            return [Line(name, ["image", *self.tokens({"type": "file"}, value)], block or None)]
        return [Line(name, self.tokens(field, value))]

    def tokens(self, field: Field | None, value: Any) -> list[Token]:
        kind = field["type"] if field else ""
        if _is_number(value):
            return [number_word(value.item() if hasattr(value, "item") else value)]
        if isinstance(value, ImageArray):
            if kind != "file":
                raise TypeError("a picture of abbe.image() stands in the place of a texture or of its file")
            self.has_arrays = True
            return value.tokens()
        if isinstance(value, os.PathLike):
            return [Path(os.fspath(value))]
        if isinstance(value, str):
            if kind == "file":
                return [Path(value)]
            if kind == "text":
                return [quoted(value)]
            if value in self._names:
                return [name_word(value)]
            return _words_of_text(value)
        if _is_array(value):
            return [number_word(x) for x in value.reshape(-1).tolist()]
        if isinstance(value, Sequence):
            if not value:
                raise ValueError("a value is empty")
            takes_texture = field and (field.get("texturable") or field.get("kind") == "texture")
            if takes_texture and isinstance(value[0], str) and value[0] in TYPES["texture"] and value[0] not in self._names:
                return [value[0], *argument_tokens(self, "texture", value[0], value[1:])]
            first = field if kind in ("file", "text") else None
            return [token for i, one in enumerate(value) for token in self.tokens(first if i == 0 else None, one)]
        if isinstance(value, Mapping):
            raise TypeError(f"{value!r} stands where no block can")
        raise TypeError(f"{value!r} has no counterpart in a scene")

    def _node(self, field: Field | None, name: str, value: Node) -> Line:
        kind = self._kind_of(field, value.type)
        tokens: list[Token] = [name_word(value.type)]
        named = kind is None or value.type not in TYPES[kind]
        if kind is None or named:
            tokens += [token for argument in value.arguments for token in self.tokens(None, argument)]
        else:
            tokens += argument_tokens(self, kind, value.type, value.arguments)
        for key, one in value.keys.items():
            tokens.append(f"{name_word(language_name(key))}={self._key_value(one)}")
        if named and value.properties:
            find_type(kind or "material", value.type)
        block = self.property_lines(kind, value.type, value.properties) if kind and value.properties else None
        return Line(name, tokens, block)

    @staticmethod
    def _kind_of(field: Field | None, type_name: str) -> str | None:
        if field is None:
            return None
        kind = field.get("kind")
        if kind is not None:
            return str(kind)
        return "texture" if field.get("texturable") or type_name in TYPES["texture"] else None

    def _key_value(self, value: Any) -> str:
        if _is_number(value):
            return number_word(value)
        return name_word(str(value))

    def _block(self, field: Field | None, value: Mapping[str, Any]) -> list[Line]:
        known = {one["name"]: one for one in (field or {}).get("block", ())}
        lines = []
        for keyword, one in value.items():
            name = language_name(keyword)
            lines += self.lines(known.get(name), name_word(name), one)
        return lines

    def _steps(self, value: Any) -> list[Line]:
        """Of a transform: `[("rotate", "y", "45 deg"), ("translate", 0, 1, 0)]`, top to bottom as applied, or a dict of such."""
        steps = value.items() if isinstance(value, Mapping) else value
        lines = []
        for step in steps:
            name, *values = step
            if name == "at":
                time, inner = values
                lines.append(Line("at", self.tokens(None, time), self._steps(inner)))
            else:
                lines.append(Line(name_word(language_name(name)), [t for v in values for t in self.tokens(None, v)]))
        return lines

    @staticmethod
    def _has_rows(value: Any) -> bool:
        if _is_array(value):
            return bool(value.ndim > 1)
        return isinstance(value, (list, tuple)) and bool(value) and (isinstance(value[0], (list, tuple)) or _is_array(value[0]))

    def _rows(self, kind: str, value: Any) -> list[Line]:
        rows = value.tolist() if _is_array(value) else value
        if kind == "table":
            return [self._table_row(row) for row in rows]
        return [Line("-", [number_word(x) for x in row]) for row in rows]

    def _word_rows(self, word: str, value: Any) -> list[Line]:
        """`{"albedo": True, "spectral": (380, 780, 10), "light-group": [("key", "lamp"), ("fill", "sky")]}`: a list is several rows."""
        if isinstance(value, list):
            return [row for one in value for row in self._word_rows(word, one)]
        if value is True or value == ():
            return [Line(name_word(word))]
        return [] if value in (False, None) else [Line(name_word(word), self.tokens(None, value))]

    def _table_row(self, row: Sequence[Any]) -> Line:
        first, *rest = row
        if isinstance(first, str) and not _NUMBER.match(first.split()[0] if first.split() else ""):
            return Line(name_word(first), [t for v in rest for t in self.tokens(None, v)])
        return Line("-", [t for v in row for t in self.tokens(None, v)])


def argument_tokens(encoder: Encoder, kind: str, type_name: str | None, arguments: Sequence[Any]) -> list[Token]:
    """Values behind the type, by the fields that take them."""
    places = {field["argument"]: field for field in fields(kind, type_name).values() if "argument" in field}
    return [token for i, value in enumerate(arguments) for token in encoder.tokens(places.get(i), value)]
