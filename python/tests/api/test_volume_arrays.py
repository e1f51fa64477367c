"""Volumes out of arrays: the same as out of files and as the law of Beer and Lambert has it, and what is no volume is refused."""

from __future__ import annotations

import gc
import unittest

import numpy as np
from small import InFolder, command

import abbe

COUNTS = (6, 9, 11)  # z, y, x
WHITE = np.ones((4, 8, 3), dtype=np.float32)


def cloud() -> np.ndarray:
    """With holes, a leaf of one value and several leaves along each axis."""
    values = np.random.default_rng(5).uniform(0, 3, COUNTS).astype(np.float32)
    values[values < 1] = 0
    return values


def view(scene: abbe.Scene) -> abbe.Scene:
    scene.film(size=(24, 16))
    scene.camera(from_=(1, 2, 5), look_at=(0.5, 0.5, 0.5))
    scene.light("environment", image=WHITE)
    return scene


def through(density: np.ndarray, **place: object) -> np.ndarray:
    """Luminance along z, relative to that without the volume, of what absorbs alone."""
    scenes = []
    for filled in (True, False):
        scene = abbe.Scene()
        scene.film(size=(3, 3))
        scene.camera("orthographic", from_=(0, 0, 10), look_at=(0, 0, 0), width=0.2)
        scene.light("environment", image=WHITE)
        if filled:
            scene.volume("vdb", density=density, absorption=1, scattering=0, **place)
        scenes.append(scene.render(samples=2048).xyz[..., 1])
    return scenes[0].mean() / scenes[1].mean()


class Volumes(InFolder):
    def test_the_bits_of_a_file(self) -> None:
        values = cloud()
        z, y, x = COUNTS
        numbers = " ".join(repr(float(v)) for v in values.reshape(-1))
        (self.folder / "a.pbrt").write_text(
            'Camera "perspective"\nWorldBegin\nLightSource "infinite"\n'
            f'MakeNamedMedium "m" "string type" "uniformgrid" "integer nx" {x} "integer ny" {y} "integer nz" {z} '
            f'"point3 p1" [{x} {y} {z}] "float density" [{numbers}]\n'
            'MediumInterface "m" ""\nMaterial "interface"\nShape "sphere" "float radius" 50\n'
        )
        command("import", "a.pbrt", "-o", "a.scene", cwd=self.folder)
        (vdb,) = self.folder.rglob("*.vdb")
        place = [("scale", 0.1), ("translate", 0.05, 0.05, 0.05)]
        optics = {"extinction": 8, "albedo": 0.6, "transform": place}
        pictures = []
        for grids in ({"file": str(vdb)}, {"density": values, "voxel_size": 1, "origin": (-0.5, -0.5, -0.5)}):
            scene = view(abbe.Scene())
            scene.volume("vdb", **grids, **optics)
            pictures.append(scene.render(samples=8).rgb())
        self.assertTrue((pictures[0] == pictures[1]).all())
        self.assertFalse((pictures[0] == view(abbe.Scene()).render(samples=8).rgb()).all())

    def test_places(self) -> None:
        """Bounds, the size of a voxel and a transform say the same."""
        z, y, x = COUNTS
        pictures = []
        for place in (
            {"bounds": ((0, 0, 0), (x * 0.25, y * 0.25, z * 0.25))},
            {"voxel_size": 0.25},
            {"voxel_size": (0.25, 0.25, 0.25), "origin": np.zeros(3)},
            {"voxel_size": 0.5, "transform": [("scale", 0.5)]},
        ):
            scene = view(abbe.Scene())
            scene.volume("vdb", density=cloud(), extinction=8, albedo=0.6, **place)
            pictures.append(scene.render(samples=4).rgb())
        for one in pictures[1:]:
            np.testing.assert_allclose(one, pictures[0], rtol=1e-4)

    def test_beer_lambert(self) -> None:
        """A constant grid is 1 in its box and falls to 0 over a voxel beyond it, half of which lies inside of the bounds' border: the
        integral is that of n voxels. A ramp along z is linear between the middles, with the integral of its values."""
        constant = np.full((10, 8, 8), 0.75, dtype=np.float32)
        box = ((-0.5, -0.5, -1), (0.5, 0.5, 1))
        self.assertAlmostEqual(through(constant, bounds=box), np.exp(-0.75 * 2), delta=0.006)
        ramp = np.broadcast_to(np.linspace(0.1, 1.5, 10, dtype=np.float32)[:, None, None], (10, 8, 8))
        self.assertAlmostEqual(through(ramp, bounds=box), np.exp(-0.8 * 2), delta=0.006)

    def test_axes(self) -> None:
        """What is thick at small x, large y is seen on the left, above; z is the first index."""
        values = np.zeros((2, 8, 8), dtype=np.float32)
        values[:, 4:, :4] = 5
        scene = abbe.Scene()
        scene.film(size=(8, 8))
        scene.camera("orthographic", from_=(0, 0, 10), look_at=(0, 0, 0), width=1)
        scene.light("environment", image=WHITE)
        scene.volume("vdb", density=values, bounds=((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)), absorption=1, scattering=0)
        light = scene.render(samples=64).xyz[..., 1]
        self.assertLess(light[:3, :3].max(), 0.1 * light[5:, 5:].min())
        self.assertLess(light[:3, :3].max(), 0.1 * light[:3, 5:].min())

    def test_all_grids(self) -> None:
        hot = np.full(COUNTS, 1500, dtype=np.float32)
        wind = np.zeros((*COUNTS, 3), dtype=np.float32)
        wind[..., 0] = 2
        scene = view(abbe.Scene())
        scene.volume(
            "vdb", density=cloud(), temperature=hot, color=np.full((*COUNTS, 3), 0.5), velocity=wind, bounds=((0, 0, 0), (1, 1, 1)),
            scattering=1, absorption=2,
        )  # fmt: skip
        self.assertTrue(np.isfinite(scene.render(samples=4).rgb()).all())

    def test_the_scene_keeps_them(self) -> None:
        scene = view(abbe.Scene())
        scene.volume("vdb", density=cloud(), voxel_size=0.25, extinction=8, albedo=0.6)
        gc.collect()
        junk = [cloud() for _ in range(100)]
        first = scene.render(samples=4).rgb()
        scene.forget()
        del junk
        self.assertTrue((scene.render(samples=4).rgb() == first).all())

    def test_without_a_copy(self) -> None:
        values = cloud()
        scene = view(abbe.Scene())
        scene.volume("vdb", density=values, voxel_size=0.25, extinction=8, albedo=0.6)
        values[:] = 0  # what nobody should do: it shows that the renderer looks at this very array
        self.assertTrue((scene.render(samples=4).rgb() == view(abbe.Scene()).render(samples=4).rgb()).all())
        values[:] = 1
        again = abbe.Scene()
        again._lines = scene._lines
        values[0, 0, 0] = np.nan
        with self.assertRaisesRegex(abbe.SceneError, "number 0 of it is nan"):
            again.render(samples=1)

    def test_no_text(self) -> None:
        scene = abbe.Scene()
        scene.volume("vdb", density=cloud(), voxel_size=1)
        with self.assertRaisesRegex(ValueError, "density of a volume .* OpenVDB"):
            scene.write(self.folder / "a.scene")
        self.assertFalse(list(self.folder.iterdir()))


