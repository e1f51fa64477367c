"""Abbe, a spectral film renderer, from Python.

>>> import abbe
>>> scene = abbe.load("room.scene", yaw="25 deg")
>>> image = scene.render(samples=64)
>>> image.save("room.exr")

`abbe.Scene()` builds a scene by calls, with the words of the scene language: lengths are in metres, angles in degrees and times in seconds
unless a unit stands with them, ``radius="10 cm"``. docs/python.md is the manual.

`abbe.usd` reads OpenUSD stages. It needs `usd-core` (`pip install "abbe[usd]"`) and no other part of this package.
"""

from importlib import import_module as _import_module
from typing import Any as _Any

# Loaded when they are asked for: abbe.usd works without the extension.
_HOMES = {
    "Diagnostic": "_errors",
    "SceneError": "_errors",
    "Node": "_values",
    "image": "_arrays",
    "node": "_values",
    "Scene": "_scene",
    "load": "_scene",
    "ErrorEstimate": "_image",
    "Image": "_image",
    "read_image": "_image",
    "merge": "_image",
    "compare": "_tools",
    "study": "_tools",
    "verify": "_tools",
    "Spectrum": "_spectrum",
    "spectrum": "_spectrum",
    "color": "_spectrum",
    "Material": "_material",
    "Samples": "_material",
    "material": "_material",
    "CommandError": "_tools",
    "explain": "_schema",
    "__version__": "_schema",
}

__all__ = [name for name in _HOMES if not name.startswith("_")]


def __getattr__(name: str) -> _Any:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'abbe' has no attribute {name!r}")
    value = getattr(_import_module(f"abbe.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
