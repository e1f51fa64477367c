#!/usr/bin/env python3
"""Abbe beside other renderers, at equal time: how much error is left in the same scenes.

  peers.py ABBE [--scene NAME]… [--size N] [--seconds S] [--seeds K] [--keep FOLDER] [--markdown FILE]

Renders every scene of scenes.py with every renderer that is here, in turn, K times with other seeds, each render with about S
core-seconds, and prints a table. All run on one thread.

* relMSE: mean of (x − r)² / (r² + 0.01) over pixels and channels, of images scaled to a mean of 0.25. Each renderer is judged
  against its own renders: half of (a − b)² of two seeds is the error without that of a reference, which is the mean of all.
* Efficiency: 1 / (relMSE × core-seconds), with the spread of leaving out one seed at a time (jackknife, two standard errors).
  "trimmed" leaves out the worst 0.1 % of the pixels.
* Core-seconds are those of rendering, with all pilots and plans of Abbe's; loading and compiling kernels stand apart.

Needs Python with mitsuba and numpy (`tests/exchange/requirements.txt`). `llvm_ad_spectral` needs an LLVM that can compile it: Debian's
libllvm19, or $DRJIT_LIBLLVM_PATH. A renderer that cannot be had is named in the table's foot.
"""
import argparse
import glob
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import scenes as bench

HERE = pathlib.Path(__file__).resolve().parent


class Abbe:
    name = "Abbe"

    def __init__(self, program):
        self.program = program

    def open(self, path, size, folder):
        self.path, self.size, self.folder = path, size, folder

    def render(self, samples, seed):
        out = self.folder / f"abbe-{seed}.exr"
        command = [self.program, "render", str(self.path), "--samples", str(samples), "--seed", str(seed), "-t", "1", "--json",
                   "--checkpoint", "off", "--png", "off", "--size", f"{self.size}x{self.size}", "-o", str(out)]
        # By a shell, which forks: else the peak would begin with the memory of this program.
        done = subprocess.run(["sh", "-c", '"$@"; exit $?', "sh", *command], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr[-1500:] or done.stdout[-1500:])
        end = json.loads(done.stdout.strip().splitlines()[-1])
        self.load = end["seconds"] - end["render_seconds"]
        self.peak = end["memory_bytes"] / 2 ** 20
        return read_exr(out), end["core_seconds"] # with those of pilots

    def close(self):
        pass


def read_exr(path):
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    return np.array(bitmap, dtype=np.float64)[:, :, [names.index(c) for c in "RGB"]]


