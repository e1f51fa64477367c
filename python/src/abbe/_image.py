"""Images: what a render made, in memory."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from abbe import _abbe
from abbe._errors import Diagnostic, SceneError, diagnostics_of, raise_errors

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from abbe._scene import Scene

    Floats = NDArray[np.float32]

Progress = dict[str, Any]


@dataclass(frozen=True)
class ErrorEstimate:
    """How far an image is from its limit: root mean square over the pixels, with the interval of 95 % of what this image's error is."""

    value: float
    low: float
    high: float

    def __float__(self) -> float:
        return self.value


class Image:
    """A rendered image, linear and relative to the exposure of its camera, with all its layers. Arrays have a row for each row of pixels from
    the top: shape (height, width) or (height, width, 3), float32. They are read-only views where nothing is converted.
    """

    def __init__(self, handle: Any, summary: Mapping[str, Any] | None = None, warnings: Sequence[Diagnostic] = (), files: Sequence[str] = ()) -> None:
        self._handle = handle
        self._summary = dict(summary or {})
        self.warnings = tuple(warnings)
        """What the render warned of."""
        self.files = tuple(files)
        """That the render wrote."""

    @property
    def width(self) -> int:
        """Of the pixels that there are, which a crop has fewer of."""
        return int(self._handle.width)

    @property
    def height(self) -> int:
        return int(self._handle.height)

    @property
    def window(self) -> tuple[int, int, int, int]:
        """(x0, y0, x1, y1) of these pixels in the whole picture, whose size is `display_size`."""
        return self._handle.window  # type: ignore[no-any-return]

    @property
    def display_size(self) -> tuple[int, int]:
        return self._handle.display_size  # type: ignore[no-any-return]

    @property
    def space(self) -> str:
        """Colour space of the channels R, G and B, by its identifier of the Color Interop Forum."""
        return str(self._handle.space)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of all planes, those of an EXR file of it: R, G, B, variance.Y, and those of the layers."""
        return tuple(self._handle.channels())

    @property
    def layers(self) -> tuple[str, ...]:
        """Names for `image["albedo"]`: channels without their last part."""
        return tuple(dict.fromkeys(name.rpartition(".")[0] or name for name in self.channels if name not in ("R", "G", "B")))

    def channel(self, name: str) -> Floats:
        """A plane, (height, width), without a copy. KeyError if there is none of that name."""
        return self._handle.plane(name)  # type: ignore[no-any-return]

    def __getitem__(self, name: str) -> Floats:
        """A channel ("depth.Z") as (height, width), or the channels of a layer ("albedo") as (height, width, n)."""
        import numpy as np

        if name in self.channels:
            return self.channel(name)
        parts = [one for one in self.channels if one.rpartition(".")[0] == name]
        if not parts:
            raise KeyError(f"{name}; there are {', '.join(self.layers)}")
        return np.stack([self.channel(one) for one in parts], axis=-1)

    def rgb(self, space: str | None = None) -> Floats:
        """(height, width, 3) in a linear space: "acescg", "lin_rec709_scene", "aces2065-1", …; as stored without one. Colours keep their
        chromaticity: nothing is adapted to another white, nor clipped."""
        return self._handle.rgb(space or self.space)  # type: ignore[no-any-return]

    @property
    def xyz(self) -> Floats:
        """CIE 1931 X, Y, Z, (height, width, 3)."""
        return self.rgb("xyz")

    @property
    def variance(self) -> Floats | None:
        """Estimated variance of Y of each pixel; None with a single replicate."""
        return self.channel("variance.Y") if "variance.Y" in self.channels else None

    def spectrum(self, bins: int | None = None) -> tuple[NDArray[np.float64], Floats]:
        """Wavelengths (nm, the bins' centres) and spectral radiance times exposure, (height, width, bins), in W·m⁻²·sr⁻¹·nm⁻¹. The film must
        have the layer: ``scene.film(layers={"spectral": (380, 780, 10)})``. `bins`: so many in place of those that were rendered, whose number
        is a multiple of it."""
        import numpy as np

        names = [(float(name[3:-2]), name) for name in self.channels if name.startswith("S0.") and name.endswith("nm")]
        if not names:
            raise KeyError('no spectral layer; the film needs `layers={"spectral": (380, 780, 10)}`')
        names.sort()
        wavelengths = np.array([w for w, _ in names])
        values = np.stack([self.channel(name) for _, name in names], axis=-1)
        if bins is not None:
            if bins < 1 or len(names) % bins:
                raise ValueError(f"bins: {len(names)} bins were rendered, which is no multiple of {bins}")
            wavelengths = wavelengths.reshape(bins, -1).mean(axis=1)
            values = values.reshape(*values.shape[:2], bins, -1).mean(axis=-1)
        return wavelengths, values

    @property
    def error(self) -> ErrorEstimate | None:
        """Relative error of the whole image (the certificate's figure); None where there is none, as of one replicate or of an image that was
        read, whose header has it."""
        figure = self._summary.get("error")
        return ErrorEstimate(**figure) if figure else None

    @property
    def samples(self) -> int | None:
        """Per pixel, as finished in all of them."""
        return self._summary.get("samples", self.header.get("abbe.samples"))

    @property
    def noise(self) -> float | None:
        return self._summary.get("noise", self.header.get("abbe.noise"))

    @property
    def partial(self) -> bool:
        """Whether the render was ended before its goal."""
        return bool(self._summary.get("partial", self.header.get("abbe.partial", False)))

    @property
    def statistics(self) -> dict[str, Any]:
        """What the render took: seconds by phases, memory, the kernel that ran."""
        return dict(self._summary)

    @property
    def header(self) -> dict[str, Any]:
        """How the image was made, as files say it (docs/output.md)."""
        return dict(self._handle.attributes())

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        display: str | None = None,
        view: str | None = None,
        ocio: str | None = None,
        exposure: float | None = None,
        bits: int = 8,
    ) -> tuple[Diagnostic, ...]:
        """Writes `x.exr` with all channels and the header, or `x.png` as a display shows it (`exposure` in stops, `view` and `display` of the
        OpenColorIO configuration `ocio`, 8 or 16 `bits`). The file appears when it is whole. Returns warnings. Raises OSError."""
        if bits not in (8, 16):
            raise ValueError("bits: 8 or 16")
        options = {"display": display, "view": view, "ocio": ocio, "exposure": exposure}
        return raise_errors(self._handle.save(os.fspath(path), bits, options))

    def _repr_png_(self) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.png")
            self.save(path)
            with open(path, "rb") as file:
                return file.read()

    def __repr__(self) -> str:
        return f"<abbe.Image {self.width}×{self.height}, {len(self.channels)} channels>"


def read_image(path: str | os.PathLike[str]) -> Image:
    """An EXR that Abbe wrote, with all its channels and its header. Raises OSError."""
    return Image(_abbe.ImageHandle.read(os.fspath(path)))


def outcome(result: tuple[Any, ...]) -> Image | None:
    """The image of a render or merge, or None of one that made a part."""
    exit_code, log, handle, summary, files = result
    if log.has_errors():
        raise SceneError(diagnostics_of(log), log.text())
    if exit_code != 0:
        raise RuntimeError(f"the render ended with exit code {exit_code}")
    return None if handle is None else Image(handle, summary, diagnostics_of(log), files)


def merge(
    parts: Sequence[str | os.PathLike[str]],
    *,
    scene: Scene | str | os.PathLike[str] | None = None,
    output: str | os.PathLike[str] | None = None,
    so_far: bool = False,
    progress: Callable[[Progress], Any] | None = None,
) -> Image | None:
    """Parts of a render, `scene.render(part=(k, n), output=…)` or `abbe render --part`, put together to the bits of the whole.

    scene: a `Scene` that was built here, or where the file is now. output: an EXR to write as well; or a `.abbe`, a larger part, and the result
    is None. so_far: also where samples are missing. Raises SceneError, and ValueError for files that are no parts."""
    if not parts:
        raise ValueError("parts: there are none")
    path, text = None, None
    if scene is not None and not isinstance(scene, (str, os.PathLike)):
        path = scene._path
        text = None if scene._path is not None and not scene._lines else scene.text()
        path = path or os.path.join(os.getcwd(), "scene.scene")
    elif scene is not None:
        path = os.fspath(scene)
    target = "" if output is None else os.fspath(output)
    return outcome(_abbe.merge([os.fspath(part) for part in parts], path, text, target, so_far, progress))