class Refusals(unittest.TestCase):
    def refused(self, fault: type[Exception], pattern: str, **properties: object) -> None:
        scene = view(abbe.Scene())
        with self.assertRaisesRegex(fault, pattern):
            scene.volume("vdb", **properties)
        scene.check()  # nothing of it is in the scene

    def test_shapes_and_types(self) -> None:
        values = cloud()
        self.refused(ValueError, r"density: .*\(z, y, x\)", density=values[0], voxel_size=1)
        self.refused(ValueError, r"density: .*\(z, y, x\)", density=values[:0], voxel_size=1)
        self.refused(TypeError, "density: .*numbers", density=values.astype(complex), voxel_size=1)
        self.refused(ValueError, r"color: .*\(z, y, x, 3\)", density=values, color=values, voxel_size=1)
        self.refused(ValueError, r"temperature: it has", density=values, temperature=values[1:], voxel_size=1)
        self.refused(TypeError, "density: an array", temperature=values, voxel_size=1)
        self.refused(TypeError, "temperature: an array", density=values, temperature="heat", voxel_size=1)
        self.refused(TypeError, "beside a file", density=values, file="a.vdb", voxel_size=1)

    def test_numbers(self) -> None:
        bad = cloud()
        bad[0, 0, 3] = np.nan
        self.refused(ValueError, "density: number 3 is not finite", density=bad, voxel_size=1)
        bad[0, 0, 3] = -0.5
        self.refused(ValueError, "density: number 3 is -0.5, below 0", density=bad, voxel_size=1)
        self.refused(ValueError, "not finite", density=cloud().astype(float) * 1e300, voxel_size=1)

    def test_places(self) -> None:
        values = cloud()
        self.refused(TypeError, "bounds", density=values)
        self.refused(TypeError, "bounds", density=values, voxel_size=1, bounds=((0, 0, 0), (1, 1, 1)))
        self.refused(TypeError, "origin", density=values, origin=(0, 0, 0), bounds=((0, 0, 0), (1, 1, 1)))
        self.refused(ValueError, "no volume", density=values, voxel_size=0)
        self.refused(ValueError, "no volume", density=values, bounds=((0, 0, 0), (1, 1, -1)))
        self.refused(ValueError, "voxel_size: three", density=values, voxel_size=(1, 2))
        self.refused(ValueError, "voxel_size: three", density=values, voxel_size="1 cm")
        self.refused(TypeError, "voxel_size", file="a.vdb", voxel_size=1)

    def test_too_large(self) -> None:
        self.addCleanup(view(abbe.Scene()).render, samples=1, memory=8e9)  # the limit is one of the process
        scene = view(abbe.Scene())
        scene.volume("vdb", density=np.zeros((256, 256, 256), dtype=np.float32), voxel_size=0.01)
        with self.assertRaisesRegex(abbe.SceneError, "memory"):
            scene.render(samples=1, memory=100e6)


if __name__ == "__main__":
    unittest.main()
