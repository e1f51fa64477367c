"""Renders a scene with Mitsuba for peers.py: mitsuba_peer.py SCENE.xml DEPTH SIZE VARIANT [INTEGRATOR] (protocol: peer_process.py)."""
import pathlib
import re
import sys

import numpy as np

import peer_process # before the renderer
import mitsuba as mi


class Mitsuba:
    version = mi.__version__

    def __init__(self, path, _depth, _size, variant, integrator=None):
        mi.set_variant(variant)
        if integrator:
            text = re.sub(r'<integrator type="[a-z]+"', f'<integrator type="{integrator}"', pathlib.Path(path).read_text(), count=1)
            path = str(pathlib.Path(path).with_suffix(f".{integrator}.xml"))
            pathlib.Path(path).write_text(text)
        self.scene = mi.load_file(path)
        np.array(mi.render(self.scene, spp=1, seed=0)) # compiles kernels

    def render(self, samples, seed):
        before = peer_process.core_seconds()
        image = np.array(mi.render(self.scene, spp=samples, seed=seed))
        return image, peer_process.core_seconds() - before, samples


peer_process.serve(Mitsuba, *sys.argv[1:])
