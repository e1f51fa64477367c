"""Scenes: loaded from files, or built by calls that have the words of the scene language."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from abbe import _abbe, _end  # noqa: F401 (_end enters itself)
from abbe._arrays import ARRAYS_DOC, take_arrays
from abbe._errors import Diagnostic, SceneError, diagnostics_of, one_fault, raise_errors
from abbe._image import Image, Progress, outcome
from abbe._schema import KINDS, TYPES, default_type, find_type, kind_doc, language_name
from abbe._values import Encoder, Line, Token, argument_tokens, name_word, quoted

_TARGETS = ("instance", "instances", "atmosphere")
_CONTAINERS = ("group", "object")
# `scene.render()` renders; what `render { … }` says is stated by this.
_METHODS = {"render": "render_settings"}


def _values_of(values: Mapping[str, Any]) -> list[str]:
    """`-D name=value`."""
    encoder = Encoder()
    return [f"{language_name(name)}={' '.join(str(t) for t in encoder.tokens(None, value))}" for name, value in values.items()]


class Definitions:
    """What definitions stand in: a scene, a group, an object. One method for each kind."""

    _lines: list[Line]

    if TYPE_CHECKING:  # made from the schema tables below

        def camera(self, *head: Any, **properties: Any) -> None: ...
        def light(self, *head: Any, **properties: Any) -> None: ...
        def shape(self, *head: Any, **properties: Any) -> None: ...
        def instance(self, *head: Any, **properties: Any) -> None: ...
        def instances(self, *head: Any, **properties: Any) -> None: ...
        def material(self, *head: Any, **properties: Any) -> None: ...
        def phase(self, *head: Any, **properties: Any) -> None: ...
        def medium(self, *head: Any, **properties: Any) -> None: ...
        def volume(self, *head: Any, **properties: Any) -> None: ...
        def atmosphere(self, *head: Any, **properties: Any) -> None: ...
        def spectrum(self, *head: Any, **properties: Any) -> None: ...
        def texture(self, *head: Any, **properties: Any) -> None: ...
        def film(self, *head: Any, **properties: Any) -> None: ...
        def render_settings(self, *head: Any, **properties: Any) -> None: ...
        def group(self, *head: Any, **properties: Any) -> Container: ...
        def object(self, name: str, **properties: Any) -> Container: ...

    def _root(self) -> Scene:
        raise NotImplementedError

    def _define(self, kind: str, head: tuple[Any, ...], properties: dict[str, Any]) -> Container | None:
        scene = self._root()
        encoder = Encoder(scene._names)
        tokens: list[Token] = []
        type_name: str | None = default_type(kind)
        words = list(head)
        if kind in _TARGETS or kind in _CONTAINERS:
            if kind != "group" and not words:
                raise TypeError(f"{kind}() needs a name")
            if words:
                tokens.append(name_word(words.pop(0)))
        elif kind == "spectrum":
            if len(words) < 2:
                raise TypeError("spectrum() needs a name and a value")
            tokens.append(name_word(words.pop(0)))
        elif kind not in ("film", "render"):
            # As in the language: one word is the type, two are name and type.
            if len(words) >= 2 and isinstance(words[0], str) and isinstance(words[1], str) and words[1] in TYPES[kind]:
                tokens.append(name_word(words.pop(0)))
            elif len(words) >= 2 and isinstance(words[0], str) and words[0] not in TYPES[kind]:
                find_type(kind, words[1] if isinstance(words[1], str) else words[0])
            if words:
                type_name = find_type(kind, words.pop(0))
                tokens.append(type_name)
            elif type_name is None:
                raise TypeError(f"{kind}() needs a type: {', '.join(TYPES[kind])}")
        named = len(tokens) == 2 or kind in ("object", "spectrum")
        name = head[0] if named else None
        tokens += argument_tokens(encoder, kind, type_name, words)
        rest, arrays = take_arrays(kind, type_name, properties, partial(encoder.property_lines, kind, type_name))
        lines = encoder.property_lines(kind, type_name, rest)
        if arrays is not None:
            lines.append(arrays)
        scene._has_arrays = scene._has_arrays or arrays is not None or encoder.has_arrays
        line = Line(kind, tokens, lines if lines or kind in ("film", "render", *_CONTAINERS) else None)
        self._lines.append(line)
        scene._changed()
        if name is not None:
            scene._names.add(name)
        if kind in _CONTAINERS:
            assert line.block is not None
            return Container(scene, line.block)
        return None


class Container(Definitions):
    """What `scene.group()` and `scene.object()` return: definitions are added to it by the same methods; it may stand behind `with`."""

    def __init__(self, scene: Scene, lines: list[Line]) -> None:
        self._scene = scene
        self._lines = lines

    def _root(self) -> Scene:
        return self._scene

    def __enter__(self) -> Container:
        return self

    def __exit__(self, *_: object) -> None:
        return None


class Scene(Definitions):
    """A scene in the making.

    >>> scene = abbe.Scene()
    >>> scene.camera(from_=(0, 1, 4), look_at=(0, 0.5, 0))
    >>> scene.light("daylight", elevation="30 deg")
    >>> scene.material("glass", "dielectric", ior="glass BK7")
    >>> scene.shape("ball", "sphere", radius=0.5, material="glass")
    >>> scene.render(samples=64).save("ball.exr")

    There is a method for each kind of definition, whose keyword arguments are the properties with `_` in place of `-` (`from_` for `from`).
    Their documentation, `help(abbe.Scene.shape)`, comes from the renderer's own tables.
    Keyword arguments of `Scene()` are those of the header, `length="mm"`, `rgb="acescg"`, `up="z"`, and `search`: folders in which files
    of the scene may read, as with `--search`. What these calls name themselves may lie anywhere.
    """

    def __init__(
        self, *, length: str | None = None, rgb: str | None = None, up: str | None = None, search: Sequence[str | os.PathLike[str]] = ()
    ) -> None:
        self._lines: list[Line] = []
        self._names: set[str] = set()
        self._base: str | None = None  # the text of a file
        self._path: str | None = None
        self._defines: list[str] = []
        self._variants: list[str] = []
        self._sets: list[str] = []
        self._search = [os.path.abspath(folder) for folder in search]
        self._handle: Any = None
        self._has_arrays = False
        keys = {"length": length, "rgb": rgb, "up": up}
        self._header = Line("scene", ["1", *(f"{key}={name_word(value)}" for key, value in keys.items() if value is not None)])

    def _root(self) -> Scene:
        return self

    def _changed(self) -> None:
        self._handle = None

    def param(self, name: str, value: Any, doc: str | None = None) -> None:
        """A parameter, which texts name `$name` and `abbe.load(…, name=value)` sets."""
        tokens = [name_word(language_name(name)), *Encoder(self._names).tokens(None, value)]
        self._lines.append(Line("param", tokens + ([quoted(doc)] if doc is not None else [])))
        self._changed()

    def include(self, path: str | os.PathLike[str], as_: str | None = None) -> None:
        """Everything of another scene file; with `as_="car"` its names begin with `car:`."""
        tokens = Encoder().tokens({"type": "file"}, path)
        self._lines.append(Line("include", tokens + ([f"as={name_word(as_)}"] if as_ else [])))
        self._changed()

    def override(self, kind: str, name: str | None = None, type: str | None = None, **properties: Any) -> None:
        """Changes properties of a definition that stands before. `type` is its type, where properties shall be checked here."""
        if kind not in KINDS:
            raise one_fault("E0201", f"there is no kind `{kind}`", "it is one of " + ", ".join(KINDS))
        encoder = Encoder(self._names)
        lines = []
        for keyword, value in properties.items():
            word = language_name(keyword)
            known = [one for t in TYPES[kind].values() for one in t["fields"] if one["name"] == word and type in (None, t["name"])]
            if not known and word != "transform":
                raise one_fault("E0201", f"no {type or kind} has a property `{word}`")
            lines += encoder.lines(known[0] if known else {"type": "transform", "name": "transform"}, word, value)
        self._has_arrays = self._has_arrays or encoder.has_arrays
        self._lines.append(Line("override", [kind, *([name_word(name)] if name else [])], lines))
        self._changed()

    def remove(self, kind: str, name: str) -> None:
        """Takes a definition out that stands before."""
        self._lines.append(Line("remove", [name_word(kind), name_word(name)]))
        self._changed()

    def text(self, folder: str | os.PathLike[str] = ".") -> str:
        """The scene in the layout of `abbe fmt`. Names of files in it are relative to `folder`, where they are inside of it; arrays are rows of
        numbers."""
        return self._text(folder, memory=False)

    def _text(self, folder: str | os.PathLike[str], memory: bool) -> str:
        place = os.path.abspath(folder)
        if self._base is not None and self._path is not None and os.path.dirname(os.path.abspath(self._path)) != place:
            raise ValueError(f"{self._path} names its files relative to its own folder; write the scene there, or pack it with `abbe pack`")
        out = [] if self._base is None else [self._base.rstrip("\n")]
        for line in [self._header, *self._lines] if self._base is None else self._lines:
            line.write(out, place, 0, memory)
        return str(_abbe.lay_out("\n".join(out) + "\n"))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene file, as `abbe fmt` would lay it out. Parameters, variants and settings of `abbe.load` are not part of the text:
        with them it is a ValueError."""
        if self._defines or self._variants or self._sets:
            raise ValueError("what abbe.load() was given beside the file is no part of its text; load the file without")
        text = self.text(os.path.dirname(os.path.abspath(path)))
        temporary = f"{os.fspath(path)}.{os.getpid()}.tmp"
        try:
            with open(temporary, "w", encoding="utf-8", newline="\n") as file:
                file.write(text)
            os.replace(temporary, path)
        except BaseException:
            if os.path.exists(temporary):
                os.remove(temporary)
            raise

    def _made(self) -> Any:
        """The extension's scene, as it is now."""
        if self._handle is None:
            path = self._path or os.path.join(os.getcwd(), "scene.scene")
            as_file = self._path is not None and not self._lines
            text = None if as_file else self._text(os.path.dirname(os.path.abspath(path)), memory=True)
            self._handle = _abbe.SceneHandle(path, text, self._defines, self._variants, self._sets, self._folders())
        return self._handle

    def _folders(self) -> list[str]:
        """Where the scene may read beside its own folder: what was stated, and where files are that the program itself named."""
        return self._search + sorted(set().union(*(line.folders() for line in self._lines)))

    def check(self, frame: int | None = None) -> tuple[Diagnostic, ...]:
        """Everything that `abbe check` finds wrong: raises SceneError if there are errors, returns the warnings."""
        return raise_errors(self._made().check(frame))

    def render(
        self,
        *,
        samples: int | None = None,
        noise: float | None = None,
        time: float | None = None,
        size: tuple[int, int] | None = None,
        crop: tuple[int, int, int, int] | None = None,
        camera: str | None = None,
        frame: int | None = None,
        seed: int | None = None,
        adaptive: bool | None = None,
        threads: int = 0,
        memory: float | None = None,
        texture_cache: float | None = None,
        output: str | os.PathLike[str] | None = None,
        png: bool | None = None,
        resume: bool = False,
        checkpoint: float | str | None = None,
        part: tuple[int, int] | None = None,
        skip: int | None = None,
        progress: Callable[[Progress], Any] | None = None,
    ) -> Image | None:
        """Renders the scene to an image in memory, with the bits that `abbe render` writes.

        samples: per pixel. noise: relative error at which to end, 0.005 for half a per cent. time: seconds after which to end.
        size: pixels, (width, height). crop: the pixels (x0, y0, x1, y1) alone. camera: its name. frame: of an animation.
        threads: 0 for one on each core. memory, texture_cache: bytes.

        output: an EXR file that is written as well, with the certificate, checkpoints and (unless png=False) a PNG beside it, as the command
        does; `resume` goes on from the checkpoint, `checkpoint` is its interval in seconds, "off" or "keep".
        part: (k, n), the k-th of n ranges of the samples: a file for `abbe.merge()` is written to `output`, and None is returned.
        skip: samples per pixel that earlier rounds of parts have.

        progress: called a few times a second, on this thread, with a dict: done (0 to 1), samples, of_samples, noise, elapsed and left (s),
        paths_per_second. What it raises ends the render, as Ctrl-C does: within a second, and nothing of it runs any more.
        Ctrl-C while the scene is read and built, which nothing ends, leaves that to a thread of its own; it writes nothing.

        Other threads of Python go on meanwhile. Renders of one process take turns.
        Raises SceneError with all diagnostics; warnings are in `image.warnings`.
        """
        if part is not None and output is None:
            raise ValueError("a part is a file: give `output`")
        if output is None and (resume or checkpoint is not None):
            raise ValueError("checkpoints lie beside an image: give `output`")
        if self._has_arrays and (resume or part is not None):
            raise ValueError("a render is continued elsewhere by what is in its files: write() a scene with arrays, and load() that")
        arguments: dict[str, Any] = {
            "samples": samples, "noise": noise, "time": time, "size": size, "crop": crop, "camera": camera, "frame": frame, "seed": seed,
            "adaptive": adaptive, "memory": memory, "texture_cache": texture_cache, "output": None if output is None else os.fspath(output),
            "png": png, "resume": resume, "part": part, "skip": skip,
        }  # fmt: skip
        if isinstance(checkpoint, str):
            if checkpoint not in ("off", "keep"):
                raise ValueError('checkpoint: a number of seconds, "off" or "keep" is expected')
            arguments[f"checkpoint_{checkpoint}"] = True
        else:
            arguments["checkpoint"] = checkpoint
        return outcome(_abbe.render(self._made(), arguments, threads, progress))

    def forget(self) -> None:
        """Lets go of what one render keeps for the next: geometry, textures and tables."""
        if self._handle is not None:
            self._handle.forget()

    def __repr__(self) -> str:
        return f"<abbe.Scene {self._path or 'of ' + str(len(self._lines)) + ' definitions'}>"


