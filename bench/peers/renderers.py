"""The renderers that peers.py compares. Each opens a scene, renders it as often as it is told, and is closed.

open(path, depth, size, folder) sets load (seconds), first (seconds from the start of the program to a picture of one sample) and
version; render(samples, seed) returns a picture and its core-seconds and sets samples and peak (MiB). Errors are RuntimeError.
"""
import glob
import json
import os
import pathlib
import re
import select
import subprocess
import sys
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PATIENCE = 600 # seconds for one answer


class Abbe:
    name = family = "Abbe"
    biased = False

    def __init__(self, program, aspect=1):
        self.program, self.aspect = program, aspect
        words = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.split()
        self.version = words[1] if len(words) > 1 else ""

    def open(self, path, _depth, size, folder):
        self.path, self.size, self.folder = path, size, folder
        started = time.perf_counter()
        self.render(1, 0)
        self.first = time.perf_counter() - started

    def render(self, samples, seed):
        out = self.folder / f"abbe-{seed}.exr"
        command = [self.program, "render", str(self.path), "--samples", str(samples), "--seed", str(seed), "-t", "1", "--json",
                   "--checkpoint", "off", "--png", "off", "--size", f"{self.size}x{round(self.size * self.aspect)}", "-o", str(out)]
        # By a shell, which forks: else the peak would begin with the memory of this program.
        done = subprocess.run(["sh", "-c", '"$@"; exit $?', "sh", *command], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr[-1500:] or done.stdout[-1500:])
        end = json.loads(done.stdout.strip().splitlines()[-1])
        self.samples = samples
        self.load = end["seconds"] - end["render_seconds"]
        self.peak = end["memory_bytes"] / 2 ** 20
        return read_exr(out), end["core_seconds"]

    def close(self):
        pass


def read_exr(path):
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    return np.array(bitmap, dtype=np.float64)[:, :, [names.index(c) for c in "RGB"]]


class Peer:
    """A program beside this file that speaks as peer_process.py says: PROGRAM SCENE.xml DEPTH SIZE WORD…"""

    def __init__(self, family, program, *words, label="", biased=False):
        self.family, self.program, self.words, self.biased = family, program, words, biased
        self.name = f"{family} {label or ' '.join(words)}".strip()
        self.process = None

    def open(self, path, depth, size, folder):
        environment = dict(os.environ, OMP_NUM_THREADS="1", DRJIT_THREADS="1")
        for library in glob.glob("/usr/lib/*/libLLVM.so.19*"):
            environment.setdefault("DRJIT_LIBLLVM_PATH", library)
        self.folder = folder
        words = [sys.executable, str(HERE / self.program), str(path), str(depth), str(size), *self.words]
        self.said = folder / "peer.log"
        started = time.perf_counter()
        with open(self.said, "w") as said:
            self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=said, text=True, env=environment)
        answer = self.answer()
        self.first = time.perf_counter() - started
        self.load, self.version = answer["load_seconds"], answer["version"]

    def answer(self):
        ready, _, _ = select.select([self.process.stdout], [], [], PATIENCE)
        line = self.process.stdout.readline() if ready else ""
        if not line:
            self.process.kill()
            self.process.wait()
            said = self.said.read_text(errors="replace").strip().splitlines()
            raise RuntimeError(f"no answer for {PATIENCE} s" if not ready else said[-1] if said else "ended without a word")
        answer = json.loads(line)
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer

    def render(self, samples, seed):
        out = self.folder / "peer.npy"
        self.process.stdin.write(f"{samples} {seed} {out}\n")
        self.process.stdin.flush()
        answer = self.answer()
        self.peak, self.samples = answer["peak_mib"], answer["samples"]
        return np.load(out).astype(np.float64), answer["core_seconds"]

    def close(self):
        if self.process and self.process.poll() is None:
            self.process.stdin.close()
            try:
                self.process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()


class Yardstick:
    """A bare path tracer of the Cornell box: PROGRAM SPECTRA sobol SAMPLES SEED RAW, of 512 × 512 pixels always.

    It writes floats and prints `… M paths per core-second …`. Its core-seconds are told as of the comparison's size.
    """
    name = family = "yardstick"
    biased, version, load, peak, side = False, "", 0.0, 0.0, 512

    def __init__(self, program, spectra):
        self.program, self.spectra = program, spectra

    def open(self, _path, _depth, size, folder):
        self.size, self.folder = size, folder
        started = time.perf_counter()
        self.render(1, 0)
        self.first = time.perf_counter() - started

    def render(self, samples, seed):
        out = self.folder / "yardstick.raw"
        done = subprocess.run([self.program, self.spectra, "sobol", str(samples), str(seed), str(out)], capture_output=True, text=True)
        rate = re.search(r"([\d.]+) M paths per core-second", done.stdout)
        if done.returncode != 0 or not rate:
            raise RuntimeError(done.stderr[-500:] or f"`{self.program}` did not say how many paths it makes")
        self.samples = samples
        return (np.fromfile(out, np.float32).astype(np.float64).reshape(self.side, self.side, 3),
                samples * self.size ** 2 / (1e6 * float(rate.group(1))))

    def close(self):
        pass


def all_of(scene, options):
    """Everything that may render a scene of scenes.py, Abbe first."""
    found = [Abbe(options.abbe, scene.aspect)]
    if scene.gltf:
        return found + [Peer("Cycles", "cycles_peer.py")]
    if options.yardstick and scene.name == "cornell":
        found.append(Yardstick(*options.yardstick))
    for variant in options.variants:
        found += [Peer("Mitsuba", "mitsuba_peer.py", variant, *also) for also in ((), *((x,) for x in scene.mitsuba))]
    # Cycles 4 marches through clouds.
    found += [Peer("Cycles", "cycles_peer.py", *also, biased=scene.name == "cloud") for also in ((), *((x,) for x in scene.cycles))]
    found += [Peer("LuxCore", "luxcore_peer.py", *also, biased="photons" in also) for also in ((), *((x,) for x in scene.luxcore))]
    return found
