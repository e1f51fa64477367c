"""Scenes as stages: the program `abbe` writes them as text, and crates are made of that (docs/decisions)."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from pxr import Sdf, Tf

TEXT, CRATE = (".usda",), (".usdc", ".usd")


def find_program() -> str | None:
    """The program `abbe`: $ABBE, else that of the PATH."""
    named = os.environ.get("ABBE")
    return named if named else shutil.which("abbe")


def write_stage(scene: str, target: Path, force: bool, as_json: bool) -> int:
    """Writes a scene as a stage; returns the exit code of the program, whose messages go where ours go.

    Raises ValueError for another ending than those of USD, OSError where the program is missing or the stage cannot be written.
    """
    if target.suffix not in (*TEXT, *CRATE):
        raise ValueError(f"`{target}` ends in none of {', '.join((*TEXT, *CRATE))}")
    if target.exists() and not force:
        raise ValueError(f"`{target}` is there already: `--force` replaces it")
    program = find_program()
    if program is None:
        raise OSError("there is no program `abbe` on the PATH, and $ABBE names none")
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.suffix in TEXT:
        return _export(program, scene, target, as_json)
    # Beside the target, so that paths of pictures are the same.
    handle, name = tempfile.mkstemp(prefix=f".{target.stem}.", suffix=".usda", dir=target.parent)
    os.close(handle)
    try:
        code = _export(program, scene, Path(name), as_json)
        if code == 0:
            _convert(name, target)
        return code
    finally:
        with contextlib.suppress(OSError):
            os.unlink(name)


def _export(program: str, scene: str, target: Path, as_json: bool) -> int:
    words = [program, "export", scene, "--to", "usda", "-o", str(target), "--force", *(["--json"] if as_json else [])]
    sys.stdout.flush()
    try:
        return subprocess.run(words, stdin=subprocess.DEVNULL).returncode
    except OSError as fault:
        raise OSError(f"`{program}` cannot be started: {fault.strerror}") from fault


def _convert(text: str, target: Path) -> None:
    made = target.with_name(f".{target.name}.{os.getpid()}{target.suffix}")
    try:
        layer = Sdf.Layer.OpenAsAnonymous(text)
        if not layer or not layer.Export(str(made), args={"format": "usdc"} if target.suffix == ".usd" else {}):
            raise OSError(f"`{target}` cannot be written")
        os.replace(made, target)
    except Tf.ErrorException as fault:
        raise OSError(f"`{target}` cannot be written: {fault}") from fault
    finally:
        with contextlib.suppress(OSError):
            os.unlink(made)
