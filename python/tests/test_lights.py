"""UsdLux against closed forms: what a light of so many nits brings to a white floor, and what is seen of it."""

from __future__ import annotations

import math
import re

import numpy as np
from support import HEADER, LOOKING_DOWN, WHITE_FLOOR, StageTest, read_exr  # noqa: F401

ROTATE_DOWN = """
        double3 xformOp:translate = (0, 5, 0)
        double xformOp:rotateX = -90
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
"""


def world(light: str) -> str:
    return f'def Xform "World" {{\n{LOOKING_DOWN}{WHITE_FLOOR}{light}\n}}\n'


class Lights(StageTest):
    def centre(self, samples: int = 256) -> float:
        """What the middle of the floor shows: irradiance / π, in nits."""
        picture = self.render(samples)
        return float(picture[6:10, 6:10, 1].mean())

    def test_dome_of_radiance_l_gives_a_white_floor_l(self) -> None:
        self.convert(world('def DomeLight "d" { float inputs:intensity = 0.7\n }'))
        self.assertAlmostEqual(self.centre(64), 0.7, delta=0.007)

    def test_dome_normalized_divides_by_the_sphere(self) -> None:
        self.convert(world('def DomeLight "d" { float inputs:intensity = 4\n bool inputs:normalize = true\n }'))
        self.assertAlmostEqual(self.centre(64), 1 / math.pi, delta=0.004)

    def test_exposure_and_colour(self) -> None:
        self.convert(world('def DomeLight "d" { float inputs:exposure = 2\n color3f inputs:color = (0.5, 0.25, 0.125)\n }'))
        picture = self.render(64)
        np.testing.assert_allclose(picture.mean(axis=(0, 1)), [2, 1, 0.5], rtol=0.03)

    def test_distant_light(self) -> None:
        # E = L π sin²(θ/2), the floor shows E / π.
        light = 'def DistantLight "s" { float inputs:intensity = 50000\n float inputs:angle = 0.53\n double xformOp:rotateX = -90\n uniform token[] xformOpOrder = ["xformOp:rotateX"]\n }'
        self.convert(world(light))
        expected = 50000 * math.sin(math.radians(0.265)) ** 2
        self.assertAlmostEqual(self.centre(), expected, delta=0.01 * expected)

    def test_distant_light_normalized_and_without_an_angle(self) -> None:
        for angle, normalize in ((0.53, "true"), (10, "true"), (0, "false")):
            light = f'def DistantLight "s" {{ float inputs:intensity = 3\n float inputs:angle = {angle}\n bool inputs:normalize = {normalize}\n double xformOp:rotateX = -60\n uniform token[] xformOpOrder = ["xformOp:rotateX"]\n }}'
            self.convert(world(light))
            expected = 3 * math.cos(math.radians(30)) / math.pi
            self.assertAlmostEqual(self.centre(), expected, delta=0.01 * expected)

    def test_rect_light(self) -> None:
        # A small light of area A at height h: E = L A / h²; 0.1 × 0.2 at 5.
        light = f'def RectLight "r" {{ float inputs:intensity = 1000\n float inputs:width = 0.1\n float inputs:height = 0.2\n{ROTATE_DOWN} }}'
        self.convert(world(light))
        expected = 1000 * 0.02 / 25 / math.pi
        self.assertAlmostEqual(self.centre(), expected, delta=0.02 * expected)

    def test_rect_light_shines_to_one_side(self) -> None:
        light = 'def RectLight "r" { float inputs:intensity = 1000\n double3 xformOp:translate = (0, 5, 0)\n double xformOp:rotateX = 90\n uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]\n }'
        self.convert(world(light))
        self.assertEqual(self.centre(16), 0)

    def test_normalized_nits_to_six_digits(self) -> None:
        # Renders allow for a per cent or two; what is written allows for nothing.
        rect, disk = "width = 0.1\n float inputs:height = 0.2", "radius = 0.3"
        for kind, size, area in (("RectLight", rect, 0.02), ("DiskLight", disk, math.pi * 0.09)):
            light = f'def {kind} "r" {{ float inputs:intensity = 20\n bool inputs:normalize = true\n float inputs:{size}\n{ROTATE_DOWN} }}'
            found = re.search(r"luminance ([0-9.eE+-]+) nits", self.convert(world(light)).scene_text)
            self.assertIsNotNone(found)
            self.assertAlmostEqual(float(found[1]) * area / 20, 1, delta=1e-6)

    def test_normalize_divides_by_the_area_in_the_world(self) -> None:
        # Power stays whatever the scale: L = I / A, and A is 0.1 · 0.2 · 2 · 3.
        scaled = ROTATE_DOWN.replace('"xformOp:rotateX"]', '"xformOp:rotateX", "xformOp:scale"]') + "double3 xformOp:scale = (2, 3, 1)\n"
        for place in (ROTATE_DOWN, scaled):
            light = f'def RectLight "r" {{ float inputs:intensity = 20\n bool inputs:normalize = true\n float inputs:width = 0.1\n float inputs:height = 0.2\n{place} }}'
            self.convert(world(light))
            expected = 20 / 25 / math.pi
            self.assertAlmostEqual(self.centre(), expected, delta=0.03 * expected)

    def test_disk_light(self) -> None:
        # Seen from the axis a disk of radius r at h: E = L π r² / (h² + r²), exactly.
        light = f'def DiskLight "r" {{ float inputs:intensity = 8\n float inputs:radius = 2\n{ROTATE_DOWN} }}'
        self.convert(world(light))
        expected = 8 * 4 / 29
        self.assertAlmostEqual(self.centre(), expected, delta=0.02 * expected)

    def test_sphere_light(self) -> None:
        # A sphere of radius r whose middle is at h: E = L π r² / h², exactly, and in scene units.
        light = 'def SphereLight "r" { float inputs:intensity = 8\n float inputs:radius = 2\n double3 xformOp:translate = (0, 5, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }'
        self.convert(world(light))
        self.assertAlmostEqual(self.centre(), 8 * 4 / 25, delta=0.02 * 8 * 4 / 25)

    def test_sphere_light_normalized_and_as_a_point(self) -> None:
        # L = I / 4πr²: E = I / (4 h²), whatever the radius.
        for extra in ("float inputs:radius = 0.5", "float inputs:radius = 0.001", "bool treatAsPoint = true"):
            light = f'def SphereLight "r" {{ float inputs:intensity = 100\n bool inputs:normalize = true\n {extra}\n double3 xformOp:translate = (0, 5, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }}'
            self.convert(world(light))
            expected = 100 / (4 * 25) / math.pi
            self.assertAlmostEqual(self.centre(), expected, delta=0.02 * expected)

    def test_units_do_not_change_light(self) -> None:
        # The same stage in centimetres: nits are nits, and the floor shows the same.
        light = 'def SphereLight "r" { float inputs:intensity = 8\n float inputs:radius = 2\n bool treatAsPoint = true\n double3 xformOp:translate = (0, 5, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }'
        expected = 8 * 4 / 25
        for metres in ("0.01", "0.37"):
            self.convert(world(light), HEADER.replace("metersPerUnit = 1", f"metersPerUnit = {metres}"))
            self.assertAlmostEqual(self.centre(), expected, delta=0.02 * expected)

    def test_cylinder_light(self) -> None:
        # A thin tube of length l across: E = L · 2r ∫ h² / (h² + x²)² dx, from -l/2 to l/2.
        light = 'def CylinderLight "r" { float inputs:intensity = 500\n float inputs:radius = 0.02\n float inputs:length = 4\n double3 xformOp:translate = (0, 5, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }'
        self.convert(world(light))
        h, a = 5.0, 2.0
        integral = 2 * (a / (2 * (h * h + a * a)) + math.atan(a / h) / (2 * h))
        expected = 500 * 0.04 * integral / math.pi
        self.assertAlmostEqual(self.centre(), expected, delta=0.02 * expected)

    def test_temperature(self) -> None:
        # A black body has the luminance that the intensity says, and its colour.
        light = 'def DomeLight "d" { bool inputs:enableColorTemperature = true\n float inputs:colorTemperature = 3000\n }'
        scene = self.convert(world(light))
        self.assertIn("blackbody 3000 K", scene.scene_text)
        mean = self.render(64).mean(axis=(0, 1))
        self.assertAlmostEqual(float(mean @ [0.2126, 0.7152, 0.0722]), 1, delta=0.02)
        self.assertGreater(mean[0], 2.5 * mean[2])

    def test_cone_becomes_a_spot(self) -> None:
        api = 'prepend apiSchemas = ["ShapingAPI"]'
        light = f'def SphereLight "r" ({api}) {{ float inputs:intensity = 1000\n float inputs:radius = 0.1\n float inputs:shaping:cone:angle = 5\n{ROTATE_DOWN} }}'
        scene = self.convert(world(light))
        self.assertIn("W0802", self.codes(scene))
        # tan 5° · 5 = 0.44: lit within, dark without; within as bright as the sphere.
        picture = self.render(64)[:, :, 1]
        self.assertAlmostEqual(float(picture[7:9, 7:9].mean()), 1000 * 0.01 / 25, delta=0.004)
        self.assertEqual(float(picture[0, :].max()), 0)

    def test_focus_and_cone_of_a_disk_become_a_profile(self) -> None:
        api = 'prepend apiSchemas = ["ShapingAPI"]'
        light = f'def DiskLight "r" ({api}) {{ float inputs:intensity = 1000\n float inputs:radius = 0.1\n float inputs:shaping:focus = 30\n float inputs:shaping:cone:angle = 60\n{ROTATE_DOWN} }}'
        self.convert(world(light))
        picture = self.render(64)[:, :, 1]
        axis = 1000 * math.pi * 0.01 / 25 / math.pi
        self.assertAlmostEqual(float(picture[7:9, 7:9].mean()), axis, delta=0.02 * axis)
        # At 0.6875 aside: cos^(30 + 1) of the light, cos of the floor, 1/r².
        r2 = 25 + 2 * 0.6875**2
        c = 5 / math.sqrt(r2)
        expected = 1000 * 0.01 / r2 * c**32
        self.assertAlmostEqual(float(picture[[2, 2, -3, -3], [2, -3, 2, -3]].mean()), expected, delta=0.03 * expected)

    def test_profile(self) -> None:
        # 100 cd on the axis, times the intensity of the light: L π r² = 31.4.
        (self.folder / "lamp.ies").write_text("IESNA:LM-63-2002\nTILT=NONE\n1 -1 2 3 1 1 2 0 0 0\n1 1 0\n0 45 90\n0\n100 50 0\n")
        api = 'prepend apiSchemas = ["ShapingAPI"]'
        light = f'def SphereLight "r" ({api}) {{ float inputs:intensity = 10\n float inputs:radius = 1\n asset inputs:shaping:ies:file = @lamp.ies@\n{ROTATE_DOWN} }}'
        self.convert(world(light))
        expected = 10 * math.pi * 200 / 25 / math.pi
        self.assertAlmostEqual(float(self.render(64)[7:9, 7:9, 1].mean()), expected, delta=0.02 * expected)
        # Normalized the mean of the file over all directions is 1: by ∫ I d(cos) / 2 of its straight pieces in the cosine.
        self.convert(world(light.replace("float inputs:radius", "bool inputs:shaping:ies:normalize = true\n float inputs:radius")))
        c = math.cos(math.pi / 4)
        mean = (150 * (1 - c) + 50 * c) / 2
        expected = 10 * math.pi * (200 / mean) / 25 / math.pi
        self.assertAlmostEqual(float(self.render(64)[7:9, 7:9, 1].mean()), expected, delta=0.03 * expected)

    def test_mesh_light_and_geometry_light(self) -> None:
        square = """
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(-0.1, 5, -0.1), (0.1, 5, -0.1), (0.1, 5, 0.1), (-0.1, 5, 0.1)]
            uniform token subdivisionScheme = "none"
        """
        mesh = f'def Mesh "m" (prepend apiSchemas = ["MeshLightAPI"]) {{ float inputs:intensity = 1000\n{square} }}'
        geometry = f'def Mesh "m" {{ {square} }}\n def GeometryLight "g" {{ rel geometry = </World/m>\n float inputs:intensity = 1000\n }}'
        for light in (mesh, geometry):
            self.convert(world(light))
            expected = 1000 * 0.04 / 25 / math.pi
            self.assertAlmostEqual(self.centre(), expected, delta=0.03 * expected)
        self.convert(world(mesh.replace("float inputs:intensity", "bool inputs:normalize = true\n float inputs:intensity")))
        self.assertAlmostEqual(self.centre(), 1000 / 25 / math.pi, delta=0.03 * 1000 / 25 / math.pi)

    def test_what_lights_do_not_have_is_told(self) -> None:
        light = """def RectLight "r" (prepend apiSchemas = ["ShadowAPI"]) {
            rel light:filters = </World/f>
            rel collection:lightLink:includes = </World/floor>
            uniform bool collection:lightLink:includeRoot = false
            float inputs:diffuse = 0.5
            bool inputs:shadow:enable = false
        }
        def LightFilter "f" { }
        def PortalLight "p" { }"""
        scene = self.convert(world(light))
        for part in ("the light filter /World/f", "lightLink", "inputs:diffuse", "shadow:enable", "PortalLight"):
            remark = self.remark(scene, part)
            self.assertEqual(remark.code, "W0801")
            self.assertTrue(remark.path.startswith("/World/") and remark.layer == "stage.usda")

    def test_a_stage_without_lights_gets_those_of_models(self) -> None:
        scene = self.convert(f'def Xform "World" {{ {WHITE_FLOOR} }}')
        self.assertIn("luminance 18000 nits", scene.scene_text)
        self.assertIn("irradiance 150 klx", scene.scene_text)

    def test_bad_amounts(self) -> None:
        errors = self.errors(world('def SphereLight "r" { float inputs:intensity = nan\n }'))
        self.assertEqual([(e.code, e.path) for e in errors], [("E0802", "/World/r")])
        scene = self.convert(world('def SphereLight "r" { float inputs:intensity = 0\n }'))
        self.remark(scene, "a light that is off")