def load(
    path: str | os.PathLike[str],
    *,
    variants: Sequence[str] = (),
    set: Mapping[str, Any] | None = None,
    search: Sequence[str | os.PathLike[str]] = (),
    **parameters: Any,
) -> Scene:
    """The scene of a file, checked: a SceneError has everything that is wrong with it.

    Further keyword arguments set parameters of the scene, ``yaw="25 deg"``, as `-D` does. variants: as `--variant`.
    set: ``{"material.ring.roughness": 0.1}``, as `--set`. search: folders beside the scene's own in which it may read, as `--search`.
    Packs and scenes of other programs are read as the command reads them. Definitions that are added to a loaded scene stand behind those of
    the file.
    """
    scene = Scene(search=search)
    scene._path = os.fspath(path)
    scene._defines = _values_of(parameters)
    scene._variants = list(variants)
    scene._sets = [f"{place}={' '.join(str(t) for t in Encoder().tokens(None, value))}" for place, value in (set or {}).items()]
    log = scene._made().check(None)
    if log.has_errors():
        raise SceneError(diagnostics_of(log), log.text())
    if os.path.splitext(scene._path)[1] == ".scene":
        with open(scene._path, encoding="utf-8-sig") as file:
            scene._base = file.read()
    return scene


def _add_kind(kind: str) -> None:
    def method(self: Definitions, *head: Any, **properties: Any) -> Container | None:
        return self._define(kind, head, properties)

    method.__name__ = method.__qualname__ = _METHODS.get(kind, kind)
    method.__doc__ = "\n\n".join([kind_doc(kind), *([ARRAYS_DOC[kind]] if kind in ARRAYS_DOC else [])])
    setattr(Definitions, method.__name__, method)


for _kind in KINDS:
    _add_kind(_kind)
