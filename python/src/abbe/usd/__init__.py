"""OpenUSD stages as scenes of Abbe.

>>> from abbe import usd
>>> shot = usd.load("shot.usdc", camera="/cam", frame=12)
>>> print(shot.report.summary())
>>> shot.write("shot.scene")

Composition is USD's own. What is carried over, approximated and left out: docs/importing_usd.md.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

try:
    import numpy as _numpy
    from pxr import Sdf as _Sdf
    from pxr import Usd as _Usd
except ImportError as _fault:
    raise ImportError(f"abbe.usd needs usd-core and numpy ({_fault}): pip install 'abbe[usd]'") from _fault

from .context import Context, Options
from .convert import Converter
from .files import SideFiles, write_atomically
from .reach import folders_to_state, foreign_files
from .report import Fate, Remark, Report, StageError
from .scene_text import FileRef, Node, print_scene
from .stage import open_stage, quiet

__all__ = ["Fate", "Options", "Remark", "Report", "Scene", "StageError", "load"]


class Scene:
    """What a stage became: a scene in memory, with the files that it needs."""

    def __init__(self, report: Report, files: SideFiles, nodes: Sequence[Node], path: str | os.PathLike[str], stage: _Usd.Stage) -> None:
        self.report = report
        self._stage = Path(path)
        # Arrays lie in the layers' files, mapped into memory: USD would copy all of them when the layers are closed.
        self._layers = [_Sdf.Layer.FindOrOpen(layer.identifier) for layer in stage.GetUsedLayers()]  # those of the stage are not kept by it
        self._files = files
        self._nodes = nodes

    @property
    def scene_text(self) -> str:
        """The scene file. Files of the stage are named by their whole path, own ones by their name."""
        return print_scene(self._nodes, lambda ref: ref.path)

    @property
    def files(self) -> dict[str, bytes]:
        """The files that are written beside the scene, by name."""
        return {name: self._files.content(name) for name in self._files.made}

    def search(self, path: str | os.PathLike[str]) -> list[str]:
        """Folders with files of the stage that the scene, written to `path`, may read only if it is told so: by `--search`, or by
        `abbe.load(path, search=…)`. None where all is in its own folder or project, or in those of $ABBE_PATH."""
        return folders_to_state(foreign_files(self._nodes), Path(path), self._stage)

    def write(self, path: str | os.PathLike[str], force: bool = False) -> None:
        """Writes the scene, and its files into the folder NAME-files beside it.

        Raises FileExistsError where one is there, unless `force`; OSError where it cannot be written.
        """
        target = Path(path)
        folder = target.parent / f"{target.stem}-files"
        if not force:
            for there in (target, *([folder] if self._files.made else [])):
                if there.exists():
                    raise FileExistsError(f"`{there}` is there already: `--force` replaces it")

        def resolve(ref: FileRef) -> str:
            if ref.own:
                return f"{folder.name}/{ref.path}"
            near = os.path.relpath(ref.path, target.parent.resolve())
            return ref.path if near.startswith(os.path.join("..", "..", "..")) else near

        target.parent.mkdir(parents=True, exist_ok=True)
        self._files.write(folder)
        write_atomically(target, [print_scene(self._nodes, resolve).encode()])


@contextmanager
def _no_collection() -> Iterator[None]:
    """Without the collector of cycles: a scene has none, and with many nodes it would go through all of them again and again.

    Afterwards they count as old, as if it had gone through them and found nothing.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if gc.get_freeze_count() == 0:  # else the caller's own frozen objects would be thawed
            gc.freeze()
            gc.unfreeze()
        if was:
            gc.enable()


def load(
    path: str | os.PathLike[str],
    camera: str | None = None,
    frame: float | None = None,
    frames: tuple[float, float] | None = None,
    purposes: Sequence[str] | None = None,
    variants: Sequence[tuple[str, str, str]] = (),
    max_instances: int = 100_000_000,
    report: Report | None = None,
) -> Scene:
    """Reads a stage. Raises StageError, whose report names every fault, where there are any.

    `frame` is a time code; `frames`, the first and the last one, keep the motion of an animation. `variants` are triples of
    the path of a prim (empty: the default prim), a set and a choice.
    """
    report = report or Report()
    options = Options(camera, frame, frames, tuple(purposes) if purposes is not None else None, tuple(variants), max_instances)
    stage = open_stage(os.fspath(path), options, report)
    with quiet(), _no_collection(), _numpy.errstate(all="ignore"):  # sums that tell whether numbers are finite may overflow
        context = Context(stage, options, report)
        nodes = Converter(context).run()
    if report.errors:
        raise StageError(f"{len(report.errors)} errors", report, 3 if all(e.code == "E0401" for e in report.errors) else 1)
    return Scene(report, context.files, nodes, path, stage)