def sky(upper: list[tuple[int, int, int]], lower: list[tuple[int, int, int]]) -> bytes:
    """A Radiance HDR picture, 4 × 2."""
    rows = b"".join(bytes([*(128 * c for c in p), 129]) for p in (*upper, *lower))
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + rows


QUARTERS_SKY = sky([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], [(0, 0, 0)] * 4)
WHITE_SKY = sky([(1, 1, 1)] * 4, [(1, 1, 1)] * 4)


class Domes(StageTest):
    def direction(self, xyz: tuple[float, float, float], dome: str, up: str, picture: bytes = QUARTERS_SKY) -> np.ndarray:
        """The colour of the sky in a direction, by a camera with a small field that looks there."""
        (self.folder / "sky.hdr").write_bytes(picture)
        x, y, z = xyz
        yaw, pitch = math.degrees(math.atan2(-x, -z)), math.degrees(math.asin(y / math.sqrt(x * x + y * y + z * z)))
        if up == "Z":  # a camera that looks along -z is first brought to look along y
            yaw, pitch = math.degrees(math.atan2(-x, y)), math.degrees(math.asin(z / math.sqrt(x * x + y * y + z * z)))
        first = "double xformOp:rotateX:up = 90\n" if up == "Z" else "double xformOp:rotateX:up = 0\n"
        axis = "Z" if up == "Z" else "Y"
        body = f"""def Xform "World" {{
            def Camera "cam" {{
                float focalLength = 500
                {first}
                double xformOp:rotate{axis}:yaw = {yaw}
                double xformOp:rotateX:pitch = {pitch}
                uniform token[] xformOpOrder = ["xformOp:rotate{axis}:yaw", "xformOp:rotateX:up", "xformOp:rotateX:pitch"]
            }}
            def RenderSettings "settings" {{ int2 resolution = (4, 4)
            }}
            {dome}
        }}"""
        self.convert(body, HEADER.replace('"Y"', f'"{up}"'))
        return self.render(16).mean(axis=(0, 1))

    def check(self, dome: str, up: str, cases: dict[tuple[float, float, float], tuple[int, int, int]]) -> None:
        for direction, colour in cases.items():
            seen = self.direction(direction, dome, up)
            np.testing.assert_allclose(seen / seen.max(), colour, atol=0.05, err_msg=f"{direction} {up} {dome}")

    # OpenEXR: from the left, longitude falls from π; 0 is towards +z, π/2 towards +x. So the quarters from the left lie
    # at 135° (x, -z), 45° (x, z), -45° (-x, z), -135° (-x, -z).
    QUARTERS = {(1, 1, -1): (1, 0, 0), (1, 1, 1): (0, 1, 0), (-1, 1, 1): (0, 0, 1), (-1, 1, -1): (1, 1, 1)}

    def test_legacy_dome_has_its_pole_along_y(self) -> None:
        dome = 'def DomeLight "d" { asset inputs:texture:file = @sky.hdr@\n }'
        self.check(dome, "Y", self.QUARTERS)
        self.check(dome, "Z", self.QUARTERS)

    def test_dome_turns_with_its_transform(self) -> None:
        dome = 'def DomeLight "d" { asset inputs:texture:file = @sky.hdr@\n double xformOp:rotateY = 90\n uniform token[] xformOpOrder = ["xformOp:rotateY"]\n }'
        # A turn by 90° about y brings z to x and x to -z.
        self.check(dome, "Y", {(z, y, -x): c for (x, y, z), c in self.QUARTERS.items()})

    def test_pole_axis(self) -> None:
        # y becomes z, and z becomes -y.
        turned = {(x, -z, y): c for (x, y, z), c in self.QUARTERS.items()}
        for pole, up, cases in (("scene", "Z", turned), ("Z", "Y", turned), ("Y", "Z", self.QUARTERS), ("scene", "Y", self.QUARTERS)):
            dome = f'def DomeLight_1 "d" {{ asset inputs:texture:file = @sky.hdr@\n uniform token poleAxis = "{pole}"\n }}'
            self.check(dome, up, cases)

    def test_white_of_the_picture_has_the_intensity(self) -> None:
        dome = 'def DomeLight "d" { float inputs:intensity = 0.5\n float inputs:exposure = 1\n asset inputs:texture:file = @sky.hdr@\n }'
        np.testing.assert_allclose(self.direction((-1, 1, -1), dome, "Y", WHITE_SKY), [1, 1, 1], atol=0.01)

    def test_other_formats_are_told(self) -> None:
        (self.folder / "sky.png").write_bytes(b"")
        scene = self.convert('def Xform "World" { def DomeLight "d" { asset inputs:texture:file = @sky.png@\n }\n }')
        self.remark(scene, "convert it")
