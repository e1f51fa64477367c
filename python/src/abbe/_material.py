"""Materials as functions of directions and wavelengths, as the renderer evaluates and samples them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from abbe import _abbe
from abbe._errors import one_fault, raise_errors
from abbe._scene import Scene
from abbe._values import Node

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Transport = Literal["radiance", "importance"]

_TRANSPORTS = ("radiance", "importance")
_LOWEST, _HIGHEST = 360.0, 830.0  # nm
_UNIT = 1e-4  # by which the length of a direction may differ from 1


class Samples(NamedTuple):
    """What `Material.sample` draws. Where `pdf` is 0 nothing was found, the path ends, and the other numbers of the row are 0."""

    wi: NDArray[np.float32]
    """(N, 3): directions, unit vectors."""
    weight: NDArray[np.float32]
    """(N, W): f |cos θi| / pdf; of specular samples the ratio of both deltas."""
    pdf: NDArray[np.float32]
    """(N,): density, 1/sr; of specular samples the probability of their lobe."""
    specular: NDArray[np.bool_]
    """(N,): whether the sample is of a mirror or a polished interface, which `eval` and `pdf` leave out."""


def _numbers(what: str, values: ArrayLike) -> NDArray[np.float64]:
    given = np.asarray(values)
    if given.dtype.kind not in "fiu":
        raise TypeError(f"{what}: real numbers are expected, not {given.dtype}")
    numbers = np.ascontiguousarray(given, dtype=np.float64).reshape(given.shape)
    if not np.isfinite(numbers).all():
        raise ValueError(f"{what}: a number is not finite")
    return numbers


def _rows(what: str, values: ArrayLike, columns: tuple[int, ...]) -> NDArray[np.float64]:
    rows = _numbers(what, values)
    if rows.ndim not in (1, 2) or rows.shape[-1] not in columns:
        shape = " or ".join(str(n) for n in columns)
        raise ValueError(f"{what}: an array (N, {shape}), or one row for all, is expected, not {rows.shape}")
    return np.atleast_2d(rows)


def _directions(what: str, values: ArrayLike) -> NDArray[np.float64]:
    rows = _rows(what, values, (3,))
    lengths = np.sqrt(np.sum(rows * rows, axis=1, keepdims=True))
    if (np.abs(lengths - 1) > _UNIT).any():
        row = int(np.argmax(np.abs(lengths - 1)))
        raise ValueError(f"{what}: directions are unit vectors; row {row} has length {lengths[row, 0]:g}")
    return np.asarray(rows / lengths)


def _wavelengths(values: ArrayLike) -> NDArray[np.float64]:
    nm = np.atleast_1d(_numbers("wavelengths", values))
    if nm.ndim != 1 or nm.size == 0:
        raise ValueError(f"wavelengths: a number or an array (W,) is expected, not {nm.shape}")
    if (nm < _LOWEST).any() or (nm > _HIGHEST).any():
        raise ValueError(f"wavelengths: nm from {_LOWEST:g} to {_HIGHEST:g} are expected")
    return nm


def _pairs(what: str, first: NDArray[np.float64], second: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """With as many rows of both, one row standing for all."""
    if len(first) != len(second) and 1 not in (len(first), len(second)):
        raise ValueError(f"{what}: there are {len(first)} and {len(second)} rows")
    count = len(second) if len(first) == 1 else len(first)
    both = [np.ascontiguousarray(np.broadcast_to(rows, (count, rows.shape[1]))) for rows in (first, second)]
    return both[0], both[1]


def _importance(transport: str) -> bool:
    if transport not in _TRANSPORTS:
        raise ValueError(f"transport: {' or '.join(_TRANSPORTS)} is expected, not {transport!r}")
    return transport == "importance"


class Material:
    """What scatters at a surface: `eval`, `pdf` and `sample`, the renderer's own code in single precision, on arrays.

    Directions are unit vectors in the frame of the surface, whose z is the normal, and point away from it: `wo` where the light goes, to the
    eye; `wi` where it comes from, which is the direction that is drawn. Below z = 0 is the inside of solids; outside is air. Where z of both has one
    sign light is reflected, else transmitted. Wavelengths are in nm, from 360 to 830. One direction, (3,), stands for all.

    Only the surface: what light meets within, an absorption or a medium, is not in it. Make one with `abbe.material`."""

    def __init__(self, handle: Any, name: str) -> None:
        self._handle = handle
        self.name = name

    def eval(self, wo: ArrayLike, wi: ArrayLike, wavelengths: ArrayLike, *, transport: Transport = "radiance") -> NDArray[np.float32]:
        """f(wo, wi, λ) |cos θi|, in 1/sr: the cosine, |wi.z|, is in it.

        wo, wi: (N, 3) or (3,). wavelengths: (W,) or a number, nm. Returns (N, W). Mirrors and polished interfaces are 0 here: they are in no
        direction but that of their samples.

        transport: "radiance" on ways from the eye, "importance" on ways from a light. Radiance that is refracted shrinks by 1/η²."""
        importance = _importance(transport)
        o, i = _pairs("wo, wi", _directions("wo", wo), _directions("wi", wi))
        return self._handle.eval(o, i, _wavelengths(wavelengths), importance)  # type: ignore[no-any-return]

    def pdf(self, wo: ArrayLike, wi: ArrayLike, wavelengths: ArrayLike = 550.0) -> NDArray[np.float32]:
        """The density, in 1/sr, with which `sample(wo, …, wavelengths)` draws wi, (N,): not that of specular samples.

        wo, wi: (N, 3) or (3,). wavelengths: (W,) or a number, nm: those that are given to `sample`, since they say how often each lobe is
        chosen."""
        o, i = _pairs("wo, wi", _directions("wo", wo), _directions("wi", wi))
        return self._handle.pdf(o, i, _wavelengths(wavelengths))  # type: ignore[no-any-return]

    def sample(self, wo: ArrayLike, u: ArrayLike, wavelengths: ArrayLike = 550.0, *, transport: Transport = "radiance") -> Samples:
        """Directions wi that are drawn for wo: (wi (N, 3), weight (N, W), pdf (N,), specular (N,)).

        wo: (N, 3) or (3,). u: (N, 3), numbers in [0, 1): two for the direction, and one that chooses the lobe; (N, 2) where there is nothing
        to choose. wavelengths: (W,) or a number, nm.

        Directions are drawn as on a path of eight wavelengths: the first one given, on which refracted directions depend, and seven at even
        steps from the others. Where glass disperses the weight of a polished refraction is 0 at other wavelengths than the first: they go
        elsewhere. The mean of the weights is the share of the light that is scattered (of importance, where light is refracted)."""
        importance = _importance(transport)
        numbers = _rows("u", u, (2, 3))
        if numbers.shape[1] == 2:
            if self._handle.chooses_lobe:
                raise ValueError("u: an array (N, 3) is expected: this material chooses between lobes by the third number")
            numbers = np.concatenate([numbers, np.zeros((len(numbers), 1))], axis=1)
        if (numbers < 0).any() or (numbers >= 1).any():
            raise ValueError("u: numbers in [0, 1) are expected")
        o, both = _pairs("wo, u", _directions("wo", wo), numbers)
        return Samples(*self._handle.sample(o, both, _wavelengths(wavelengths), importance))

    @property
    def opacity(self) -> float:
        """Share of the light that hits the surface, 0 to 1; the rest goes straight on. Not in the values of `eval` and `sample`."""
        return float(self._handle.opacity)

    def __repr__(self) -> str:
        return f"<abbe.Material {self.name!r}>"


def _of_scene(scene: Scene, name: str) -> Material:
    handle = _abbe.MaterialHandle(scene._made(), name)
    raise_errors(handle.log)
    if not handle.found:
        nearest = _abbe.suggest_word(name, handle.names)
        known = ", ".join(f"`{one}`" for one in handle.names) or "no material"
        raise one_fault("E0202", f"no material is named `{name}`", f"did you mean `{nearest}`?" if nearest else f"the scene has {known}")
    if handle.obstacle:
        raise ValueError(f"{name}: {handle.obstacle}")
    return Material(handle, name)


def _of_words(type_name: str, arguments: tuple[Any, ...], properties: dict[str, Any]) -> Material:
    scene = Scene()
    scene.material("material", type_name, *arguments, **properties)
    return _of_scene(scene, "material")


def material(what: str | Node | Scene, *arguments: Any, **properties: Any) -> Material:
    """A material to evaluate and sample: `material("conductor", index="metal Au", roughness=0.3)`, with the words of `Scene.material`;
    `material(abbe.node("diffuse", reflectance=0.5))`; or one of a scene by its name, `material(scene, "paint")`, which need have no camera
    and no light.

    Raises SceneError for what the language does not allow, with all diagnostics, and ValueError for materials that directions alone do not
    describe: those with textures or maps, hair, boundaries."""
    if isinstance(what, Scene):
        if len(arguments) != 1 or not isinstance(arguments[0], str) or properties:
            raise TypeError("material(scene, name): a scene and the name of a material are expected")
        return _of_scene(what, arguments[0])
    if isinstance(what, Node):
        if arguments or properties:
            raise TypeError("material(node): what is in the node is all of it")
        if what.keys:
            raise TypeError(f"material(node): a material has no keys: {', '.join(what.keys)}")
        return _of_words(what.type, what.arguments, what.properties)
    if not isinstance(what, str):
        raise TypeError(f"a type of material, a node or a scene is expected, not {what!r}")
    return _of_words(what, arguments, properties)
