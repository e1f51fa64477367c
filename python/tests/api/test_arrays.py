"""Geometry and pictures out of arrays: the same as out of rows and files, and what is no geometry is refused."""

from __future__ import annotations

import gc
import unittest

import numpy as np
from small import InFolder, ball

import abbe

BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0.0, 1.0) for z in (-0.5, 0.5)], dtype=np.float32)
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], dtype=np.int32)


def room() -> abbe.Scene:
    scene = abbe.Scene()
    scene.film(size=(32, 24))
    scene.camera(from_=(1, 1.5, 4), look_at=(0, 0.5, 0))
    scene.light("daylight", elevation="40 deg")
    scene.shape("plane")
    return scene


def picture(scene: abbe.Scene) -> np.ndarray:
    return scene.render(samples=4).rgb()


class Geometry(InFolder):
    def check_round_trip(self, scene: abbe.Scene) -> np.ndarray:
        """By memory, by rows in a file, and by that file read again."""
        path = self.folder / "a.scene"
        scene.write(path)
        self.assertNotIn("memory:", path.read_text())
        ours = picture(scene)
        self.assertTrue((picture(abbe.load(path)) == ours).all())
        return ours

    def test_a_mesh_of_quads(self) -> None:
        scene = room()
        scene.shape("box", "mesh", points=BOX, faces=QUADS)
        ours = self.check_round_trip(scene)
        empty = picture(room())
        self.assertFalse((ours == empty).all())

    def test_triangles_of_any_type(self) -> None:
        pictures = []
        triangles = np.array([t for q in QUADS for t in ([q[0], q[1], q[2]], [q[0], q[2], q[3]])])
        for points, faces in (
            (BOX, triangles),
            (BOX.astype(float), triangles.astype(np.uint8)),
            (np.asfortranarray(BOX), triangles.astype(np.int32)[:, :]),
        ):
            scene = room()
            scene.shape("mesh", points=points, faces=faces)
            pictures.append(picture(scene))
        self.assertTrue(all((one == pictures[0]).all() for one in pictures))

    def test_polygons_of_several_sizes_uvs_and_attributes(self) -> None:
        scene = room()
        wear = np.linspace(0, 1, 8)
        scene.texture("wear", "attribute", "wear")
        scene.shape(
            "mesh",
            points=BOX,
            faces=[[0, 1, 3, 2], [4, 6, 7], [4, 7, 5]],
            uvs=BOX[:, :2].copy(),
            attribute=("wear", wear),
            material=abbe.node("diffuse", reflectance="wear"),
        )
        self.check_round_trip(scene)

    def test_a_subdivision_surface(self) -> None:
        scene = room()
        scene.shape("subdivision", points=BOX, faces=QUADS)
        self.check_round_trip(scene)

    def test_points_and_curves(self) -> None:
        scene = room()
        scene.shape("points", points=BOX, radii=np.linspace(0.05, 0.2, 8))
        scene.shape("curves", points=BOX, counts=np.array([4, 4]), radii=np.full(8, 0.02))
        self.check_round_trip(scene)

    def test_an_object_placed_often(self) -> None:
        scene = room()
        with scene.object("box") as box:
            box.shape("mesh", points=BOX, faces=QUADS)
        scene.instance("box", transform=[("translate", 1, 0, 0)])
        scene.instance("box", transform=[("translate", -1, 0, 0)])
        self.check_round_trip(scene)

    def test_the_scene_keeps_them(self) -> None:
        scene = room()
        scene.shape("mesh", points=BOX.copy(), faces=QUADS.copy())
        gc.collect()
        junk = [np.zeros((8, 3), dtype=np.float32) for _ in range(1000)]
        first = picture(scene)
        del junk
        self.assertTrue((picture(scene) == first).all())

    def test_without_a_copy(self) -> None:
        points = BOX.copy()
        scene = room()
        scene.shape("mesh", points=points, faces=QUADS)
        before = picture(scene)
        points[:, 0] += 1  # what nobody should do: it shows that the renderer looks at this very array
        again = abbe.Scene()
        again._lines = scene._lines
        self.assertFalse((picture(again) == before).all())

    def test_an_environment(self) -> None:
        sky = np.full((16, 32, 3), 0.5, dtype=np.float32)
        scene = abbe.Scene()
        scene.film(size=(8, 8))
        scene.camera(from_=(0, 0, 0), look_at=(0, 0, -1))
        scene.light("environment", image=sky)
        xyz = scene.render(samples=4).xyz
        np.testing.assert_allclose(xyz[..., 1] / xyz[..., 1].mean(), 1, atol=0.03)
        self.assertRaises(ValueError, scene.text)


class Refusals(unittest.TestCase):
    def refused(self, fault: type[Exception], pattern: str, kind: str = "mesh", **properties: object) -> None:
        scene = room()
        with self.assertRaisesRegex(fault, pattern):
            scene.shape(kind, **properties)
        scene.check()  # nothing of it is in the scene

    def test_shapes_and_types(self) -> None:
        self.refused(ValueError, r"\(N, 3\)", points=BOX[:, :2], faces=QUADS)
        self.refused(ValueError, r"\(N, 3\)", points=BOX.reshape(-1), faces=QUADS)
        self.refused(TypeError, "numbers", points=BOX.astype(complex), faces=QUADS)
        self.refused(TypeError, "numbers", points=BOX.astype(object), faces=QUADS)
        self.refused(TypeError, "whole", points=BOX, faces=QUADS.astype(float))
        self.refused(ValueError, r"\(F, 3\)", points=BOX, faces=QUADS[:, :2])
        self.refused(ValueError, "uvs", points=BOX, faces=QUADS, uvs=BOX[:4, :2])

    def test_numbers(self) -> None:
        bad = BOX.copy()
        bad[3, 1] = np.nan
        self.refused(ValueError, "number 10 is not finite", points=bad, faces=QUADS)
        self.refused(ValueError, "8 is not between 0 and 7", points=BOX, faces=QUADS + 1)
        self.refused(ValueError, "-1 is not between 0 and 7", points=BOX, faces=QUADS - 1)
        self.refused(ValueError, "below 0", "points", points=BOX, radii=np.full(8, -1.0))
        self.refused(ValueError, "counts", "curves", points=BOX, counts=np.array([4, 5]), radii=np.full(8, 0.1))

    def test_too_large_for_single_precision(self) -> None:
        self.refused(ValueError, "not finite", points=BOX.astype(float) * 1e300, faces=QUADS)

    def test_parts_need_files(self) -> None:
        scene = room()
        scene.shape("mesh", points=BOX, faces=QUADS)
        self.assertRaises(ValueError, scene.render, part=(1, 2), output="x.exr")

    def test_rows_are_still_rows(self) -> None:
        scene = ball()
        scene.shape("mesh", points=BOX.tolist(), faces=QUADS.tolist())
        self.assertIn("- -0.5 0.0 -0.5", scene.text())
        scene.check()


if __name__ == "__main__":
    unittest.main()
