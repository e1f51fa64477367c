"""Photometric files (IES LM-63, type C): the shaping of lights as one, and profiles brought to the brightness of a light."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from pxr import Usd

from .context import Context
from .scene_text import FileRef

STEP = 0.5  # degrees
MAX_BYTES = 64 << 20


def smoothstep(low: float, high: float, x: float) -> float:
    if high <= low:
        return 0.0 if x < low else 1.0
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def cone_profile(ctx: Context, prim: Usd.Prim, candela: float, angle: float, softness: float, focus: float, flat: bool) -> FileRef:
    """Intensity by the angle with the axis: cos^focus within the cone; times the cosine for what is flat."""
    angles = [i * STEP for i in range(int(180 / STEP) + 1)]
    inner = angle * (1 - softness)
    values = []
    for a in angles:
        cosine = max(0.0, math.cos(math.radians(a)))
        if angle >= 180 and focus == 0 and not flat:
            cosine = 1.0
        weight = (cosine if flat else 1.0) * (cosine**focus if focus > 0 else 1.0)
        within = 0.0 if a > angle else 1 - smoothstep(inner, angle, a) if softness > 0 else 1.0
        values.append(candela * weight * within)
    text = ["IESNA:LM-63-2002", "TILT=NONE", f"1 -1 1 {len(angles)} 1 1 2 0 0 0", "1 1 0"]
    text += [" ".join(f"{a:g}" for a in angles), "0", " ".join(f"{v:.9g}" for v in values)]
    return ctx.files.add(str(prim.GetPath()), "ies", [("\n".join(text) + "\n").encode()])


def _content(ctx: Context, ref: FileRef) -> str:
    if ref.own:
        return ctx.files.content(ref.path).decode("latin-1")
    path = Path(ref.path)
    if path.stat().st_size > MAX_BYTES:
        raise ValueError("it has more than 64 MB")
    return path.read_text("latin-1")


def scaled_profile(ctx: Context, prim: Usd.Prim, ref: FileRef, candela: float, normalized: bool) -> FileRef | None:
    """A copy of a profile whose values are those of the file times `candela`.

    `normalized`: first divided by their mean over all directions, so that the light keeps its power.
    """
    try:
        text = _content(ctx, ref)
        head, numbers, at = _numbers(text)
        factor = candela / (_mean(numbers, at) if normalized else 1.0)
    except (OSError, ValueError, IndexError, OverflowError) as fault:
        ctx.report.error("E0402", prim, f"`{ref.path}` cannot be read as a profile", str(fault) or "numbers are missing")
        return None
    numbers[at + 2] *= factor  # the candela multiplier
    body = [numbers[at : at + 10], numbers[at + 10 : at + 13], numbers[at + 13 :]]
    lines = [head, *(" ".join(f"{x:.9g}" for x in part) for part in body if len(part))]
    return ctx.files.add(str(prim.GetPath()), "ies", [("\n".join(lines) + "\n").encode("latin-1", "replace")])


def _numbers(text: str) -> tuple[str, list[float], int]:
    """What stands up to TILT=NONE, and the numbers behind it."""
    lines = text.splitlines()
    tilt = next((i for i, line in enumerate(lines) if line.strip().upper().startswith("TILT=")), None)
    if tilt is None:
        raise ValueError("there is no TILT=")
    if lines[tilt].strip().upper() != "TILT=NONE":
        raise ValueError("TILT=NONE alone can be scaled")
    numbers = [float(word) for word in " ".join(lines[tilt + 1 :]).replace(",", " ").split()]
    if len(numbers) < 13:
        raise ValueError("numbers are missing")
    return "\n".join(lines[: tilt + 1]), numbers, 0


def _mean(numbers: list[float], at: int) -> float:
    """Candela over 4π: by the trapezoid in the cosine of the vertical angle, even over the horizontal ones."""
    vertical, horizontal = int(numbers[at + 3]), int(numbers[at + 4])
    if not (0 < vertical < 10**6 and 0 < horizontal < 10**6):
        raise ValueError("numbers of angles that make no sense")
    first = at + 13
    v = np.radians(numbers[first : first + vertical])
    h = np.radians(numbers[first + vertical : first + vertical + horizontal])
    table = np.array(numbers[first + vertical + horizontal : first + vertical + horizontal + vertical * horizontal])
    rows = table.reshape(horizontal, vertical) * numbers[at + 2]
    over_v = np.array([np.sum((row[1:] + row[:-1]) / 2 * (np.cos(v[:-1]) - np.cos(v[1:]))) for row in rows])
    mean_h = over_v[0] if horizontal == 1 else np.sum((over_v[1:] + over_v[:-1]) / 2 * np.diff(h)) / (h[-1] - h[0])
    mean = float(mean_h) / 2
    if not mean > 0:
        raise ValueError("it gives no light")
    return mean
