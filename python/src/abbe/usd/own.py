"""What a prim states itself, so that nothing is asked that has the value of its schema.

Each question to USD costs a microsecond or four, and a mesh has some thirty of them, of which it answers six. One question for
the names of what is authored saves the others.
"""

from __future__ import annotations

import functools
from collections.abc import Container
from typing import Any, NamedTuple

from pxr import Usd, UsdGeom

# Prims that come in great numbers, and what may be applied to them without another value of what is asked here.
_PLAIN_TYPES = frozenset({"Mesh", "Xform", "Scope", ""})
_PLAIN_SCHEMAS = frozenset({"MaterialBindingAPI", "SkelBindingAPI", "GeomModelAPI", "MotionAPI", "VisibilityAPI"})

_code = functools.lru_cache(maxsize=1 << 12)(Usd.TimeCode)  # to convert a number at each question takes half a microsecond


class _Everything:
    """Of a prim that has to be asked."""

    def __contains__(self, name: object) -> bool:
        return True


_EVERYTHING = _Everything()


class Census:
    """The prims of a stage by their types: one way through it instead of one for each question. Not those in instances."""

    def __init__(self, stage: Usd.Stage) -> None:
        self._of_type: dict[str, list[Usd.Prim]] = {}
        for prim in stage.Traverse():
            self._of_type.setdefault(prim.GetTypeName(), []).append(prim)

    def all(self, schema: Any) -> list[Usd.Prim]:
        """Those that are of a schema or of one that is made from it; in the order of the stage within a type."""
        return [prim for prims in self._of_type.values() if prims[0].IsA(schema) for prim in prims]


class Owned:
    """Which properties prims have opinions on, and which primvars they hand down."""

    def __init__(self, stage: Usd.Stage) -> None:
        # Clips give values to properties on which no layer of the stage has an opinion.
        self._ask = any(prim.HasAuthoredMetadata("clips") for prim in stage.TraverseAll())
        self._handed: dict[str, frozenset[str]] = {}  # by the path of a prim

    def names(self, prim: Usd.Prim, kind: str) -> Container[str]:
        """The properties whose values may be others than those of the schema. `kind` is the type of the prim."""
        if self._ask or kind not in _PLAIN_TYPES or not _PLAIN_SCHEMAS.issuperset(prim.GetAppliedSchemas()):
            return _EVERYTHING
        return frozenset(prim.GetAuthoredPropertyNames())

    def inherited(self, prim: Usd.Prim, path: str) -> Container[str]:
        """The primvars, without `primvars:`, that a prim may have from those that hold it."""
        if self._ask:
            return _EVERYTHING
        holder = path.rpartition("/")[0]
        found = self._handed.get(holder)
        if found is None:
            found = frozenset(p.GetPrimvarName() for p in UsdGeom.PrimvarsAPI(prim.GetParent()).FindInheritablePrimvars())
            self._handed[holder] = found
        return found


class Stated(NamedTuple):
    """A primvar as it is stated."""

    values: Any
    indices: Any
    interpolation: str


class Prim:
    """A prim on its way, with what was asked already."""

    __slots__ = ("_inherited", "_owned", "has_children", "kind", "names", "path", "prim")

    def __init__(self, owned: Owned, prim: Usd.Prim) -> None:
        self.prim = prim
        self.path = str(prim.GetPath())
        self.kind = str(prim.GetTypeName())
        self.names = owned.names(prim, self.kind)
        self._owned = owned
        self._inherited: Container[str] | None = None
        self.has_children = prim.IsInstanceProxy() or bool(prim.GetAllChildrenNames())

    @property
    def is_plain(self) -> bool:
        """Whether nothing is applied to it that makes it more than its type says, such as a light."""
        return self.names is not _EVERYTHING

    def value(self, name: str, time: float | Usd.TimeCode, otherwise: Any = None) -> Any:
        """The value of an attribute; `otherwise`, which is that of the schema, where there is no opinion."""
        return self.prim.GetAttribute(name).Get(_code(time)) if name in self.names else otherwise

    def primvar(self, name: str, time: float) -> Stated | None:
        """The primvar of this prim or of what holds it, at a time; None where there is none with a value."""
        name = name.removeprefix("primvars:")
        full = f"primvars:{name}"
        if full not in self.names:
            if self._inherited is None:
                self._inherited = self._owned.inherited(self.prim, self.path)
            if name not in self._inherited:
                return None
        elif self.names is not _EVERYTHING and f"{full}:indices" not in self.names:
            attribute = self.prim.GetAttribute(full)
            values = attribute.Get(_code(time))
            if values is not None:
                return Stated(values, None, str(attribute.GetMetadata("interpolation") or UsdGeom.Tokens.constant))
        found = UsdGeom.PrimvarsAPI(self.prim).FindPrimvarWithInheritance(full)
        values = found.Get(time) if found and found.HasValue() else None
        return None if values is None else Stated(values, found.GetIndices(time) if found.IsIndexed() else None, str(found.GetInterpolation()))
