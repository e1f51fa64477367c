#!/usr/bin/env python3
"""Abbe beside other renderers, at equal time: how much error is left in the same scenes.

  peers.py ABBE [--scene NAME]… [--size N] [--seconds S] [--seeds K] [--markdown docs/performance.md] [--readme README.md] [--html FILE]

Renders every scene of scenes.py with every renderer that is here, in turn, K times with other seeds, each render with about S
core-seconds, and prints a table. All run on one thread.

* relMSE: mean of (x − r)² / (r² + 0.01) over pixels and channels, of images scaled to a mean of 0.25. Each renderer is judged
  against its own renders (figures.py), the r of the divisor being that of the renderer with the least error of all others; one
  that is biased against the mean of Abbe's, so that its bias counts.
* Efficiency: 1 / (relMSE × core-seconds), with the spread of leaving out one seed at a time (jackknife, two standard errors).
  "trimmed" leaves out the worst 0.1 % of the pixels.
* Core-seconds are those of rendering, with all pilots and plans; loading and compiling kernels stand apart.
* "differs" is how far the means of 16 × 16 parts of the picture are from Abbe's, noise included: whether it is the same scene.

Needs a Python with bench/peers/requirements.txt. `llvm_ad_spectral` needs an LLVM that can compile it: Debian's libllvm19, or
$DRJIT_LIBLLVM_PATH. A renderer that cannot be had is named in the table's foot.
"""
import argparse
import datetime
import os
import pathlib
import re
import subprocess
import tempfile
import time

import numpy as np

import figures
import renderers
import report
import scenes as bench

NOTES = ["Efficiency is 1 / (relMSE × core-seconds); intervals are two standard errors. The bold ratio is Abbe's efficiency over that of the "
         "best unbiased peer. What is biased is judged against Abbe's mean."]

MARKDOWN, README = "six scenes", "short" # blocks


ANOTHER_SCENE = 0.2 # of coarse difference: Mitsuba's `ptracer` shows glass black, and errors divided by black are large


def cleanest(scene, running, but, abbe):
    """Renders of the unbiased renderer with the least error that shows what Abbe shows, but not of that one; None if there is no other."""
    found = [(np.mean(list(figures.errors_between(images, scene.region).values())), images) for renderer, _, images, _ in running
             if renderer is not but and not renderer.biased and renderer.family != "yardstick"
             and not (abbe and figures.coarse_difference(images, abbe) > ANOTHER_SCENE)]
    return min(found, key=lambda pair: pair[0], default=(0, None))[1]


def measured(scene, renderer, images, seconds, others, abbe):
    """A row of the table. `others` are what the error is divided by, `abbe` Abbe's renders, if there are any."""
    if others and others[0].shape != images[0].shape:
        others = None # the yardstick has a size of its own
    errors = figures.errors_against(images, abbe, scene.region) if renderer.biased and len(abbe) > 1 else \
        figures.errors_between(images, scene.region, others)
    value, spread, trimmed = figures.efficiency(errors, seconds)
    return {"scene": scene.name, "renderer": renderer.name, "family": renderer.family, "biased": renderer.biased, "samples": renderer.samples,
            "core_seconds": float(np.mean(seconds)), "efficiency": value, "spread": spread, "trimmed": trimmed, "version": renderer.version,
            "off": figures.coarse_difference(images, abbe) if abbe else 0, "load_seconds": renderer.load,
            "first_seconds": renderer.first, "peak_mib": renderer.peak}


def picture(images):
    """PNG of the mean, as bright as all others."""
    mean = np.mean(images, axis=0)
    linear = np.clip(mean * 0.2 / mean.mean(), 0, 1)
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    height, width = mean.shape[:2]
    return report.png(width, height, np.round(255 * encoded).astype(np.uint8).tobytes())


def exported(abbe, path):
    """What the other renderers read."""
    if path.suffix != ".scene":
        return path
    made = path.with_suffix(".xml")
    subprocess.run([abbe, "export", str(path), "--to", "mitsuba", "-o", str(made), "--force"], check=True, capture_output=True)
    return made


def through_gltf(abbe, scene, path, size, folder):
    """A scene and a GLB that show the same: what the export lost, both have lost."""
    glb, back = folder / f"{scene.name}.glb", folder / f"{scene.name}.scene"
    for words in (["export", str(path), "--to", "gltf", "-o", str(glb)], ["import", str(glb), "-o", str(back)]):
        subprocess.run([abbe, *words], check=True, capture_output=True)
    text, found = re.subn(r"film \{ size \d+ \d+ \}", f'film {{ filter box 0.5; size {size} {round(size * scene.aspect)}; '
                          f'output "x.exr" space=rec709 }}\nrender {{ max-depth {scene.depth} }}', back.read_text(), count=1)
    if not found:
        raise RuntimeError(f"{back.name} has no film to change")
    back.write_text(text)
    return back, glb


