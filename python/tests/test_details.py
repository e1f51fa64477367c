"""What is met more seldom: tiles of pictures, volumes in other units, splines that hold their values, filters of lights."""

from __future__ import annotations

import unittest

import numpy as np
from support import HEADER, LOOKING_DOWN, StageTest
from test_materials import node, preview, write_png

try:
    from pxr import Ts
except ImportError:
    Ts = None

STILL = HEADER.replace("metersPerUnit = 1\n", "metersPerUnit = 1\n    startTimeCode = 0\n    endTimeCode = 24\n    timeCodesPerSecond = 24\n")


def in_lines(body: str) -> str:
    """With statements on lines of their own, as usda wants them."""
    return body.replace("{", "{\n").replace("}", "\n}\n").replace(", 12:", ",\n12:").replace(", 24:", ",\n24:").replace("bezier, ", "bezier,\n")


class Tiles(StageTest):
    def test_each_tile_shows_its_own_picture(self) -> None:
        # The floor has u from 0 to 2: its left half is tile 1001, red, its right half tile 1002, green.
        for tile, colour in ((1001, (255, 0, 0)), (1002, (0, 255, 0))):
            write_png(self.folder / f"wood.{tile}.png", np.full((8, 8, 3), colour))
        texture = node("t", "UsdUVTexture", "asset inputs:file = @wood.<UDIM>.png@", "float3 outputs:rgb")
        stage = preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>\n float inputs:ior = 1.0", texture)
        self.convert(stage.replace("[(0, 0), (1, 0), (1, 1), (0, 1)]", "[(0, 0), (2, 0), (2, 1), (0, 1)]"))
        picture = self.render(64)
        left, right = picture[4:12, 2:6].mean(axis=(0, 1)), picture[4:12, 10:14].mean(axis=(0, 1))
        np.testing.assert_allclose(left, [1, 0, 0], atol=0.02)
        np.testing.assert_allclose(right, [0, 1, 0], atol=0.02)

    def test_no_tile_is_an_error_and_so_is_no_folder(self) -> None:
        for name in ("wood.<UDIM>.png", "gone/wood.<UDIM>.png"):
            texture = node("t", "UsdUVTexture", f"asset inputs:file = @{name}@", "float3 outputs:rgb")
            errors = self.errors(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture))
            self.assertEqual([(e.code, e.path) for e in errors], [("E0401", "/World/M/t")])


class Scale(StageTest):
    def test_a_volume_is_as_thick_in_centimetres(self) -> None:
        """The same picture in metres and in centimetres; twice the absorption leaves the square of the light [Beer]."""
        self.volume("cumulus", "fog.vdb", 16)
        body = """def Xform "World" {
            def Camera "cam" { token projection = "orthographic"
                float horizontalAperture = 10000
                float verticalAperture = 10000
                double3 xformOp:translate = (0, 236, 3000)
                uniform token[] xformOpOrder = ["xformOp:translate"] }
            def RenderSettings "s" { int2 resolution = (16, 16) }
            def DomeLight "sky" { }
            def Volume "v" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                rel field:density = </World/v/d>
                rel material:binding = </World/M>
                def OpenVDBAsset "d" { asset filePath = @fog.vdb@
                    token fieldName = "density" } }
            def Material "M" { token outputs:mtlx:volume.connect = </World/M/v.outputs:out>
                def Shader "v" { uniform token info:id = "ND_anisotropic_vdf"
                    vector3f inputs:absorption = (SIGMA, SIGMA, SIGMA)
                    vector3f inputs:scattering = (0, 0, 0)
                    token outputs:out } } }"""
        found = []
        for metres, sigma in (("1", "0.01"), ("0.01", "0.01"), ("0.01", "0.02")):
            stage = in_lines(body.replace("SIGMA", sigma))
            self.convert(stage, HEADER.replace("metersPerUnit = 1", f"metersPerUnit = {metres}"))
            found.append(self.render(1024).mean(axis=2)[6:10, 6:10])
        self.assertLess(found[0].mean(), 0.7)  # there is fog
        self.assertGreater(found[0].mean(), 0.05)
        np.testing.assert_allclose(found[1], found[0], atol=0.05)
        np.testing.assert_allclose(found[2], found[0] ** 2, atol=0.07)


@unittest.skipIf(Ts is None, "this OpenUSD has no splines")
class Splines(StageTest):
    def ball(self, knots: str) -> str:
        return f"""def Xform "World" {{
            def Sphere "ball" {{ double radius = 1
                double xformOp:translateX.spline = {{ {knots} }}
                uniform token[] xformOpOrder = ["xformOp:translateX"] }}
            {LOOKING_DOWN} }}"""

    def at(self, knots: str, frame: float) -> float:
        self.convert(in_lines(self.ball(knots)), STILL, frame=frame)
        bounds = self.info()["bounds_m"]
        return (bounds["lower"][0] + bounds["upper"][0]) / 2

    def test_a_value_is_held_up_to_the_next_knot(self) -> None:
        knots = "bezier, 0: 0; post held, 12: 5; post held, 24: 10; post held,"
        for frame, x in ((0, 0), (11.9, 0), (12, 5), (23.5, 5), (24, 10)):
            self.assertAlmostEqual(self.at(knots, frame), x, 4)

    def test_a_straight_one_is_between_its_knots(self) -> None:
        knots = "bezier, 0: 0; post linear, 24: 10; post linear,"
        self.assertAlmostEqual(self.at(knots, 6), 2.5, 4)
        self.assertAlmostEqual(self.at(knots, 18), 7.5, 4)

    def test_frames_keep_the_step(self) -> None:
        scene = self.convert(in_lines(self.ball("bezier, 0: 0; post held, 12: 5; post held, 24: 10; post held,")), STILL, frames=(0, 24))
        text = scene.scene_text.split("/ball")[1]
        keys = [
            (float(part.split()[0]), "translate 5" in part, "translate 10" in part)
            for part in text.split("at ")[1:]
            if "translate" in part or "s {" in part
        ]
        before = [t for t, five, ten in keys if not five and not ten]
        self.assertAlmostEqual(max(before), 12 / 24, 3)
        self.assertLess(max(before), 12 / 24)

    def test_a_curve_is_cut_into_straight_pieces(self) -> None:
        # From 0 with slope 0 to 8 with slope 0: u² (3 - 2 u), a quarter of the way 0.15625.
        knots = "bezier, 0: 0; post curve (8, 0), 24: 8; pre (8, 0); post curve (8, 0),"
        self.assertAlmostEqual(self.at(knots, 6), 8 * 0.15625, 3)
        scene = self.convert(in_lines(self.ball(knots)), STILL, frames=(0, 24))
        self.assertGreater(scene.scene_text.count(" s "), 10)


class Filters(StageTest):
    def test_filters_of_a_light_are_named_with_their_type(self) -> None:
        body = f"""def Xform "World" {{ {LOOKING_DOWN}
            def SphereLight "a" {{ rel light:filters = [</World/gobo>, </World/gone>] }}
            def SphereLight "b" {{ rel light:filters = </World/gobo> }}
            def LightFilter "gobo" {{ }} }}"""
        scene = self.convert(in_lines(body))
        found = [(r.path, r.what) for r in scene.report.remarks if "light filter" in r.what]
        self.assertEqual(
            found,
            [
                ("/World/a", "the light filter /World/gobo (LightFilter)"),
                ("/World/a", "the light filter /World/gone (not there)"),
                ("/World/b", "the light filter /World/gobo (LightFilter)"),
            ],
        )


if __name__ == "__main__":
    unittest.main()
