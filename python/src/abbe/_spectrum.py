"""Spectra and colours, as the renderer has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from abbe import _abbe
from abbe._errors import raise_errors
from abbe._values import Encoder

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_FORMS = {
    "illuminant": "emission",
    "blackbody": "emission",
    "line": "emission",
    "glass": "index",
    "sellmeier": "index",
    "cauchy": "index",
    "metal": "unbounded",
}


class Spectrum:
    """A curve over wavelength from 360 to 830 nm. Call it with wavelengths in nm, a number or an array of any shape: ``s(np.arange(400, 701))``."""

    def __init__(self, text: str, role: str) -> None:
        self._handle = _abbe.SpectrumHandle(text, role)
        raise_errors(self._handle.log)
        self.text = text
        self.role = role

    def __call__(self, wavelengths: ArrayLike) -> NDArray[np.float64]:
        """Values at wavelengths (nm), in an array of their shape. Beyond 360 and 830 nm the curve is as it is there."""
        asked = np.ascontiguousarray(wavelengths, dtype=np.float64)
        if not np.isfinite(asked).all():
            raise ValueError("a wavelength is not finite")
        return self._handle.at(asked).reshape(np.shape(wavelengths))

    @property
    def xyz(self) -> tuple[float, float, float]:
        """∫ s (x̄, ȳ, z̄) dλ / ∫ ȳ dλ with the CIE 1931 2° observer: a spectrum that is 1 everywhere has Y = 1."""
        return self._handle.xyz()

    def under(self, light: Spectrum | str) -> tuple[float, float, float]:
        """XYZ of this reflectance in a light, whose white has Y = 1."""
        source = spectrum(light, role="emission") if isinstance(light, str) else light
        white = source.xyz[1]
        x, y, z = self._handle.xyz_under(source._handle)
        return x / white, y / white, z / white

    def __repr__(self) -> str:
        return f"<abbe.Spectrum {self.text!r} for {self.role}>"


def _text_of(value: Any) -> str:
    if isinstance(value, Mapping):
        value = ("table", *(number for pair in value.items() for number in pair))
    return " ".join(str(token) for token in Encoder().tokens(None, value))


def spectrum(value: Any, *, role: str | None = None) -> Spectrum:
    """A spectrum as scenes state it: ``spectrum("illuminant FL11")``, ``("rgb", 0.8, 0.2, 0.1)``, ``{400: 0.1, 700: 0.9}`` (wavelengths in nm),
    ``"measured macbeth-13"``, ``"glass BK7"``, ``0.18``.

    role: what it is used for, as the renderer checks and builds it: "albedo" (0 to 1), "emission", "index", "unbounded", "shape" or "tint".
    Without it light is "emission", glass an "index", and the rest "albedo". Raises SceneError."""
    text = _text_of(value)
    return Spectrum(text, role or _FORMS.get(text.split()[0], "albedo"))


def color(value: Any, *, space: str = "lin_rec709_scene", light: Spectrum | str = "illuminant D65") -> tuple[float, float, float]:
    """Linear RGB of a spectrum: of light as it is, with Y = 1; of a reflectance in `light`. ``color("measured macbeth-13")``.

    `value`: a Spectrum, or what `spectrum()` takes. Colours keep their chromaticity, and may be negative outside of the space."""
    curve = value if isinstance(value, Spectrum) else spectrum(value)
    if curve.role in ("emission", "tint", "shape"):
        x, y, z = curve.xyz
        xyz = (x / y, 1.0, z / y)
    else:
        xyz = curve.under(light)
    return _abbe.rgb_of_xyz(xyz, space)
