"""What a scene may read (docs/language/files.md), and which folders its user has to state for the rest."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from .scene_text import FileRef, Node


def project_of(folder: Path) -> Path:
    """The nearest folder around a folder that holds `.abbe-project`; else the folder itself. Links are followed."""
    own = folder.resolve()
    return next((top for top in (own, *own.parents) if (top / ".abbe-project").is_file()), own)


def foreign_files(nodes: Iterable[Node]) -> Iterator[Path]:
    """The files that nodes name and that are not written with the scene. Links are followed."""
    stack = list(nodes)
    while stack:
        node = stack.pop()
        stack += node.children
        for value in node.values:
            if isinstance(value, FileRef) and not value.own:
                yield Path(os.path.realpath(value.path))


def folders_to_state(files: Iterable[Path], scene: Path, stage: Path) -> list[str]:
    """Folders that a scene at `scene` reads and may not by itself: the project of the stage, where that holds the file, else the file's own."""
    environment = [Path(os.path.realpath(one)) for one in os.environ.get("ABBE_PATH", "").split(":") if one]
    allowed = [project_of(scene.parent), *environment]
    of_stage = project_of(stage.parent)
    projects: dict[Path, Path] = {}
    stated: list[Path] = []
    for file in sorted(set(files)):
        if any(file.is_relative_to(top) for top in (*allowed, *stated)):
            continue
        if file.is_relative_to(of_stage):
            stated.append(of_stage)
            continue
        if file.parent not in projects:
            projects[file.parent] = project_of(file.parent)
        stated.append(projects[file.parent])
    return [str(one) for one in stated if not any(one != other and one.is_relative_to(other) for other in stated)]
