"""What is not asked of a prim must not be there: values from clips, from what holds a prim, from schemas; and files that begin alike."""

from __future__ import annotations

import unittest
from collections.abc import Iterator
from unittest import mock

import numpy as np
from support import HEADER, StageTest

from abbe import usd
from abbe.usd import context, own
from abbe.usd.files import Made, SideFiles

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


class Places(StageTest):
    def test_one_operation_is_what_usd_makes_of_it(self) -> None:
        operations = [
            ('double3 xformOp:translate = (1, 2, 3)', '"xformOp:translate"'),
            ('float3 xformOp:translate = (1, 2.5, 3)', '"xformOp:translate"'),
            ('half3 xformOp:translate = (1, 2.5, 3)', '"xformOp:translate"'),
            ('double3 xformOp:translate.timeSamples = { 0: (1, 2, 3), 1: (4, 5, 6) }', '"xformOp:translate"'),
            ('double3 xformOp:translate = None', '"xformOp:translate"'),
            ('double3 xformOp:translate', '"xformOp:translate"'),
            ('double3 xformOp:translate = (1, 2, 3)', '"!invert!xformOp:translate"'),
            ('double3 xformOp:translate = (1, 2, 3)', '"!resetXformStack!", "xformOp:translate"'),
            ('double3 xformOp:translate = (1, 2, 3)', ''),
            ('double3 xformOp:translate:pivot = (1, 2, 3)', '"xformOp:translate:pivot"'),
            ('matrix4d xformOp:transform = ((0, 2, 0, 0), (-2, 0, 0, 0), (0, 0, 2, 0), (5, 6, 7, 1))', '"xformOp:transform"'),
            ('double xformOp:rotateY = 30', '"xformOp:rotateY"'),
        ]  # fmt: skip
        for operation, order in operations:
            place = f"{operation}; uniform token[] xformOpOrder = [{order}]"
            text = lines(
                f'def Xform "World" {{ float3 xformOp:scale = (1, 2, 1); uniform token[] xformOpOrder = ["xformOp:scale"]; def Mesh "m" {{ {TRIANGLE} {POINTS}; {place} }} }}'
            )
            quick = self.convert(text, strict=False)
            with mock.patch.object(context, "_ALONE", ()):
                slow = self.convert(text, strict=False)
            self.assertEqual(quick.scene_text, slow.scene_text, operation)

    def test_bounds_of_many_clouds_are_those_of_each(self) -> None:
        random = np.random.default_rng(7)
        clouds = [random.normal(size=(n, 3)).astype(np.float32) for n in (1, 700, context.SHORT + 1, 3, context.SHORT, 9, 2, context.SHORT - 1, 5)]
        ends = context._ends(clouds)
        for cloud, (low, high) in zip(clouds, ends, strict=True):
            np.testing.assert_array_equal(low, cloud.min(axis=0))
            np.testing.assert_array_equal(high, cloud.max(axis=0))


class Again(StageTest):
    def test_a_stage_that_has_changed_is_read_anew(self) -> None:
        """Though a scene that was made of it is still there, and keeps what it read."""
        path = self.folder / "again.usda"
        text = HEADER + lines(f'def Xform "World" {{ def Mesh "m" {{ {TRIANGLE} {POINTS} }} }}')
        path.write_text(text)
        first = usd.load(path)
        other = self.folder / "other.usda"
        other.write_text(text.replace("(2, 0, 0)", "(7, 0, 0)"))
        other.replace(path)
        self.assertIn("7 0 0", usd.load(path).scene_text)
        self.assertIn("2 0 0", first.scene_text)


class Alike(unittest.TestCase):
    @staticmethod
    def made(rows: np.ndarray) -> Made:
        def pieces() -> Iterator[np.ndarray]:
            piece = np.empty(1024, np.float32)  # the same one for all of them
            for block in rows.reshape(-1, 1024):
                piece[:] = block
                yield piece

        return Made(rows.nbytes, float(rows[0]), pieces)

    def test_equal_ones_are_one_file(self) -> None:
        rows = np.arange(4096, dtype=np.float32)
        other = rows.copy()
        other[-1] = 0  # alike but for the end
        files = SideFiles()
        names = [files.add("a", "ply", self.made(r)).path for r in (rows, rows.copy(), other, rows.copy(), other.copy(), rows + 1)]
        self.assertEqual([names.index(n) for n in names], [0, 0, 2, 0, 2, 5])
        self.assertEqual(files.content(names[0]), rows.tobytes())
        self.assertEqual(files.content(names[2]), other.tobytes())
        self.assertEqual(files.content(names[5]), (rows + 1).tobytes())

    def test_equal_bytes_are_one_file_however_they_are_cut(self) -> None:
        files = SideFiles()
        names = [files.add("a", kind, parts).path for kind, parts in (("ply", [b"head", b"rest"]), ("ply", [b"headrest"]), ("obj", [b"headrest"]))]
        self.assertEqual([names.index(n) for n in names], [0, 0, 2])