def compare(scene, options, folder):
    """Rows, what could not be compared, and pictures by scene and renderer."""
    path = scene.write(folder, options.size, scene.depth)
    path, other = through_gltf(options.abbe, scene, path, options.size, folder) if scene.gltf else (path, exported(options.abbe, path))
    running, missing = [], []

    def failed(renderer, error):
        missing.append(f"{renderer.name}, {scene.name}: {(str(error).strip() or 'no answer').splitlines()[-1]}")
        renderer.close()

    for renderer in renderers.all_of(scene, options):
        try:
            renderer.open(path if renderer.family == "Abbe" else other, scene.depth, options.size, folder)
            running.append((renderer, figures.samples_for(renderer, options.seconds), [], []))
        except (RuntimeError, OSError) as error:
            failed(renderer, error)
    for seed in range(1, options.seeds + 1):
        for entry in list(running):
            renderer, samples, images, seconds = entry
            try:
                image, spent = renderer.render(samples, seed)
                images.append(image)
                seconds.append(spent)
            except (RuntimeError, OSError) as error:
                failed(renderer, error)
                running.remove(entry)
    abbe = next((images for renderer, _, images, _ in running if renderer.family == "Abbe"), [])
    rows = [measured(scene, renderer, images, seconds, cleanest(scene, running, renderer, abbe), abbe) for renderer, _, images, seconds in running]
    for renderer, *_ in running:
        renderer.close()
    return rows, missing, {(scene.name, renderer.name): picture(images) for renderer, _, images, _ in running}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe")
    parser.add_argument("--scene", action="append", choices=[s.name for s in bench.SCENES + bench.EXTRA])
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--seconds", type=float, default=20, help="core-seconds of one render")
    parser.add_argument("--seeds", type=int, default=4, help="at least 2; intervals need 3")
    parser.add_argument("--variants", nargs="*", default=["llvm_ad_spectral", "scalar_spectral"], help="of Mitsuba")
    parser.add_argument("--yardstick", nargs=2, metavar=("PROGRAM", "SPECTRA"), help="a bare path tracer of the Cornell box")
    parser.add_argument("--markdown", help="file with a place for the table (docs/performance.md)")
    parser.add_argument("--readme", help="file with a place for the short table (README.md)")
    parser.add_argument("--html", help="page with the table and all pictures")
    options = parser.parse_args()
    if options.seeds < 2:
        parser.error("--seeds: error is told from the difference of two renders at least")
    try:
        import mitsuba as _ # reads Abbe's pictures
        for file, name in ((options.markdown, MARKDOWN), (options.readme, README)):
            if file:
                report.block(file, name)
    except (ImportError, RuntimeError) as error: # now, not after half an hour
        parser.error(f"{error}; Python packages are those of bench/peers/requirements.txt" if isinstance(error, ImportError) else str(error))
    options.abbe = os.path.abspath(options.abbe)
    return options


def main():
    options = arguments()
    rows, missing, pictures = [], [], {}
    chosen = [scene for scene in bench.SCENES + bench.EXTRA if scene.name in (options.scene or [s.name for s in bench.SCENES])]
    with tempfile.TemporaryDirectory() as folder:
        for scene in chosen:
            started = time.time()
            found, failed, shown = compare(scene, options, pathlib.Path(folder))
            rows, missing, pictures = rows + found, missing + failed, pictures | shown
            print(report.table(found, failed), f"\n({scene.about}; {time.time() - started:.0f} s)\n", flush=True)
    abouts = {scene.name: scene.about for scene in chosen}
    run = {"size": options.size, "seconds": options.seconds, "seeds": options.seeds, "date": datetime.date.today().strftime("%d %B %Y"),
           "versions": {row["family"]: row["version"] for row in rows}}
    if options.html:
        pathlib.Path(options.html).write_text(report.page(rows, missing, run, pictures, abouts, NOTES))
    if options.markdown:
        report.write_block(options.markdown, MARKDOWN, f"{report.about(run)}\n\n{report.table(rows, missing)}")
    if options.readme:
        report.write_block(options.readme, README, f"{report.short_table(rows, abouts)}\n\n{report.about(run)}")


if __name__ == "__main__":
    main()
