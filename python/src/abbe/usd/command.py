"""The command `abbe-usd`."""

from __future__ import annotations

import argparse
import json
import re
import shlex
import sys
import traceback
from pathlib import Path
from typing import NoReturn

WRONG_ARGUMENTS, NO_FILE, WARNINGS, NO_MEMORY, BUG, INTERRUPTED = 2, 3, 4, 5, 70, 130  # exit codes, those of `abbe`


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        sys.stderr.write(f"abbe-usd: {message}\n`abbe-usd --help` lists what there is.\n")
        raise SystemExit(WRONG_ARGUMENTS)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="abbe-usd", description="Writes an OpenUSD stage as a scene of Abbe, or the reverse.", allow_abbrev=False)
    parser.add_argument("stage", help="the stage: .usd, .usda, .usdc or .usdz; with --to a scene")
    parser.add_argument("--to", metavar="STAGE", help="write the scene as this stage, .usda or .usdc, by `abbe export`")
    parser.add_argument("-o", "--output", metavar="FILE", help="scene to write; without it beside the stage, with .scene")
    parser.add_argument("--camera", metavar="PATH", help="camera to render; without it that of the render settings, else the first")
    when = parser.add_mutually_exclusive_group()
    when.add_argument("--frame", type=float, metavar="N", help="time code of a still; without it the first one of the stage")
    when.add_argument("--frames", metavar="A-B", help="keep the motion of these frames, for `abbe render --frames`")
    parser.add_argument("--purpose", metavar="LIST", help="purposes that are shown, such as render,default")
    parser.add_argument("--variant", action="append", default=[], metavar="[PATH:]SET=CHOICE", help="choose a variant; may be repeated")
    parser.add_argument("--max-instances", type=int, default=100_000_000, metavar="N", help="most instances of a point instancer")
    parser.add_argument("--force", action="store_true", help="replace files that are there")
    parser.add_argument("--strict", action="store_true", help="exit with 4 if anything is left out or approximated; nothing is written")
    parser.add_argument("--json", action="store_true", help="the report as JSON on the standard output")
    return parser


def _frames(text: str) -> tuple[float, float]:
    found = re.fullmatch(r"(-?[0-9.]+)-(-?[0-9.]+)", text)
    if not found:
        raise ValueError(f"`{text}` is no range of frames: write `--frames 1-48`")
    first, last = float(found[1]), float(found[2])
    if last < first:
        raise ValueError(f"`{text}` ends before it begins")
    return first, last


def _variant(text: str) -> tuple[str, str, str]:
    head, equals, choice = text.partition("=")
    path, _, name = head.rpartition(":")
    if not equals or not name or not choice:
        raise ValueError(f"`{text}` is no variant: write `--variant /Car:colour=red`, or `colour=red` of the default prim")
    return path, name, choice


def run(arguments: list[str]) -> int:
    """Returns the exit code."""
    given = _parser().parse_args(arguments)
    if given.to:
        return _reverse(given)
    try:
        frames = _frames(given.frames) if given.frames else None
        variants = [_variant(v) for v in given.variant]
        from . import Report, StageError, load
    except ValueError as fault:
        sys.stderr.write(f"abbe-usd: {fault}\n")
        return WRONG_ARGUMENTS
    except ImportError as fault:
        sys.stderr.write(f"abbe-usd: {fault}\n")
        return NO_FILE

    report = Report()
    output = Path(given.output) if given.output else Path(given.stage).with_suffix(".scene")
    purposes = [p.strip() for p in given.purpose.split(",")] if given.purpose else None
    code, search = 0, []
    try:
        scene = load(given.stage, given.camera, given.frame, frames, purposes, variants, given.max_instances, report)
        if given.strict and report.warning_count:
            code = WARNINGS
        else:
            scene.write(output, given.force)
            search = scene.search(output)
    except StageError as fault:
        code = fault.exit_code
    except OSError as fault:
        report.error("E0402", None, "the scene cannot be written", str(fault))
        code = NO_FILE
    _finish(given.json, str(output), report, code, search)
    return code


def _reverse(given: argparse.Namespace) -> int:
    others = {
        "output": "-o",
        "camera": "--camera",
        "frame": "--frame",
        "frames": "--frames",
        "purpose": "--purpose",
        "variant": "--variant",
        "strict": "--strict",
    }
    for name, flag in others.items():
        if getattr(given, name) not in (None, [], False):
            sys.stderr.write(f"abbe-usd: `{flag}` belongs to reading stages; it does not go with `--to`\n")
            return WRONG_ARGUMENTS
    try:
        from .reverse import write_stage

        return write_stage(given.stage, Path(given.to), given.force, given.json)
    except ValueError as fault:
        sys.stderr.write(f"abbe-usd: {fault}\n")
        return WRONG_ARGUMENTS
    except (ImportError, OSError) as fault:
        sys.stderr.write(f"abbe-usd: {fault}\n")
        return NO_FILE


def _finish(as_json: bool, output: str, report: object, code: int, search: list[str]) -> None:
    from . import Report

    assert isinstance(report, Report)
    written = output if code == 0 else None
    if as_json:
        text = {"scene": written, "search": search, "exit": code, "warnings": report.warning_count, "errors": len(report.errors), **report.as_json()}
        sys.stdout.write(json.dumps(text, indent=2, ensure_ascii=False) + "\n")
        return
    for remark in report.remarks:
        sys.stderr.write(f"{remark}\n")
    summary = report.summary()
    if summary:
        sys.stdout.write(summary + "\n")
    count = f"{report.warning_count} warnings, {len(report.errors)} errors"
    if not written:
        sys.stdout.write(f"nothing is written   {count}\n")
        return
    words = "".join(f" --search {shlex.quote(folder)}" for folder in search)
    sys.stdout.write(f"scene {output}   {count}; next: abbe render {shlex.quote(output)}{words}\n")


def main() -> NoReturn:
    try:
        code = run(sys.argv[1:])
    except MemoryError:
        sys.stderr.write("abbe-usd: out of memory\n")
        code = NO_MEMORY
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception:
        sys.stderr.write(f"{traceback.format_exc()}abbe-usd: this is a bug of the program\n")
        code = BUG
    raise SystemExit(code)


if __name__ == "__main__":
    main()
