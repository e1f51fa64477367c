#!/usr/bin/env python3
"""Renders small scenes with Mitsuba and with Abbe's import of them, and tests tile by tile whether they agree.

  mitsuba_compare.py ABBE [--export] [--only PART] [--nightly] [--keep FOLDER] [--list]

With --export it is the other way round: scenes of Abbe's, and what `abbe export --to mitsuba` makes of them.

Of every case both programs render several pictures with independent random numbers. A tile's mean has the variance that
its pixels show between them. The difference of two tiles is compared with its standard error, to which the relative
difference that the case allows is added. The bound on the ratio was fixed before: with 64 tiles, three channels and
about 150 cases, 5.5 standard errors are passed by chance in one run of a thousand. Exit code 77: there is no Mitsuba.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import mitsuba_cases
import mitsuba_export_cases

BOUND = 5.5
RENDERS = 3
TILE = 8


def render_mitsuba(mi, np, case, path):
    mi.set_variant(case.variant)
    scene = mi.load_file(str(path))
    pictures = []
    for seed in range(RENDERS):
        image = mi.render(scene, spp=case.spp, seed=seed + 1)
        pictures.append(np.array(image, dtype=np.float64)[:, :, :3])
    return np.stack(pictures)


def render_abbe(mi, np, case, path, abbe):
    pictures = []
    for seed in range(RENDERS):
        out = path.with_suffix(f".{seed}.exr")
        done = subprocess.run([abbe, "render", str(path), "-o", str(out), "--png", "off", "--samples", str(case.spp),
                               "--seed", str(seed + 11), "--quiet", "--checkpoint", "off"], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr[-2000:])
        bitmap = mi.Bitmap(str(out))
        names = [field.name for field in bitmap.struct_()]
        values = np.array(bitmap, dtype=np.float64)
        pictures.append(values[:, :, [names.index(c) for c in "RGB"]])
    return np.stack(pictures), done.stderr


def exported(path, abbe):
    made = path.with_suffix(".xml")
    done = subprocess.run([abbe, "export", str(path), "--to", "mitsuba", "-o", str(made), "--force"], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr[-2000:])
    return made


def tile_means(np, pictures):
    """Mean and variance of the mean of every tile and channel."""
    count, height, width, channels = pictures.shape
    mean, variance = pictures.mean(0), pictures.var(0, ddof=1) / count
    rows, columns = height // TILE, width // TILE

    def tiles(values):
        cut = values[: rows * TILE, : columns * TILE]
        return cut.reshape(rows, TILE, columns, TILE, channels)

    return tiles(mean).mean((1, 3)), tiles(variance).sum((1, 3)) / TILE**4


def compare(np, case, theirs, ours):
    if theirs.shape != ours.shape:
        return float("inf"), f"sizes {theirs.shape} and {ours.shape}"
    a, va = tile_means(np, theirs)
    b, vb = tile_means(np, ours)
    scale = np.abs(a).mean()
    allowed = case.tolerance * np.maximum(np.abs(a), np.abs(b)) + (case.floor + 1e-4) * scale
    excess = np.maximum(0, np.abs(a - b) - allowed)
    ratio = excess / np.sqrt(va + vb + (1e-6 * scale) ** 2)
    worst = np.unravel_index(np.argmax(ratio), ratio.shape)
    text = f"mean {a.mean():.4g} and {b.mean():.4g}, worst tile {worst[0]},{worst[1]} {a[worst]:.4g} and {b[worst]:.4g}"
    return float(ratio[worst]), text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("abbe")
    parser.add_argument("--only", default="")
    parser.add_argument("--nightly", action="store_true")
    parser.add_argument("--keep")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--export", action="store_true")
    options = parser.parse_args()
    options.nightly = options.nightly or bool(os.environ.get("ABBE_NIGHTLY"))
    all_cases = mitsuba_export_cases.CASES if options.export else mitsuba_cases.CASES
    cases = [c for c in all_cases if options.only in c.name and (options.nightly or not c.nightly)]
    if options.list:
        for c in cases:
            print(f"{c.name:28} {c.variant:16} {c.tolerance:6.3f} {c.reason}")
        return 0
    try:
        import mitsuba as mi
        import numpy as np
    except ImportError:
        print("skipped: no Mitsuba; pip install -r tests/exchange/requirements.txt, and name that Python in ABBE_PEER_PYTHON")
        return 77
    folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="abbe-mitsuba-"))
    folder.mkdir(parents=True, exist_ok=True)
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    mitsuba_cases.write_files(mi, np, folder)
    failed = []
    begun, spent = time.time(), os.times()
    for case in cases:
        path = folder / f"{case.name}.{'scene' if options.export else 'xml'}"
        path.write_text(case.xml)
        try:
            if options.export:
                ours, _ = render_abbe(mi, np, case, path, options.abbe)
                theirs = render_mitsuba(mi, np, case, exported(path, options.abbe))
            else:
                theirs = render_mitsuba(mi, np, case, path)
                ours, _ = render_abbe(mi, np, case, path, options.abbe)
            ratio, text = compare(np, case, theirs, ours)
        except Exception as fault:  # whatever fails, the other cases count
            ratio, text = float("inf"), str(fault).strip()[-600:]
        good = ratio <= BOUND
        if not good:
            failed.append(case.name)
        print(f"{'ok  ' if good else 'FAIL'} {case.name:28} {ratio:8.2f}  {text}", flush=True)
        if options.keep and ratio < float("inf"):
            save_picture(mi, np, folder / f"{case.name}.png", theirs, ours)
    now = os.times()
    cpu = sum(now[:4]) - sum(spent[:4])
    print(f"{len(cases)} cases, {len(failed)} differ, {time.time() - begun:.0f} s, {cpu:.0f} s of CPU")
    return 1 if failed else 0


def save_picture(mi, np, path, theirs, ours):
    """Both side by side, then ten times their difference about grey."""
    a, b = theirs.mean(0), ours.mean(0)
    if a.shape != b.shape:
        return
    white = max(1e-9, np.percentile(a, 99))
    picture = np.concatenate([a / white, b / white, 0.5 + 5 * (b - a) / white], 1)
    picture = np.repeat(np.repeat(np.clip(picture, 0, 1), 3, 0), 3, 1).astype(np.float32)
    mi.Bitmap(picture).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True).write(str(path))


if __name__ == "__main__":
    sys.exit(main())
