"""Renders a scene with LuxCore for peers.py: luxcore_peer.py SCENE.xml DEPTH SIZE [bidir | photons] (protocol: peer_process.py).

PATHCPU with the Sobol sampler, on one thread, and LuxCore's settings: no clamping, no denoiser; roulette as it is set. `bidir` is BIDIRCPU,
`photons` the path tracer with LuxCore's cache of caustic photons, which is biased and renewed with a smaller radius every 8 samples, as in
progressive photon mapping.
"""
import pathlib
import sys
import time

import numpy as np

import peer_process # before the renderer
import pyluxcore
import scene_reader


def add_mesh(scene, name, points, faces, normals=None):
    def rows(values):
        return None if values is None else [tuple(row) for row in values.tolist()]

    scene.DefineMesh(name, rows(points), rows(faces), rows(normals), None, None, None)


def properties(values):
    made = pyluxcore.Properties()
    for name, value in values.items():
        plain = np.asarray(value).tolist() if isinstance(value, (tuple, list, np.ndarray, np.generic)) else value
        made.Set(pyluxcore.Property(name, plain))
    return made


def material(name, surface):
    at = f"scene.materials.{name}"
    made = {f"{at}.type": "matte", f"{at}.kd": surface.color}
    if surface.kind == "dielectric":
        made = {f"{at}.type": "glass", f"{at}.kr": [1, 1, 1], f"{at}.kt": [1, 1, 1], f"{at}.interiorior": surface.ior}
    elif surface.kind == "conductor":
        fresnel = f"scene.textures.{name}"
        made = {f"{fresnel}.type": "fresnelconst", f"{fresnel}.n": surface.eta, f"{fresnel}.k": surface.k,
                f"{at}.type": "metal2", f"{at}.fresnel": name, f"{at}.uroughness": surface.alpha, f"{at}.vroughness": surface.alpha}
    if surface.emission:
        made[f"{at}.emission"] = surface.emission
    return made


class Builder:
    def __init__(self):
        self.scene, self.count = pyluxcore.Scene(), 0

    def add(self, surface, points, faces, normals=None, file=None):
        self.count += 1
        name = f"x{self.count}"
        at = f"scene.objects.{name}"
        values = {**material(name, surface), f"{at}.material": name}
        if file:
            values[f"{at}.ply"] = str(file)
        else:
            add_mesh(self.scene, name, points, faces, normals)
            values[f"{at}.shape"] = name
        self.scene.Parse(properties(values))

    def add_ball(self, ball):
        if ball.surface.emission: # of more triangles the path tracer loses light
            self.add(ball.surface, *scene_reader.shining(ball))
            return
        points, faces = scene_reader.icosphere(6)
        self.add(ball.surface, ball.center + ball.radius * points, faces, points)

    def add_lights(self, read):
        values = {}
        if read.sky:
            values |= {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": read.sky}
        for i, (direction, irradiance) in enumerate(read.suns):
            at = f"scene.lights.sun{i}"
            values |= {f"{at}.type": "sharpdistant", f"{at}.color": irradiance, f"{at}.direction": direction}
        self.scene.Parse(properties(values))

    def add_camera(self, read, size):
        """LuxCore's picture lies a row lower than those of others, so its window does, too."""
        row = 2 / size
        at, forward, up = read.camera[:3, 3], read.camera[:3, 2], read.camera[:3, 1]
        self.scene.Parse(properties({
            "scene.camera.type": "perspective", "scene.camera.lookat.orig": at, "scene.camera.lookat.target": at + forward,
            "scene.camera.up": up, "scene.camera.fieldofview": read.fov, "scene.camera.cliphither": 1e-3,
            "scene.camera.screenwindow": [-1, 1, -1 - row, 1 - row]}))


class LuxCore:
    version = pyluxcore.Version()

    def __init__(self, path, depth, size, *also):
        pyluxcore.Init(lambda _: None)
        read = scene_reader.read(path, int(depth))
        if read.cloud:
            raise RuntimeError("marches through clouds of a grid, single pixels 100,000 times too bright, the more the finer its steps")
        builder = Builder()
        builder.add_camera(read, int(size))
        for mesh in read.meshes:
            builder.add(mesh.surface, mesh.points, mesh.faces, file=mesh.file)
        for ball in read.balls:
            builder.add_ball(ball)
        builder.add_lights(read)
        self.scene, self.size = builder.scene, int(size)
        self.photons = "photons" in also
        longest = read.depth + 1
        self.settings = {
            "renderengine.type": "BIDIRCPU" if "bidir" in also else "PATHCPU", "sampler.type": "SOBOL", "native.threads.count": 1,
            "film.width": self.size, "film.height": self.size, "film.filter.type": "BOX", "film.filter.width": 0.5,
            "film.imagepipelines.0.0.type": "NOP", "path.pathdepth.total": longest, "path.pathdepth.diffuse": longest,
            "path.pathdepth.glossy": longest, "path.pathdepth.specular": longest, "light.maxdepth": longest, "path.maxdepth": longest,
            "path.photongi.caustic.enabled": self.photons}

    def render(self, samples, seed):
        config = pyluxcore.RenderConfig(properties({**self.settings, "renderengine.seed": seed + 1, "batch.haltspp": samples}), self.scene)
        session = pyluxcore.RenderSession(config)
        started = peer_process.core_seconds()
        session.Start() # builds trees and traces the first photons, and lets the rest begin
        before = started if self.photons else peer_process.core_seconds()
        while not session.HasDone():
            time.sleep(0.005)
            session.UpdateStats()
        session.Stop()
        spent = peer_process.core_seconds() - before
        done = session.GetStats().Get("stats.renderengine.pass").GetInt()
        image = np.zeros(3 * self.size ** 2, np.float32)
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB_IMAGEPIPELINE, image)
        return image.reshape(self.size, self.size, 3)[::-1], spent, done


peer_process.serve(LuxCore, *sys.argv[1:])
