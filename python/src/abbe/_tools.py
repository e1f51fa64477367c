"""Commands of the program as functions: each is a process of its own, whose JSON comes back as Python's values."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from typing import Any

from abbe._image import Image
from abbe._scene import Scene


class CommandError(RuntimeError):
    """A command ended with an error. `code` is its exit code (docs/command_line.md), str() what it said."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message.strip() or f"exit code {code}")
        self.code = code


_THRESHOLD = 4  # a threshold was exceeded: an answer, no fault


def _run(words: Sequence[str]) -> tuple[int, list[Any]]:
    """The objects of JSON on standard output, a line each or one for all."""
    done = subprocess.run([sys.executable, "-m", "abbe", *words], capture_output=True, text=True, encoding="utf-8", check=False)
    if done.returncode not in (0, _THRESHOLD):
        raise CommandError(done.returncode, done.stderr or done.stdout)
    decoder, objects, text = json.JSONDecoder(), [], done.stdout.strip()
    while text:
        value, end = decoder.raw_decode(text)
        objects.append(value)
        text = text[end:].lstrip()
    return done.returncode, objects


def _options(options: dict[str, Any]) -> list[str]:
    """`samples=64` is `--samples 64`, `size=(64, 48)` is `--size 64x48`, True a flag, a list a flag for each, a dict one of `key=value` for
    each."""
    words: list[str] = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        if isinstance(value, dict):
            value = [f"{key}={one}" for key, one in value.items()]
        elif isinstance(value, tuple):
            value = "x".join(str(one) for one in value)
        for one in value if isinstance(value, list) else [value]:
            if one is None or one is False:
                continue
            words += [flag] if one is True else [flag, os.fspath(one) if isinstance(one, os.PathLike) else str(one)]
    return words


def _image_path(image: Image | str | os.PathLike[str], folder: str, name: str) -> str:
    if not isinstance(image, Image):
        return os.fspath(image)
    path = os.path.join(folder, f"{name}.exr")
    image.save(path)
    return path


def _scene_path(scene: Scene | str | os.PathLike[str], folder: str) -> tuple[str, list[str]]:
    if not isinstance(scene, Scene):
        return os.fspath(scene), []
    words = []
    for flag, values in (("-D", scene._defines), ("--variant", scene._variants), ("--set", scene._sets), ("--search", scene._folders())):
        for value in values:
            words += [flag, value]
    if scene._path is not None and not scene._lines:
        return scene._path, words
    if scene._base is not None:
        raise ValueError("definitions were added to a scene of a file: write it first, and name the file that was written")
    path = os.path.join(folder, "scene.scene")
    with open(path, "w", encoding="utf-8") as file:
        file.write(scene.text(folder))
    return path, words


def compare(image: Image | str | os.PathLike[str], *references: Image | str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """What `abbe compare --json` says of an image and one reference, or two of different seeds: images, or paths of EXR files. Options as of the
    command: ``compare(a, b, threshold={"flip": 0.05})``. Raises CommandError."""
    if not references:
        raise TypeError("compare() needs an image to compare with")
    with tempfile.TemporaryDirectory() as folder:
        first, *others = [_image_path(one, folder, f"image-{i}") for i, one in enumerate((image, *references))]
        against = others if len(others) == 1 else [word for path in others for word in ("--ref", path)]
        code, objects = _run(["compare", first, *against, "--json", *_options(options)])
    return {**objects[-1], "within": code == 0}


def verify(scene: Scene | str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """What `abbe verify --json` says: whether two estimators of a scene agree. Options as of the command: ``verify(scene, samples=64)``."""
    with tempfile.TemporaryDirectory() as folder:
        path, words = _scene_path(scene, folder)
        code, objects = _run(["verify", path, *words, "--json", *_options(options)])
    return {**objects[-1], "agree": code == 0}


def study(scene: Scene | str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """What `abbe study` measures, the content of its JSON file: error against time of variants of a render. Options as of the command. Where
    `output="folder/name"` is given, the page, the table and the file itself are there."""
    with tempfile.TemporaryDirectory() as folder:
        path, words = _scene_path(scene, folder)
        output = os.fspath(options.pop("output", os.path.join(folder, "study")))
        _run(["study", path, *words, "--quiet", "--output", output, *_options(options)])
        with open(output + ".json", encoding="utf-8") as file:
            return dict(json.load(file))
