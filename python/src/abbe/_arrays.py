"""Geometry, pictures and volumes out of numpy arrays, without a file: the renderer reads them where they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abbe import _abbe
from abbe._schema import language_name
from abbe._values import ImageArray, Line, MemoryFile, quoted

# What of a type arrays may state: three or two numbers, or one, for each point; whole numbers.
_VECTORS = {"points": 3, "normals": 3, "uvs": 2, "radii": 1}
_SHAPES = {
    ("shape", "mesh"): ("points", "faces", "uvs", "attribute"),
    ("shape", "subdivision"): ("points", "faces"),
    ("shape", "points"): ("points", "normals", "radii"),
    ("shape", "curves"): ("points", "counts", "radii"),
    ("light", "mesh"): ("points", "faces"),
    ("light", "environment"): ("image",),
    ("volume", "vdb"): ("density", "temperature", "flame", "color", "velocity"),
}
# Numbers of a voxel, where it is not one.
_OF_THREE = ("color", "velocity")
_MOST_VOXELS = 1 << 26  # along an axis: kFarthestVoxel
_MOST_PIXELS = 1 << 20
_PLACE = ("bounds", "voxel_size", "origin")


# What `help(abbe.Scene.volume)` says beside the words of the language.
ARRAYS_DOC = {
    "volume": """Grids of `vdb` out of numpy arrays, without a file:
    density: array (z, y, x) of float32, none below 0; its grid is the density
    temperature: array (z, y, x), in kelvin
    flame: array (z, y, x), the amount of what emits
    color: array (z, y, x, 3), linear Rec. 709 within 0 and 1
    velocity: array (z, y, x, 3), the components x, y, z in m/s
    bounds: ((x0, y0, z0), (x1, y1, z1)) in m, what the voxels fill together; before `transform`
    voxel_size: in its place the edge of a voxel in m, or three of them
    origin: with voxel_size, (x0, y0, z0) in m; default (0, 0, 0)
    Values are those in the middles of voxels, linear between them, and fall to 0 over the voxel beyond the outermost. All arrays of a volume
    have one shape. ValueError and TypeError at once for other shapes and types, numbers that are not finite, amounts below 0.""",
}


class ArraysLine(Line):
    """The line that names arrays: a file in memory while the scene lives, rows of numbers in a text."""

    def __init__(self, handle: Any, name: str, inline: Callable[[], list[Line]]) -> None:
        super().__init__(name, [quoted(handle.name)])
        self._handle = handle
        self._inline = inline

    def write(self, out: list[str], folder: str, indent: int, memory: bool) -> None:
        if memory:
            super().write(out, folder, indent, memory)
            return
        for line in self._inline():
            line.write(out, folder, indent, memory)


def is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _of_attribute(value: Any) -> bool:
    pairs = value if isinstance(value, list) else [value]
    return all(isinstance(pair, tuple) and len(pair) == 2 and isinstance(pair[0], str) and is_array(pair[1]) for pair in pairs)


def _floats(what: str, value: Any) -> NDArray[np.float32]:
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{what}: an array of numbers is expected, not of {array.dtype}")
    with np.errstate(over="ignore"):
        made = np.ascontiguousarray(array, dtype=np.float32)
    if not np.isfinite(made).all():
        raise ValueError(f"{what}: number {int(np.argmin(np.isfinite(made)))} is not finite")
    return made


def _vectors(what: str, value: Any, width: int, count: int | None) -> NDArray[np.float32]:
    made = _floats(what, value)
    shape = "(N,)" if width == 1 else f"(N, {width})"
    if made.ndim != (1 if width == 1 else 2) or (width > 1 and made.shape[1] != width):
        raise ValueError(f"{what}: an array of shape {shape} is expected, not {made.shape}")
    if count is not None and len(made) != count:
        raise ValueError(f"{what}: {len(made)} for {count} points")
    return made


def _wholes(what: str, value: Any, below: int) -> NDArray[np.uint32]:
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{what}: an array of whole numbers is expected, not of {array.dtype}")
    if array.size and (array.min() < 0 or array.max() >= below):
        wrong = int(array.max()) if array.max() >= below else int(array.min())
        raise ValueError(f"{what}: {wrong} is not between 0 and {below - 1}")
    if array.dtype == np.int32 and array.flags.c_contiguous:
        return array.view(np.uint32)
    return np.ascontiguousarray(array, dtype=np.uint32)


def _faces(value: Any, points: int) -> tuple[dict[str, NDArray[np.uint32]], int]:
    """Arrays, and the corners of each face, 0 where their number is an array of its own."""
    if is_array(value):
        if value.ndim != 2 or value.shape[1] < 3:
            raise ValueError(f"faces: an array of shape (F, 3) or more is expected, not {value.shape}")
        return {"faces": _wholes("faces", value, points)}, value.shape[1]
    sizes = np.array([len(row) for row in value], dtype=np.uint32)
    corners = np.array([i for row in value for i in row])
    return {"faces": _wholes("faces", corners, points), "face-sizes": sizes}, 0


def _picture(value: Any) -> tuple[NDArray[np.float32], tuple[int, int, int]]:
    made = _floats("image", value)
    if made.ndim != 3 or made.shape[2] != 3:
        raise ValueError(f"image: an array of shape (height, width, 3) is expected, not {made.shape}")
    return made, (made.shape[1], made.shape[0], 3)


def image(array: Any, space: str | None = None, *, wrap: str | None = None, take: str | None = None) -> ImageArray:
    """The picture of an image texture out of an array, without a file: ``reflectance=abbe.image(pixels)`` wherever a texture may stand, or
    ``scene.texture("bark", "image", abbe.image(pixels, space="data"))``.

    array: (height, width) or (height, width, 1 to 4), rows from the top; two and four channels end with alpha, which is not multiplied into
    the others. uint8 is as in a PNG, 255 for 1; other numbers are taken as float32, as in an EXR. No copy of arrays that are contiguous and
    of these types; do not change them while the scene lives.
    space: how values are stored, as in ``image "bark.exr" space=…``: a colour space, ``"data"`` for heights, directions and the like. Without
    it ``"srgb_rec709_scene"`` for uint8, ``"lin_rec709_scene"`` for floats; one channel is data.
    wrap: "periodic", "clamp", "mirror", "black". take: "color", "alpha"; the alpha channel alone.

    Raises TypeError, ValueError for other shapes and types, and numbers that are not finite.
    """
    values = np.asarray(array)
    made: NDArray[Any] = np.ascontiguousarray(values) if values.dtype == np.uint8 else _floats("image", values)
    if made.ndim == 2:
        made = made[:, :, np.newaxis]
    if made.ndim != 3 or 0 in made.shape or made.shape[2] > 4:
        raise ValueError(f"image: an array of shape (height, width) or (height, width, 1 to 4) is expected, not {values.shape}")
    if max(made.shape[:2]) > _MOST_PIXELS:
        raise ValueError(f"image: {max(made.shape[:2])} pixels along an axis; the most is {_MOST_PIXELS}")
    if take == "alpha" and made.shape[2] % 2:
        raise ValueError(f"image: {made.shape[2]} channels have no alpha")
    if space is not None and not isinstance(space, str):
        raise TypeError(f"space: a name is expected, not {space!r}")
    size = (made.shape[1], made.shape[0], made.shape[2])
    floats, numbers = ({}, {"pixels": made}) if made.dtype == np.uint8 else ({"pixels": made}, {})
    handle = _abbe.ArraysHandle("image", floats, {}, size, numbers)
    properties = {name: value for name, value in (("wrap", wrap), ("take", take)) if value is not None}
    return ImageArray(MemoryFile(handle, f"a picture that is an array of {made.shape}"), space, properties)


def take_arrays(
    kind: str, type_name: str | None, properties: Mapping[str, Any], inline: Callable[[Mapping[str, Any]], list[Line]]
) -> tuple[dict[str, Any], ArraysLine | None]:
    """Properties without those that arrays state, and the line for these; `inline` makes lines of them for a text."""
    by_name = {language_name(keyword): keyword for keyword in properties}
    known = _SHAPES.get((kind, type_name or ""), ())
    if (kind, type_name) == ("volume", "vdb"):
        return _take_volume(properties)
    main = next((name for name in ("points", "image") if name in known and name in by_name), None)
    if main is None or not is_array(properties[by_name[main]]):
        return dict(properties), None
    taken = {name: properties[by_name[name]] for name in known if name in by_name}
    if "attribute" in taken and not _of_attribute(taken["attribute"]):
        raise TypeError("attribute: (name, array), or a list of such, is expected beside arrays")
    rest = {keyword: value for name, keyword in by_name.items() for value in [properties[keyword]] if name not in taken}
    if main == "image":
        pixels, size = _picture(taken["image"])

        def refuse() -> list[Line]:
            raise ValueError("a picture that is an array has no place in a text: save it as an EXR, and name that")

        return rest, ArraysLine(_abbe.ArraysHandle("image", {"pixels": pixels}, {}, size), "image", refuse)
    handle = _geometry(kind, taken)
    return rest, ArraysLine(handle, "file", lambda: inline(taken))


def _geometry(kind: str, taken: Mapping[str, Any]) -> Any:
    points = _vectors("points", taken["points"], 3, None)
    floats, integers, corners = {"points": points}, {}, 0
    for name, value in taken.items():
        if name == "faces":
            faces, corners = _faces(value, len(points))
            integers.update(faces)
        elif name == "counts":
            integers["counts"] = _wholes("counts", value, len(points) + 1)
            if integers["counts"].sum(dtype=np.int64) != len(points):
                raise ValueError(f"counts: they come to {integers['counts'].sum(dtype=np.int64)}, but there are {len(points)} points")
        elif name == "attribute":
            for label, array in value if isinstance(value, list) else [value]:
                width = 3 if np.ndim(array) == 2 else 1
                floats[f"attribute:{label}"] = _vectors(f"attribute {label}", array, width, len(points))
        elif name != "points":
            floats[name] = _vectors(name, value, _VECTORS[name], len(points))
    if "radii" in floats and (floats["radii"] < 0).any():
        raise ValueError("radii: one is below 0")
    return _abbe.ArraysHandle(kind, floats, integers, (corners, 0, 0))


def _grid(name: str, value: Any) -> NDArray[np.float32]:
    shape = "(z, y, x, 3)" if name in _OF_THREE else "(z, y, x)"
    made = _floats(name, value)
    if made.ndim != (4 if name in _OF_THREE else 3) or 0 in made.shape or (name in _OF_THREE and made.shape[3] != 3):
        raise ValueError(f"{name}: an array of shape {shape} is expected, not {made.shape}")
    if max(made.shape[:3]) > _MOST_VOXELS:
        raise ValueError(f"{name}: {max(made.shape[:3])} voxels along an axis; the most is {_MOST_VOXELS}")
    if name not in _OF_THREE and made.min() < 0:
        raise ValueError(f"{name}: number {int(np.argmax(made < 0))} is {made.min() if made.size == 1 else made[made < 0][0]}, below 0")
    return made


def _three(what: str, value: Any) -> NDArray[np.float64]:
    """Three lengths in metres."""
    try:
        made = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        made = np.array(np.nan)
    if made.shape != (3,) or not np.isfinite(made).all():
        raise ValueError(f"{what}: three numbers are expected, in metres, not {value!r}")
    return made


def _place(properties: Mapping[str, Any], counts: tuple[int, ...]) -> tuple[float, ...]:
    """Size of a voxel and middle of the first one; `counts` along x, y, z."""
    bounds, voxel, origin = (properties.get(name) for name in _PLACE)
    if (bounds is None) == (voxel is None):
        raise TypeError("a volume of arrays needs either `bounds`, ((x0, y0, z0), (x1, y1, z1)) in metres, or `voxel_size`")
    if bounds is not None:
        if origin is not None:
            raise TypeError("origin: it goes with `voxel_size`; `bounds` say where the volume begins")
        if not isinstance(bounds, (tuple, list, np.ndarray)) or len(bounds) != 2:
            raise ValueError(f"bounds: ((x0, y0, z0), (x1, y1, z1)) is expected, not {bounds!r}")
        lower, upper = _three("bounds", bounds[0]), _three("bounds", bounds[1])
        size = (upper - lower) / counts
    else:
        assert voxel is not None
        lower = _three("origin", (0, 0, 0) if origin is None else origin)
        size = _three("voxel_size", (voxel,) * 3 if np.ndim(voxel) == 0 else voxel)
    if not (size > 0).all():
        raise ValueError(f"{'bounds' if voxel is None else 'voxel_size'}: voxels of {tuple(size.tolist())} m have no volume")
    return (*size.tolist(), *(lower + size / 2).tolist())


def _take_volume(properties: Mapping[str, Any]) -> tuple[dict[str, Any], ArraysLine | None]:
    known = _SHAPES["volume", "vdb"]
    taken = {name: properties[name] for name in known if is_array(properties.get(name))}
    given = [name for name in _PLACE if properties.get(name) is not None]
    if not taken:
        if given:
            raise TypeError(f"{given[0]}: it places arrays, but none is given; `transform` places a file")
        return dict(properties), None
    if "file" in properties:
        raise TypeError(f"{next(iter(taken))}: an array stands beside a file; all grids of a volume are arrays, or all are of the file")
    for name in known:
        if name not in taken and (name == "density" or properties.get(name) is not None):
            raise TypeError(f"{name}: an array is expected beside the array {next(iter(taken))}")
    grids = {name: _grid(name, value) for name, value in taken.items()}
    shape = grids["density"].shape
    for name, grid in grids.items():
        if grid.shape[:3] != shape:
            raise ValueError(f"{name}: it has {grid.shape[:3]} voxels, the density {shape}")
    counts = (shape[2], shape[1], shape[0])
    rest = {name: value for name, value in properties.items() if name not in _PLACE and name not in taken}
    rest |= {name: name for name in grids}  # the grids by name
    handle = _abbe.ArraysHandle("volume", grids, {}, counts, {}, _place(properties, counts))

    def refuse() -> list[Line]:
        raise ValueError(f"the arrays {', '.join(grids)} of a volume have no place in a text: write them as an OpenVDB file, and name that")

    return rest, ArraysLine(handle, "file", refuse)
