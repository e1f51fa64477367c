"""Files that a stage names: pictures, profiles, volumes; also those inside of packages (.usdz)."""

from __future__ import annotations

import difflib
import os
import re
import zipfile
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf

from .context import Context
from .scene_text import FileRef

MAX_PACKED = 4 << 30  # bytes of one file of a package


def resolve_asset(ctx: Context, prim: Any, asset: Sdf.AssetPath, attribute: Any = None) -> FileRef | None:
    """Where a file is. E0401 and None if it is not there, with a name that is similar."""
    if "<UDIM>" in asset.path:
        return _tiles(ctx, prim, asset, attribute)
    path = asset.resolvedPath
    if path and Ar.IsPackageRelativePath(path):
        return _unpacked(ctx, prim, path)
    if path and os.path.isfile(path):
        return FileRef(os.path.abspath(path))
    ctx.report.error("E0401", prim, f"there is no file `{asset.path}`", _similar(_anchored(prim, asset.path, attribute)))
    return None


def _anchored(prim: Any, path: str, attribute: Any) -> str:
    """The path as seen from the layer that states it."""
    stack = attribute.GetPropertyStack() if attribute is not None else []
    layer = stack[0].layer if stack else prim.GetStage().GetRootLayer()
    found = str(layer.ComputeAbsolutePath(path))
    if os.path.isabs(found) or not layer.realPath:
        return found
    return os.path.join(os.path.dirname(layer.realPath), path)


def _similar(path: str) -> str:
    folder = Path(path).parent
    try:
        names = [entry.name for entry in os.scandir(folder)]
    except OSError:
        return f"neither is the folder `{folder}`"
    near = difflib.get_close_matches(Path(path).name, names, 1, 0.6)
    return f"did you mean `{near[0]}`?" if near else f"it was looked for as `{path}`"


def _tiles(ctx: Context, prim: Any, asset: Sdf.AssetPath, attribute: Any) -> FileRef | None:
    pattern = _anchored(prim, asset.path, attribute)
    if Ar.IsPackageRelativePath(pattern):
        ctx.report.left_out(prim, f"the tiles `{asset.path}`", "tiles inside of a package are not read: unpack it")
        return None
    folder, name = os.path.split(pattern)
    matcher = re.compile(re.escape(name).replace(re.escape("<UDIM>"), r"1\d\d\d") + r"\Z")
    try:
        found = any(matcher.match(entry.name) for entry in os.scandir(folder))
    except OSError:
        found = False
    if not found:
        ctx.report.error("E0401", prim, f"there is no file `{asset.path}`", f"no tile of it lies in `{folder}`")
        return None
    return FileRef(os.path.abspath(pattern))


def _unpacked(ctx: Context, prim: Any, path: str) -> FileRef | None:
    """A file of a package, written beside the scene."""
    package, inside = Ar.SplitPackageRelativePathOuter(path)
    try:
        if Ar.IsPackageRelativePath(inside):
            raise OSError("a package in a package")
        with zipfile.ZipFile(package) as archive:
            entry = archive.getinfo(inside)
            if entry.file_size > MAX_PACKED:
                raise OSError(f"it has {entry.file_size} bytes")
            content = archive.read(entry)
    except (OSError, KeyError, zipfile.BadZipFile) as fault:
        ctx.report.error("E0402", prim, f"`{inside}` of `{package}` cannot be read", str(fault))
        return None
    stem, extension = os.path.splitext(os.path.basename(inside))
    return ctx.files.add(stem, extension.lstrip(".") or "bin", [content])
