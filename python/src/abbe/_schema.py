"""The scene language's own tables: names, units, ranges, defaults and documentation of all kinds and types, read from the renderer at import."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from abbe import _abbe
from abbe._errors import one_fault

__version__ = _abbe.version()

Field = dict[str, Any]

_DATA = json.loads(_abbe.schema_json())
KINDS: dict[str, dict[str, Any]] = {kind["name"]: kind for kind in _DATA["kinds"]}
TYPES: dict[str, dict[str, dict[str, Any]]] = {kind: {} for kind in KINDS}
for _type in _DATA["types"]:
    TYPES[_type["kind"]][_type["name"]] = _type
_UNITS = {dimension["name"]: dimension for dimension in _DATA["dimensions"]}
# Kinds whose definitions take a `transform` and nothing else, or a name of what they place.
_TRANSFORM: Field = {"name": "transform", "type": "transform", "doc": "Moves what is in it.", "dimensions": ["none"], "keyed": True}


def explain(word: str) -> str:
    """What `abbe explain` says: of a kind ("light"), a type ("light.quad"), a property ("camera.lens"), a unit, a preset or a code of a
    diagnostic ("E0310"). Raises KeyError where there is no such word."""
    text = _abbe.explain(word)
    if text is None:
        raise KeyError(word)
    return str(text)


def default_type(kind: str) -> str | None:
    return next((name for name, info in TYPES[kind].items() if info["default"]), None)


@cache
def fields(kind: str, type_name: str | None) -> dict[str, Field]:
    """Properties of a type by their names in the language."""
    if type_name is None or type_name not in TYPES[kind]:
        return {"transform": _TRANSFORM} if kind in ("group", "object", "instance") else {}
    return {field["name"]: field for field in TYPES[kind][type_name]["fields"]}


def find_type(kind: str, name: str) -> str:
    """The type of that name; SceneError with the nearest one otherwise."""
    if name in TYPES[kind]:
        return name
    nearest = _abbe.suggest_word(name, list(TYPES[kind]))
    known = ", ".join(f"`{one}`" for one in TYPES[kind])
    raise one_fault("E0205", f"`{kind}` has no type `{name}`", f"did you mean `{nearest}`?" if nearest else f"there are {known}")


def language_name(keyword: str) -> str:
    """`look_at` is look-at, `from_` is from."""
    return keyword.rstrip("_").replace("_", "-")


def find_field(kind: str, type_name: str | None, keyword: str) -> Field:
    """The property of a keyword argument; SceneError with what was probably meant otherwise."""
    name = language_name(keyword)
    known = fields(kind, type_name)
    if name in known:
        return known[name]
    title = f"`{kind} {type_name}`" if type_name else f"`{kind}`"
    meant = _abbe.suggest_property(kind, type_name or "", name) or _abbe.suggest_word(name, list(known))
    remedy = f"did you mean `{python_name(meant)}`? {known[meant]['doc']}" if meant in known else "it has " + ", ".join(python_name(n) for n in known)
    raise one_fault("E0201", f"{title} has no property `{name}`", remedy)


def python_name(name: str) -> str:
    """As a keyword argument."""
    word = name.replace("-", "_")
    return word + "_" if word in ("from", "in", "is", "as", "with", "global", "lambda") else word


_SHAPES = {
    "number": "number",
    "integer": "whole number",
    "quantity": "number",
    "vector2": "(x, y)",
    "vector3": "(x, y, z)",
    "toggle": "bool",
    "choice": "word",
    "words": "words",
    "text": "text",
    "file": "path",
    "points": "array (N, 3)",
    "numbers": "array",
    "indexRows": "rows of whole numbers, or array (F, 3 or 4)",
    "spectrum": "spectrum",
    "complexIndex": "metal",
    "reference": "name or node",
    "transform": "steps",
    "table": "rows",
    "place": "distance or shape",
    "moments": "(time, {…}), …",
    "weighted": "name or node",
    "stop": "position, spectrum",
    "namedNumbers": "name, numbers",
    "sharpRow": "whole numbers",
}


def _field_line(field: Field) -> str:
    what = _SHAPES[field["type"]]
    if field.get("texturable"):
        what += " or texture"
    if field.get("choices"):
        what += " of " + ", ".join(field["choices"])
    units = [_UNITS[d]["si"] for d in field["dimensions"] if d != "none" and _UNITS[d]["si"]]
    if units:
        what += " in " + " or ".join(units)
    low, high = field.get("minimum"), field.get("maximum")
    if low is not None and high is not None:
        what += f", {low:g} to {high:g}"
    elif low is not None:
        what += f", from {low:g}"
    if "default" in field:
        what += f"; default {field['default']}"
    elif field.get("required"):
        what += "; required"
    return f"    {python_name(field['name'])}: {what}\n        {field['doc']}"


def type_doc(kind: str, type_name: str) -> str:
    info = TYPES[kind][type_name]
    lines = [f"{type_name}: {info['doc']}"]
    lines += [_field_line(field) for field in info["fields"]]
    return "\n".join(lines)


def kind_doc(kind: str) -> str:
    info = KINDS[kind]
    parts = [info["doc"], f"In the scene language: {info['head']}"]
    parts += [type_doc(kind, name) for name in TYPES[kind]]
    return "\n\n".join(parts)
