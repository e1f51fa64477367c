"""Nodes of the scene language and how they are printed (docs/language/syntax.md)."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Iterable, Sequence

WIDTH = 120  # of a line
_ILLEGAL = re.compile(r"[\s(){}\[\]/\\\"#;=,$]")  # in a word; `$` begins a parameter
_KEYWORDS = {"true", "false", "null", "inf", "-inf", "nan"}


@dataclasses.dataclass(frozen=True)
class FileRef:
    """A file that the scene names. `own` ones are written beside the scene; others are where they are."""

    path: str  # of own ones the name below the folder of side files; else absolute
    own: bool = False


Resolve = Callable[[FileRef], str]


def number(x: float) -> str:
    """The shortest text that reads back as the same double. Requires a finite number."""
    x = float(x)
    if not math.isfinite(x):
        raise ValueError(f"{x} cannot be written")
    if x == int(x) and abs(x) < 1e15:
        return str(int(x))
    return repr(x)


def quoted(text: str) -> str:
    """Text between quotes. What is no Unicode character becomes U+FFFD."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    text = text.encode("utf-8", "replace").decode("utf-8")
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t", "\b": "\\b", "\f": "\\f"}
    out = "".join(escapes.get(c, c) for c in text)
    return '"' + "".join(c if c.isprintable() or c == " " else f"\\u{{{ord(c):x}}}" for c in out) + '"'


def word_or_text(name: str) -> str:
    """A name that somebody chose: as it is where it is a legal word, else between quotes."""
    plain = name and not _ILLEGAL.search(name) and name.isprintable() and name not in _KEYWORDS
    starts_well = plain and not (name[0].isdigit() or (name[0] in "+-." and name[1:2].isdigit()) or name == "-")
    return name if starts_well else quoted(name)


class Node:
    """`name value… key=value { children }`. Functions that add return the node itself."""

    __slots__ = ("children", "name", "remarks", "values")

    def __init__(self, name: str, *words: str) -> None:
        self.name = name
        self.values: list[str | FileRef] = list(words)
        self.children: list[Node] = []
        self.remarks: list[str] = []

    def word(self, *words: str) -> Node:
        self.values += words
        return self

    def take_values(self, other: Node) -> Node:
        self.values += other.values
        return self

    def named(self, name: str) -> Node:
        self.values.append(word_or_text(name))
        return self

    def text(self, text: str) -> Node:
        self.values.append(quoted(text))
        return self

    def file(self, ref: FileRef) -> Node:
        self.values.append(ref)
        return self

    def numbers(self, values: Iterable[float]) -> Node:
        self.values += [number(x) for x in values]
        return self

    def key(self, name: str, value: str) -> Node:
        self.values.append(f"{name}={value}")
        return self

    def child(self, name: str, *words: str) -> Node:
        node = Node(name, *words)
        self.children.append(node)
        return node

    def adopt(self, node: Node) -> Node:
        self.children.append(node)
        return node

    def set(self, name: str, *values: float | str) -> Node:
        """A child of numbers and words; returns this node."""
        self.child(name).values += [v if isinstance(v, str) else number(v) for v in values]
        return self

    def rows(self, name: str, rows: Sequence[Sequence[float]]) -> Node:
        """A child whose children are rows of numbers."""
        block = self.child(name)
        block.children = [Node("-").numbers(row) for row in rows]
        return self

    def remark(self, text: str) -> Node:
        if text:
            self.remarks.append(text)
        return self


def _head(node: Node, resolve: Resolve) -> str:
    values = [quoted(resolve(v)) if isinstance(v, FileRef) else v for v in node.values]
    return " ".join([node.name, *values])


def _line(node: Node, resolve: Resolve, room: int) -> str | None:
    """The node on one line, or None where it is longer than `room` or has remarks inside."""
    out = _head(node, resolve)
    if len(out) > room and node.children:
        return None
    if node.children:
        parts = []
        left = room - len(out)
        for child in node.children:
            part = None if child.remarks else _line(child, resolve, left)
            if part is None:
                return None
            parts.append(part)
            left -= len(part) + 2
            if left < 0:
                return None
        out = f"{out} {{ {'; '.join(parts)} }}"
    return out if len(out) <= room or not node.children else None


def _comment(text: str, indent: str) -> list[str]:
    clean = "".join(c if c.isprintable() else " " for c in text.replace("\n", " "))
    return [f"{indent}// {clean}"]


def _print(node: Node, resolve: Resolve, indent: str, out: list[str]) -> None:
    for remark in node.remarks:
        out += _comment(remark, indent)
    line = _line(node, resolve, WIDTH - len(indent))
    if line is not None:
        out.append(indent + line)
        return
    out.append(f"{indent}{_head(node, resolve)} {{")
    inner = indent + "    "
    if all(c.name == "-" for c in node.children):
        row = ""
        for child in node.children:
            text = _head(child, resolve)
            if row and len(inner) + len(row) + 2 + len(text) > WIDTH:
                out.append(inner + row)
                row = ""
            row = f"{row}; {text}" if row else text
        out.append(inner + row)
    else:
        for child in node.children:
            _print(child, resolve, inner, out)
    out.append(indent + "}")


def print_scene(nodes: Sequence[Node], resolve: Resolve) -> str:
    """A whole file, with a blank line between nodes of different kinds."""
    out: list[str] = []
    for i, node in enumerate(nodes):
        if i and node.name != nodes[i - 1].name:
            out.append("")
        _print(node, resolve, "", out)
    return "\n".join(out) + "\n"
