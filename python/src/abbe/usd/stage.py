"""Opening a stage: its layers, what does not compose, variants."""

from __future__ import annotations

import difflib
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pxr import Pcp, Sdf, Tf, Usd

from .context import Options
from .report import Report, StageError

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")


@contextmanager
def quiet() -> Iterator[None]:
    """Drops what the libraries of USD print to the standard error: faults are told by the report."""
    sys.stderr.flush()
    try:
        saved = os.dup(2)
    except OSError:
        yield
        return
    try:
        with open(os.devnull, "wb") as nothing:
            os.dup2(nothing.fileno(), 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)


def open_stage(path: str, options: Options, report: Report) -> Usd.Stage:
    """The composed stage. Raises StageError where there is none."""
    if not os.path.isfile(path):
        folder = os.path.dirname(path) or "."
        names = [n for n in os.listdir(folder) if n.endswith(SUFFIXES)] if os.path.isdir(folder) else []
        near = difflib.get_close_matches(os.path.basename(path), names, 1, 0.5)
        report.error("E0401", None, f"there is no file `{path}`", f"did you mean `{near[0]}`?" if near else "look at its name")
        raise StageError("no file", report, 3)
    is_known = bool(Sdf.Layer.Find(path))  # somebody holds it
    said: list[str] = []
    with quiet():
        try:
            stage = Usd.Stage.Open(path)
            if stage is not None and is_known:
                stage.Reload()  # what has changed in files since then
        except Tf.ErrorException as fault:
            stage = None
            said += [str(e.commentary) for e in fault.args]
    if stage is None:
        why = next((line.strip() for line in said if line.strip()), "its bytes are none of USD")
        report.error("E0801", None, f"`{path}` cannot be read as USD", _plain(why))
        raise StageError("no stage", report)
    _select_variants(stage, options, report)
    _composition(stage, report)
    return stage


def _plain(text: str) -> str:
    """The message of a diagnostic of USD without where in its sources it was raised."""
    for mark in (" -- ", "Error in '"):
        if mark in text:
            text = text.split(mark, 1)[1]
    return text[:400]


def _select_variants(stage: Usd.Stage, options: Options, report: Report) -> None:
    """Choices of the command line, in the session: nothing of the stage changes."""
    for path, set_name, choice in options.variants:
        prim = stage.GetPrimAtPath(path) if path else stage.GetDefaultPrim()
        if not prim.IsValid():
            report.error("E0802", None, f"there is no prim `{path or 'default prim'}` for the variant {set_name}={choice}", "write path:set=choice")
            continue
        if not prim.GetVariantSets().HasVariantSet(set_name):
            names = ", ".join(prim.GetVariantSets().GetNames()) or "none"
            report.error("E0802", prim, f"there is no variant set `{set_name}`", f"it has {names}")
            continue
        variants = prim.GetVariantSet(set_name)
        if choice not in variants.GetVariantNames():
            report.error("E0802", prim, f"`{set_name}` has no variant `{choice}`", f"it has {', '.join(variants.GetVariantNames())}")
            continue
        target = stage.GetEditTarget()
        stage.SetEditTarget(stage.GetSessionLayer())
        variants.SetVariantSelection(choice)
        stage.SetEditTarget(target)


def _composition(stage: Usd.Stage, report: Report) -> None:
    """What does not compose: missing layers, cycles of references, and so on, each with its prim."""
    for error in stage.GetCompositionErrors():
        path = Sdf.Path(str(getattr(error, "rootSite", "") or "").rsplit("<", 1)[-1].rstrip(">") or "/")
        prim = stage.GetPrimAtPath(path.GetPrimPath()) if path.IsAbsolutePath() else None
        prim = prim if prim is not None and prim.IsValid() and path != Sdf.Path("/") else None
        code, what = _kind_of(error)
        report.error(code, prim, what, _plain(str(error)).replace("\n", " "))


def _kind_of(error: Any) -> tuple[str, str]:
    """The code of an error of composition, and what is wrong. Its message names the file between @."""
    kind = error.errorType
    asset = re.search(r"@([^@]+)@", str(error))
    name = asset[1] if asset else "?"
    if kind == Pcp.ErrorType_InvalidAssetPath:
        return "E0401", f"there is no layer `{name}`"
    if kind == Pcp.ErrorType_InvalidSublayerPath:
        return "E0401", f"there is no sublayer `{name}`"
    if kind in (Pcp.ErrorType_ArcCycle, Pcp.ErrorType_SublayerCycle):
        return "E0802", "a cycle of references"
    return "E0802", "the stage does not compose"
