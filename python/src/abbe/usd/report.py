"""What became of a stage: counts by type of prim, and remarks that name prim and layer.

Codes and their meaning are those of `abbe import` (docs/importing.md): W0801 left out, W0802 approximated, W0803 unknown,
E0401 a file is missing, E0801 the file breaks the rules of its format, E0802 it makes no sense.
"""

from __future__ import annotations

import dataclasses
import enum
from typing import Any

SHOWN = 5  # remarks of the same words that are kept by themselves; further ones are counted


class Fate(enum.Enum):
    """What became of a prim."""

    CARRIED = "carried over"
    APPROXIMATED = "approximated"
    LEFT_OUT = "left out"
    HIDDEN = "not shown"  # invisible, or of a purpose that is not asked for
    USED = "used by others"  # materials, subsets, fields, skeletons: parts of what is carried over


@dataclasses.dataclass(frozen=True)
class Remark:
    """A fault, or something that is not in the scene as it is in the stage."""

    code: str
    path: str  # of the prim or property; empty for the stage as a whole
    layer: str  # the strongest one that has an opinion on it
    what: str
    why: str
    file: str = ""  # the path of that layer; empty where it is in none

    @property
    def is_error(self) -> bool:
        return self.code.startswith("E")

    def __str__(self) -> str:
        kind = "error" if self.is_error else "warning"
        verb = {"W0801": " is left out", "W0802": " is approximated", "W0803": " is not known"}.get(self.code, "")
        place = f"{self.layer}: {self.path}: " if self.path else f"{self.layer}: " if self.layer else ""
        return f"{kind} {self.code}: {place}{self.what}{verb}: {self.why}"


def strongest_layer(prim: Any) -> tuple[str, str]:
    """Name and path of the layer with the strongest opinion on a prim; empty where there is none."""
    if prim is None or not prim.IsValid():
        return "", ""
    stack = prim.GetPrimStack()
    if not stack and prim.IsInPrototype() and prim.GetParent().IsValid():
        return strongest_layer(prim.GetParent())
    if not stack:
        return "", ""
    layer = stack[0].layer
    return str(layer.GetDisplayName() or layer.identifier), str(layer.realPath)


class Report:
    """Collects remarks and counts."""

    def __init__(self) -> None:
        self.remarks: list[Remark] = []
        self.counts: dict[str, dict[Fate, int]] = {}
        self.repeated: dict[tuple[str, str, str], int] = {}
        self._fates: dict[str, tuple[str, Fate]] = {}

    def error(self, code: str, prim: Any, what: str, why: str) -> None:
        self._add(code, prim, what, why)

    def left_out(self, prim: Any, what: str, why: str) -> str:
        return self._add("W0801", prim, what, why)

    def approximated(self, prim: Any, what: str, how: str) -> str:
        """Also makes a prim that counts as carried over one that is approximated."""
        path = str(prim.GetPath()) if prim is not None else ""
        if path in self._fates and self._fates[path][1] is Fate.CARRIED:
            self.count(prim, Fate.APPROXIMATED)
        return self._add("W0802", prim, what, how)

    def unknown(self, prim: Any, what: str, why: str) -> str:
        return self._add("W0803", prim, what, why)

    def _add(self, code: str, prim: Any, what: str, why: str) -> str:
        path = "" if prim is None else str(prim.GetPath())
        layer, file = strongest_layer(prim)
        remark = Remark(code, path, layer, what, why, file)
        key = (code, what, why)
        self.repeated[key] = self.repeated.get(key, 0) + 1
        if self.repeated[key] <= SHOWN:
            self.remarks.append(remark)
        return f"{code}: {what}: {why}"

    def count(self, prim: Any, fate: Fate) -> None:
        """Counts a prim once; what is said last holds."""
        self.count_path(str(prim.GetPath()), str(prim.GetTypeName()), fate)

    def count_path(self, path: str, kind: str, fate: Fate) -> None:
        kind = kind or "untyped"
        old = self._fates.get(path)
        if old is not None:
            self.counts[old[0]][old[1]] -= 1
        self._fates[path] = (kind, fate)
        of_kind = self.counts.setdefault(kind, {})
        of_kind[fate] = of_kind.get(fate, 0) + 1

    @property
    def errors(self) -> list[Remark]:
        return [remark for remark in self.remarks if remark.is_error]

    @property
    def warning_count(self) -> int:
        return sum(n for (code, _, _), n in self.repeated.items() if code.startswith("W"))

    def summary(self) -> str:
        """Counts as lines of text, and how often remarks were repeated."""
        lines = []
        for kind in sorted(self.counts):
            parts = [f"{n} {fate.value}" for fate, n in self.counts[kind].items() if n > 0]
            if parts:
                lines.append(f"{kind}: {', '.join(parts)}")
        for (code, what, _), n in self.repeated.items():
            if n > SHOWN:
                lines.append(f"{code}: {what}: {n - SHOWN} more of these")
        return "\n".join(lines)

    def as_json(self) -> dict[str, Any]:
        return {
            "counts": {kind: {f.value: n for f, n in of.items() if n > 0} for kind, of in sorted(self.counts.items())},
            "remarks": [dataclasses.asdict(remark) for remark in self.remarks],
            "repeated": [{"code": code, "what": what, "why": why, "times": n} for (code, what, why), n in self.repeated.items() if n > SHOWN],
        }


class StageError(Exception):
    """The stage cannot be read, or makes no sense. `report` says what is wrong and where."""

    def __init__(self, message: str, report: Report, exit_code: int = 1) -> None:
        super().__init__(message)
        self.report = report
        self.exit_code = exit_code
