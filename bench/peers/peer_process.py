"""What the programs that render with another renderer have in common: they stay open, and peers.py tells them on stdin what to render.

Each opens a scene, makes a first picture of one sample, answers {"load_seconds", "version"} and then reads lines `SAMPLES SEED OUT.npy`,
each of which it answers with {"core_seconds", "samples", "peak_mib"}, or with {"error"}. Answers are lines of JSON on what was stdout:
renderers write there, too, some when they are imported, and are sent to stderr. So this is to be imported before them.
"""
import json
import os
import resource
import sys

import numpy as np

ANSWERS = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def core_seconds():
    """Of all threads of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def peak_mib():
    """Of this program: what getrusage tells begins with the memory of whoever started it."""
    for line in open("/proc/self/status"):
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024


def serve(renderer, *words):
    """`renderer` is a class: made of `words` it loads the scene, has `version` and `render(samples, seed)`, which returns a picture
    (rows from the top, linear Rec.709), its core-seconds and its samples."""
    def tell(**what):
        print(json.dumps(what), file=ANSWERS, flush=True)

    try:
        before = core_seconds()
        made = renderer(*words)
        _, first, _ = made.render(1, 0)
        tell(load_seconds=core_seconds() - before - first, version=made.version)
        for line in sys.stdin:
            samples, seed, out = line.split()
            image, spent, done = made.render(int(samples), int(seed))
            np.save(out, np.asarray(image, dtype=np.float32)[:, :, :3])
            tell(core_seconds=spent, samples=done, peak_mib=peak_mib())
    except Exception as fault: # whatever it is, it is for whoever reads the table
        tell(error=f"{type(fault).__name__}: {fault}")
    os._exit(0) # Blender waits for itself where it is to tidy up
