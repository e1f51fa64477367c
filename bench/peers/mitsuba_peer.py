"""Renders a scene with Mitsuba, for peers.py: one process for each variant and integrator, told on stdin what to render.

  mitsuba_peer.py VARIANT SCENE.xml [INTEGRATOR]

Reads lines `SAMPLES SEED OUT.npy`; answers each with one of JSON: core_seconds of the render alone. The first render, which
compiles kernels and warms caches, is a small one that counts for nothing.
"""
import json
import os
import re
import resource
import sys
import time
import pathlib

import numpy as np
import mitsuba as mi


def core_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def peak_mib():
    """Of this program: what getrusage tells begins with the memory of whoever started it."""
    for line in open("/proc/self/status"):
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024


def main():
    # Mitsuba writes to stdout what it has to say: answers go where nothing else does.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    variant, path = sys.argv[1:3]
    mi.set_variant(variant)
    started = time.perf_counter()
    if len(sys.argv) > 3:
        text = re.sub(r'<integrator type="[a-z]+"', f'<integrator type="{sys.argv[3]}"', pathlib.Path(path).read_text(), count=1)
        path = str(pathlib.Path(path).with_suffix(f".{sys.argv[3]}.xml"))
        pathlib.Path(path).write_text(text)
    scene = mi.load_file(path)
    loading = time.perf_counter() - started
    np.array(mi.render(scene, spp=4, seed=0))
    print(json.dumps({"load_seconds": loading}), file=answers, flush=True)
    for line in sys.stdin:
        samples, seed, out = line.split()
        before = core_seconds()
        image = np.array(mi.render(scene, spp=int(samples), seed=int(seed)), dtype=np.float32)[:, :, :3]
        spent = core_seconds() - before
        np.save(out, image)
        print(json.dumps({"core_seconds": spent, "peak_mib": peak_mib()}), file=answers, flush=True)


main()