class Mitsuba:
    def __init__(self, variant, integrator=None):
        self.variant, self.integrator = variant, integrator
        self.name = f"Mitsuba {variant}" + (f", {integrator}" if integrator else "")

    def open(self, path, _size, folder):
        environment = dict(os.environ)
        if self.variant.startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in environment:
            for library in glob.glob("/usr/lib/*/libLLVM.so.19*"):
                environment["DRJIT_LIBLLVM_PATH"] = library
        environment["OMP_NUM_THREADS"] = environment["DRJIT_THREADS"] = "1"
        words = [sys.executable, str(HERE / "mitsuba_peer.py"), self.variant, str(path)]
        self.folder = folder
        self.process = subprocess.Popen(words + ([self.integrator] if self.integrator else []), stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment)
        self.load = self.answer()["load_seconds"]

    def answer(self):
        line = self.process.stdout.readline()
        if line:
            return json.loads(line)
        raise RuntimeError(f"{self.name} ended with {self.process.wait()}")

    def render(self, samples, seed):
        out = self.folder / "mitsuba.npy"
        self.process.stdin.write(f"{samples} {seed} {out}\n")
        self.process.stdin.flush()
        answer = self.answer()
        self.peak = answer["peak_mib"]
        return np.load(out).astype(np.float64), answer["core_seconds"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def samples_for(renderer, seconds):
    """A power of two, which Sobol points like best, so that one render takes about as long as that: at most 1.4 times."""
    samples = 4
    while True:
        _, spent = renderer.render(samples, 1000 + samples)
        if spent > 0.2 * seconds or samples >= 1 << 20:
            return max(1, 2 ** round(np.log2(samples * seconds / spent)))
        samples *= max(2, 2 ** int(np.log2(0.3 * seconds / max(spent, 1e-3))))


def errors(images, region):
    """relMSE of one render, of all pixels and without the worst 0.1 %, for each pair of seeds."""
    height, width = images[0].shape[:2]
    x0, y0, x1, y1 = (round(share * side) for share, side in zip(region, (width, height, width, height)))
    cut = [image[y0:y1, x0:x1] for image in images]
    reference = np.mean(cut, axis=0)
    scale = 0.25 / reference.mean()
    found = {}
    for i in range(len(cut)):
        for j in range(i):
            pixels = (0.5 * (scale * (cut[i] - cut[j])) ** 2 / ((scale * reference) ** 2 + 0.01)).mean(axis=2).ravel()
            pixels.sort()
            found[i, j] = (pixels.mean(), pixels[: len(pixels) - len(pixels) // 1000].mean())
    return found


def efficiency(images, seconds, region):
    """Of all pixels and trimmed, with two standard errors of the first."""
    pairs = errors(images, region)
    k = len(images)

    def of(seeds):
        chosen = [e for (i, j), e in pairs.items() if i in seeds and j in seeds]
        spent = np.mean([seconds[s] for s in seeds])
        return 1 / (np.mean(chosen, axis=0) * spent)

    whole = of(range(k))
    left_out = np.array([of([s for s in range(k) if s != out])[0] for out in range(k)]) if k > 2 else np.array([whole[0]])
    spread = 2 * np.sqrt((k - 1) / k * ((left_out - left_out.mean()) ** 2).sum())
    return whole[0], spread, whole[1]


def compare(scene, options, folder):
    path = scene.write(folder, options.size, scene.depth)
    exported = path
    if path.suffix == ".scene":
        exported = path.with_suffix(".xml")
        subprocess.run([options.abbe, "export", str(path), "--to", "mitsuba", "-o", str(exported), "--force"], check=True,
                       capture_output=True)
    candidates = [(Abbe(options.abbe), path)]
    for variant in options.variants:
        candidates += [(Mitsuba(variant, integrator), exported) for integrator in (None, *scene.also)]
    running, missing = [], []
    for renderer, file in candidates:
        try:
            renderer.open(file, options.size, folder)
            running.append((renderer, samples_for(renderer, options.seconds), [], []))
        except (RuntimeError, OSError, BrokenPipeError) as error:
            missing.append(f"{renderer.name}, {scene.name}: {str(error).strip().splitlines()[-1] if str(error) else 'no answer'}")
    for seed in range(1, options.seeds + 1):
        for renderer, samples, images, seconds in running:
            image, spent = renderer.render(samples, seed)
            images.append(image)
            seconds.append(spent)
    rows = []
    for renderer, samples, images, seconds in running:
        renderer.close()
        value, spread, trimmed = efficiency(images, seconds, scene.region)
        rows.append({"scene": scene.name, "renderer": renderer.name, "samples": samples, "core_seconds": float(np.mean(seconds)),
                     "efficiency": value, "spread": spread, "trimmed": trimmed, "load_seconds": renderer.load,
                     "peak_mib": renderer.peak})
        if options.keep:
            np.save(pathlib.Path(options.keep) / f"{scene.name}-{renderer.name.replace(' ', '_').replace(',', '')}.npy", np.mean(images, axis=0))
    return rows, missing


def table(rows):
    lines = ["| scene | renderer | samples | core-s | efficiency | trimmed | loading, s | peak MiB |", "|---|---|---|---|---|---|---|---|"]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        here = sorted((row for row in rows if row["scene"] == scene), key=lambda row: -row["efficiency"])
        for row in here:
            lines.append(f"| {scene} | {row['renderer']} | {row['samples']} | {row['core_seconds']:.1f} | {row['efficiency']:.3g} "
                         f"± {row['spread']:.2g} | {row['trimmed']:.3g} | {row['load_seconds']:.1f} | {row['peak_mib']:.0f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe")
    parser.add_argument("--scene", action="append", choices=[s.name for s in bench.SCENES])
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--seconds", type=float, default=20, help="core-seconds of one render")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--variants", nargs="*", default=["llvm_ad_spectral", "scalar_spectral"], help="of Mitsuba")
    parser.add_argument("--keep", help="folder for the mean picture of each renderer")
    parser.add_argument("--markdown", help="file for the table")
    options = parser.parse_args()
    options.abbe = os.path.abspath(options.abbe)
    rows, missing = [], []
    with tempfile.TemporaryDirectory() as folder:
        for scene in bench.SCENES:
            if options.scene and scene.name not in options.scene:
                continue
            started = time.time()
            found, failed = compare(scene, options, pathlib.Path(folder))
            rows += found
            missing += failed
            print(table(found), f"\n({scene.about}; {time.time() - started:.0f} s)\n", flush=True)
    text = table(rows) + "".join(f"\n\nnot compared: {m}" for m in missing) + "\n"
    print(text)
    if options.markdown:
        pathlib.Path(options.markdown).write_text(text)


main()
