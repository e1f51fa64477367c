"""What is not asked of a prim must not be there: values from clips, from what holds a prim, from schemas; and files that begin alike."""

from __future__ import annotations

import unittest
from unittest import mock

import numpy as np
from support import StageTest

from abbe.usd import own
from abbe.usd.files import SideFiles, Stream

TRIANGLE = """
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        uniform token subdivisionScheme = "none"
"""
POINTS = "point3f[] points = [(0, 0, 0), (2, 0, 0), (0, 3, 0)]"


def lines(text: str) -> str:
    """A stage with the ends of lines that its grammar asks for."""
    return text.replace("{ ", "{\n").replace(" }", "\n}").replace("; ", "\n").replace(" ) {", ") {")


class Owned(StageTest):
    def test_points_of_a_clip(self) -> None:
        """No layer of the stage has an opinion on them."""
        samples = "point3f[] points.timeSamples = { 0: [(0, 0, 0), (4, 0, 0), (0, 5, 0)] }"
        self.stage(lines(f'def Xform "Model" {{ def Mesh "m" {{ {samples} }} }}'), name="clip.usda")
        self.stage(lines('def Xform "Model" { def Mesh "m" { point3f[] points } }'), name="manifest.usda")
        clips = """ ( clips = { dictionary default = {
            asset[] assetPaths = [@./clip.usda@]
            asset manifestAssetPath = @./manifest.usda@
            string primPath = "/Model"
            double2[] active = [(0, 0)]
            double2[] times = [(0, 0)]
        } } ) """
        self.convert(f'def Xform "World" {clips}' + lines(f'{{ def Mesh "m" {{ {TRIANGLE} }} }}'), strict=False, frame=0)
        self.assert_bounds([0, 0, 0], [4, 5, 0])

    def test_a_colour_of_what_holds_it(self) -> None:
        inner = lines(f'def Xform "group" {{ def Mesh "m" {{ {TRIANGLE} {POINTS} }} }}')
        scene = self.convert(
            f'def Xform "World" {{\ncolor3f[] primvars:displayColor = [(1, 0, 0)] (interpolation = "constant")\n{inner}\n}}', strict=False
        )
        self.assertIn("reflectance rgb 1 0 0", scene.scene_text)
        scene = self.convert(
            f'def Xform "World" {{\ncolor3f[] primvars:displayColor = [(1, 0, 0)] (interpolation = "vertex")\n{inner}\n}}', strict=False
        )
        self.assertNotIn("rgb", scene.scene_text)  # only constant ones are handed down

    def test_all_that_is_authored_and_nothing_else(self) -> None:
        """The same scene whether a prim is asked for its names or for every value."""
        bodies = [
            f'def Mesh "m" {{ {TRIANGLE} {POINTS} }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; uniform token orientation = "leftHanded"; normal3f[] normals = [(0, 0, 1), (0, 1, 0), (1, 0, 0)] }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; int[] holeIndices = [0] }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; token visibility = "invisible" }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; uniform token purpose = "proxy" }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; vector3f[] velocities = [(1, 0, 0), (1, 0, 0), (1, 0, 0)] }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; float[] primvars:st = [1, 2, 3] (interpolation = "vertex"); int[] primvars:st:indices = [2, 1, 0] }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; float2[] primvars:st = [(0, 0), (1, 0), (1, 1)] (interpolation = "faceVarying") }}',
            f'def Mesh "m" {{ {TRIANGLE} {POINTS}; color3f[] primvars:displayColor = None }}',
        ]
        for body in bodies:
            text = lines(f'def Xform "World" {{ color3f[] primvars:displayColor = [(0, 1, 0)] (interpolation = "constant"); {body} }}')
            quick = self.convert(text, strict=False)
            with mock.patch.object(own, "_PLAIN_TYPES", frozenset()):
                slow = self.convert(text, strict=False)
            self.assertEqual(quick.scene_text, slow.scene_text, body)
            self.assertEqual(quick.files, slow.files)


class Alike(unittest.TestCase):
    @staticmethod
    def stream(rows: np.ndarray) -> Stream:
        return Stream(rows.nbytes, lambda: iter([rows]), lambda size: rows[: size // 4 + 1])

    def test_equal_ones_are_one_file(self) -> None:
        rows = np.arange(4096, dtype=np.float32)
        other = rows.copy()
        other[-1] = 0  # alike but for the end
        files = SideFiles()
        names = [files.add("a", "ply", [b"head", self.stream(r)]).path for r in (rows, rows.copy(), other, rows.copy(), other.copy(), rows + 1)]
        self.assertEqual([names.index(n) for n in names], [0, 0, 2, 0, 2, 5])
        self.assertEqual(files.content(names[0]), b"head" + rows.tobytes())
        self.assertEqual(files.content(names[2]), b"head" + other.tobytes())
        self.assertEqual(files.content(names[5]), b"head" + (rows + 1).tobytes())
        # However its parts are cut.
        self.assertEqual(files.add("b", "ply", [b"head" + rows.tobytes()]).path, names[0])
        self.assertNotEqual(files.add("b", "obj", [b"head" + rows.tobytes()]).path, names[0])
