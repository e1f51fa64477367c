"""What stages have in other words than scenes: instancers, displacement, lights with textures, patterns, insides. As test_export.py."""

from __future__ import annotations

import unittest

import numpy as np
from pxr import Usd, UsdGeom, UsdShade
from test_export import VIEW, RoundTrip
from test_materials import write_png

DARK = VIEW.replace("light sky { luminance 30000 nits }\n", "light sky { luminance 300 nits }\n")
PIN = "object pin { shape stem cylinder { center 0 0.15 0; radius 0.05; height 0.3 }; shape head box { min -0.1 0.3 -0.1; max 0.2 0.45 0.1; material red } }\n"
WALL = "shape wall mesh { points { - -1.5 0 0; - 1.5 0 0; - 1.5 2 0; - -1.5 2 0 }; faces { - 0 1 2 3 }; uvs { - 0 0; - 1 0; - 1 1; - 0 1 }; material surface }\n"
NOISE_HERE, NOISE_THERE = "`noise` is approximated", "another noise of this size"


class More(RoundTrip):
    def picture(self, name: str = "map.png") -> None:
        pixels = np.zeros((16, 16, 3))
        pixels[:8, :8], pixels[8:, :8], pixels[:8, 8:], pixels[8:, 8:] = (200, 40, 40), (40, 200, 40), (40, 40, 200), (220, 220, 220)
        write_png(self.folder / name, pixels)

    def opened(self) -> Usd.Stage:
        return Usd.Stage.Open(str(self.usda))

    def points(self, name: str, columns: str, rows: list[tuple[float, ...]]) -> None:
        head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *(f"property float {c}" for c in columns.split()), "end_header"]
        (self.folder / name).write_text("\n".join([*head, *(" ".join(map(str, row)) for row in rows)]) + "\n")


class Instances(More):
    def transforms(self, code: float = 0) -> np.ndarray:
        """Of the one instancer's instances into the world, as row vectors; as USD has them."""
        stage = self.opened()
        (prim,) = (p for p in stage.Traverse() if p.IsA(UsdGeom.PointInstancer))
        instancer = UsdGeom.PointInstancer(prim)
        self.assertEqual(stage.GetPrimAtPath(instancer.GetPrototypesRel().GetForwardedTargets()[0]).GetTypeName(), "Xform")
        maps = np.array(instancer.ComputeInstanceTransformsAtTime(code, code))
        return maps @ np.array(instancer.ComputeLocalToWorldTransform(code))

    def test_places_of_a_file(self) -> None:
        # A quarter turn about y takes x to -z. Sizes come first.
        half = 0.5**0.5
        self.points(
            "at.ply",
            "x y z qx qy qz qw sx sy sz",
            [(1, 0, 0, 0, 0, 0, 1, 1, 1, 1), (-1, 0, 0.5, 0, half, 0, half, 2, 1, 1), (0, 0, -1, 0, 0, 0, 1, -1, 2, 1)],
        )
        text = self.agree(VIEW + PIN + 'instances pin { points "at.ply" }\n')
        self.assertEqual(text.count("def PointInstancer"), 1)
        first, turned, mirrored = self.transforms()
        np.testing.assert_allclose(first, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 1]], atol=1e-6)
        np.testing.assert_allclose(turned, [[0, 0, -2, 0], [0, 1, 0, 0], [1, 0, 0, 0], [-1, 0, 0.5, 1]], atol=1e-6)
        np.testing.assert_allclose(mirrored, [[-1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0], [0, 0, -1, 1]], atol=1e-6)

    def test_a_grid(self) -> None:
        self.agree(VIEW + PIN + "instances pin { grid 3 1 2; spacing 1 1 1.5; transform { translate 0.5 0.1 0 } }\n")
        np.testing.assert_allclose(
            self.transforms()[:, 3, :3], [(-0.5, 0.1, -0.75), (0.5, 0.1, -0.75), (1.5, 0.1, -0.75), (-0.5, 0.1, 0.75), (0.5, 0.1, 0.75), (1.5, 0.1, 0.75)], atol=1e-6
        )  # fmt: skip

    def test_scattered(self) -> None:
        for places in (
            "scatter 20; area 4 3; seed 3; scale 0.5 1.5",
            "scatter 30; over ground; seed 5; turn 90 deg; scale 0.7 1.3",
        ):
            with self.subTest(places):
                self.agree(VIEW + PIN + f"instances pin {{ {places} }}\n")
        self.agree(
            VIEW
            + PIN
            + "shape hill sphere { center 0 -0.5 0; radius 1.2 }\nshape cap mesh { points { - -1 0 1; - 1 0 1; - 0 1.4 -1 }; faces { - 0 1 2 } }\n"
            "instances pin { scatter 12; over cap; align on }\n"
        )
        sizes = np.linalg.norm(self.transforms()[:, :3, :3], axis=2)
        np.testing.assert_allclose(sizes, 1, atol=1e-6)
        up = self.transforms()[:, 1, :3]  # the normal of the triangle: (b - a) × (c - a) = (0, 4, 2.8)
        np.testing.assert_allclose(up, np.tile(np.array([0, 4, 2.8]) / np.hypot(4, 2.8), (12, 1)), atol=1e-6)

    def test_instancers_in_objects_and_groups(self) -> None:
        text = self.agree(
            VIEW
            + PIN
            + "object row { instances pin { grid 3 1 1; spacing 0.4 1 1 } }\n"
            + "group { transform { rotate y 30 deg }; instances row { grid 1 1 2; spacing 1 1 1.2 }; instance row { transform { translate 1.5 0 0 } } }\n"
        )
        self.assertEqual(text.count("def PointInstancer"), 2)

    def test_all_of_them_move(self) -> None:
        self.agree(
            VIEW.replace("lens 40 mm", "lens 40 mm; shutter 0.5 s")
            + PIN
            + "instances pin { grid 3 1 2; transform { at 0 s { translate 0 0 0 }; at 1 s { translate 1 0.5 0 } } }\n",
            0.006,
        )
        np.testing.assert_allclose(self.transforms(12)[0, 3, :3], [-0.5, 0.25, -0.5], atol=1e-6)

    def test_those_with_lights_are_native(self) -> None:
        lamp = "object lamp { light bulb sphere { radius 0.1; luminance 200000 nits }; shape foot box { size 0.1 0.4 0.1 } }\n"
        text = self.agree(DARK + lamp + "instances lamp { grid 2 1 2; transform { translate 0 0.8 0 } }\n", 0.008, 64)
        self.assertEqual((text.count("instanceable = true"), text.count("PointInstancer")), (4, 0))


class Displacement(More):
    CAGE = "shape sheet subdivision { scheme bilinear; points { - -1.5 0 1; - 1.5 0 1; - 1.5 0 -1; - -1.5 0 -1 }; faces { - 0 1 2 3 }; uvs { - 0 0; - 1 0; - 1 1; - 0 1 }; "

    def test_by_a_picture(self) -> None:
        self.picture()
        # 200 of 255 in red is 0.784, 40 is 0.157: heights of 0.4 · (0.784 - 0.25) and 0.4 · (0.157 - 0.25).
        text = self.agree(VIEW + self.CAGE + 'displacement 0.4 m { map image "map.png" space=data; midpoint 0.25 }; material red }\n', 0.01)
        self.assertIn("outputs:mtlx:displacement.connect", text)
        self.assertIn('"ND_displacement_float"', text)
        low, high = self.info_of("sheet")
        self.assertAlmostEqual(high, 0.4 * (220 / 255 - 0.25), delta=2e-3)
        self.assertAlmostEqual(low, 0.4 * (40 / 255 - 0.25), delta=2e-3)
        # Programs without MaterialX: scale 0.4 and bias -0.1 of the red channel.
        stage = self.opened()
        preview = UsdShade.Material(stage.GetPrimAtPath("/Looks/red_sheet")).ComputeDisplacementSource()[0]
        reader = UsdShade.Shader(preview.GetInput("displacement").GetConnectedSources()[0][0].source.GetPrim())
        np.testing.assert_allclose((reader.GetInput("scale").Get()[0], reader.GetInput("bias").Get()[0]), (0.4, -0.1), atol=1e-6)

    def test_by_a_channel(self) -> None:
        self.picture()
        raised = 'displacement 0.4 m { map channel { of image "map.png" space=data; take green }; midpoint 0.25 }'
        self.agree(VIEW + self.CAGE + raised + "; material red }\n", 0.01)
        low, high = self.info_of("sheet")
        self.assertAlmostEqual(high, 0.4 * (220 / 255 - 0.25), delta=2e-3)
        self.assertAlmostEqual(low, 0.4 * (40 / 255 - 0.25), delta=2e-3)

    def test_cages_of_several_materials(self) -> None:
        points = "v -1 0 1\nv 0 0 1\nv 1 0 1\nv -1 0.4 -1\nv 0 0 -1\nv 1 0.4 -1\n"
        (self.folder / "cage.obj").write_text(points + "g left\nf 1 2 5 4\ng right\nf 2 3 6 5\n")
        blue = "material blue diffuse { reflectance rgb 0.1 0.2 0.8 }\n"
        text = self.agree(VIEW + blue + 'shape sheet subdivision "cage.obj" { material red; material blue group="right" }\n')
        self.assertEqual(text.count("def GeomSubset"), 1)
        self.assertIn("int[] indices = [1]", text)

    def info_of(self, name: str) -> tuple[float, float]:
        """The lowest and highest of a shape that was read back."""
        shapes = [s for s in self.info()["shape_list"] if s["name"].endswith(name)]
        self.assertEqual(len(shapes), 1, self.info())
        return shapes[0]["bounds_m"]["lower"][1], shapes[0]["bounds_m"]["upper"][1]

    def test_by_a_pattern(self) -> None:
        self.agree(
            VIEW + self.CAGE + "displacement 0.4 m { map noise { scale 0.5 m; octaves 2 } } }\n", 0.01, remarks=(NOISE_HERE,), more=(NOISE_THERE,)
        )
        self.agree(
            VIEW + self.CAGE + "displacement -0.2 m { map ramp { over u; stop 0 0; stop 0.5 1; stop 1 0 }; midpoint 0 }; material red }\n", 0.01
        )

    def test_two_shapes_of_one_material(self) -> None:
        self.picture()
        other = self.CAGE.replace("shape sheet", "shape blanket").replace("0 1;", "1 0;")
        text = self.agree(
            VIEW
            + self.CAGE
            + 'displacement 0.3 m { map image "map.png" space=data }; material red }\n'
            + "shape ball sphere { center 0 0.8 0; radius 0.3; material red }\n"
            + other
            + 'displacement 0.1 m { map image "map.png" space=data }; material red; transform { translate 0 0.8 -0.5 } }\n',
            0.01,
        )
        self.assertEqual(text.count('def Material "red'), 3)

    def test_by_vectors(self) -> None:
        self.picture()
        self.agree(
            VIEW + self.CAGE + 'displacement 0.2 m { map image "map.png" space=data; kind vector }; material red }\n',
            0.01,
            remarks=("`displacement` by vectors is approximated",),
        )
        self.export(VIEW + self.CAGE + 'displacement 0.2 m { map image "map.png" space=data; kind vector; space object }; material red }\n')
        self.assertIn("`displacement` by vectors in the space of the object", self.said)


class TexturedLights(More):
    def test_rectangles_with_a_picture(self) -> None:
        self.picture("map.hdr")
        self.picture()
        text = self.agree(
            DARK + 'light lamp quad { points -1 0.2 -1  1 0.2 -1  1 2 -1  -1 2 -1; luminance 60000 nits; texture image "map.png" }\n', 0.006, 64
        )
        self.assertIn("asset inputs:texture:file", text)
        self.agree(
            DARK
            + 'light lamp quad { size 2 1; luminance 60000 nits; color rgb 1 0.6 0.3; texture image "map.png"; transform { rotate y 20 deg; translate 0 1 0 } }\n',
            0.008,
            64,
        )

    def test_other_shapes_and_patterns(self) -> None:
        self.picture()
        checks = "texture checker { even 1; odd rgb 0.1 0.2 0.6; scale 4 }"
        for light, said in (
            (f"quad {{ points -1 0.2 -1  1 0.2 -1  1 2 -1  -1 2 -1; luminance 60000 nits; color rgb 1 0.6 0.3; {checks} }}", ()),
            ('quad { size 2 1; luminance 60000 nits; texture image "map.png" space=data; transform { translate 0 1 0 } }', ()),
            (f"sphere {{ center 0 1 0; radius 0.5; luminance 60000 nits; {checks} }}", ("`sphere` is approximated",)),
        ):
            with self.subTest(light):
                text = self.agree(DARK + f"light lamp {light}\n", 0.015, 96, remarks=said)
                self.assertNotIn("def RectLight", text)

    def test_disks_have_no_coordinates_that_meshes_can_have(self) -> None:
        self.export(DARK + "light lamp disk { center 0 1 0; radius 0.8; luminance 60000 nits; texture checker { scale 4 } }\n")
        self.assertIn("the texture of a light is left out", self.said)
        self.assertIn("def DiskLight", self.usda.read_text())

    def test_shapes_that_show_light(self) -> None:
        # Greys are the same; of colours the product of three numbers is some percent off.
        white = ("a texture of radiance is approximated",)
        self.agree(DARK + WALL.replace("material surface", "emission checker { even 0.7; odd 0.05; scale 4 }"), 0.008, 96, remarks=white)
        self.agree(DARK + WALL.replace("material surface", "emission checker { even rgb 0.3 0.6 0.9; odd 0.05; scale 4 }"), 0.03, 96, remarks=white)


class Patterns(More):
    def test_checks(self) -> None:
        self.picture()
        for pattern in (
            "checker { even rgb 0.8 0.2 0.1; odd 0.1; scale 4 }",
            'checker { even image "map.png"; odd placed { map image "map.png"; scale 3 2 }; scale 3 }',
        ):
            with self.subTest(pattern):
                text = self.agree(VIEW + WALL + f"material surface diffuse {{ reflectance {pattern} }}\n", 0.008)
                self.assertIn('"ND_checkerboard_color3"', text)
        self.agree(
            VIEW
            + WALL
            + "material surface openpbr { base-metalness checker { even 1; odd 0; scale 4 }; base-color rgb 0.8 0.6 0.2; specular-roughness 0.5 }\n",
            0.01,
            96,
        )

    def test_cubes_stand_where_they_stood(self) -> None:
        shapes = "shape a box { min -1.2 0 -0.5; max -0.2 1 0.5; material surface }\nshape b sphere { radius 0.6; material surface; transform { rotate y 30 deg; translate 0.8 0.6 0 } }\n"
        text = self.agree(VIEW + shapes + "material surface diffuse { reflectance checker { even 0.8; odd rgb 0.1 0.2 0.5; scale 30 cm } }\n", 0.008)
        # The space of a Cube would be another one than that of the box, which lies aside of its origin.
        self.assertEqual((text.count("def Cube"), text.count("def Sphere")), (0, 1))

    def test_ramps(self) -> None:
        for ramp in (
            "over u; stop 0 rgb 0.9 0.5 0.2; stop 1 rgb 0.1 0.2 0.6",
            "over v; stop 0 0.1; stop 1 0.8",
            "over v; stop 0.2 rgb 0.8 0.1 0.1; stop 0.5 rgb 0.1 0.8 0.1; stop 0.5 rgb 0.1 0.1 0.8; stop 0.9 0.7",
            "over y; stop 0.1 rgb 0.9 0.5 0.2; stop 0.9 rgb 0.1 0.2 0.6",
            "input checker { even 0.2; odd 0.9; scale 4 }; stop 0 0; stop 0.5 rgb 0.2 0.4 0.6; stop 1 0.9",
        ):
            with self.subTest(ramp):
                self.agree(VIEW + WALL + f"material surface diffuse {{ reflectance ramp {{ {ramp} }} }}\n", 0.008)
        self.agree(
            VIEW
            + WALL
            + "material surface diffuse { reflectance placed { map ramp { over u; stop 0 0.1; stop 1 0.8 }; scale 2 1; rotate 30 deg } }\n",
            0.008,
        )

    def test_noise(self) -> None:
        ball = "shape ball sphere { radius 0.8; material surface; transform { translate 0 0.8 0 } }\n"
        for noise in ("noise { scale 40 cm }", "noise { scale 0.3 m; octaves 6; lacunarity 2.5; gain 0.6 }", "noise { scale 0.5 m; octaves 1 }"):
            with self.subTest(noise):
                text = self.agree(
                    VIEW + ball + f"material surface diffuse {{ reflectance {noise} }}\n", 0.008, remarks=(NOISE_HERE,), more=(NOISE_THERE,)
                )
                self.assertIn('"ND_fractal3d_float"', text)
                # The same strength comes back, or a ramp would change it.
                self.assertNotIn("ramp", self.scene.read_text())
        # 0.5 · 2/√3 / (0.982 √2) over 1 + 1/2 + 1/4 + 1/8.
        stage_text = self.export(VIEW + ball + "material surface diffuse { reflectance noise { scale 20 cm; seed 4 } }\n") and self.usda.read_text()
        self.assertIn("without a seed", self.said)
        self.assertIn("float inputs:amplitude = 0.22172", stage_text)
        self.assertIn("float inputs:in2 = 5\n", stage_text)
        self.agree(
            VIEW + ball + "material surface diffuse { reflectance ramp { input noise { scale 30 cm }; stop 0.4 rgb 0.8 0.2 0.1; stop 0.6 0.2 } }\n",
            0.008,
            remarks=(NOISE_HERE,),
            more=(NOISE_THERE,),
        )

    def test_channels_and_alpha(self) -> None:
        self.picture()
        self.agree(VIEW + WALL + 'material surface diffuse { reflectance channel { of image "map.png" space=data; take green } }\n', 0.008)
        self.agree(
            VIEW + WALL + 'material surface openpbr { specular-roughness channel { of image "map.png" space=data; take blue }; base-color 0.4 }\n',
            0.01,
            96,
        )
        self.agree(
            VIEW
            + WALL
            + 'material surface diffuse { reflectance placed { map placed { map image "map.png"; scale 2 1; offset 0.1 0 }; scale 1 3; rotate 20 deg } }\n',
            0.008,
        )

    def test_what_cannot_be_written_is_named(self) -> None:
        self.export(VIEW + WALL + "material surface diffuse { reflectance triplanar { map checker { scale 4 } } }\n")
        self.assertIn("texture `triplanar` is left out", self.said)


class Insides(More):
    BALL = "shape ball sphere { center 0 0.8 0; radius 0.8; material surface; interior inside }\n"

    def test_clear_solids_with_a_medium(self) -> None:
        for material, medium in (
            ("dielectric { ior 1.3 }", "scattering 2 per-m; absorption 0.5 per-m; phase henyey-greenstein 0.5"),
            ("dielectric { ior 1.4; roughness 0.2 }", "extinction 3 per-m; albedo 0.8"),
            ("boundary", "extinction 2 per-m; albedo 0.6"),
            ("openpbr { transmission-weight 1; specular-roughness 0.1 }", "absorption 1.5 per-m"),
        ):
            with self.subTest(material):
                self.agree(VIEW + self.BALL + f"material surface {material}\nmedium inside homogeneous {{ {medium} }}\n", 0.01, 96)

    def test_depth_colour_and_scattering(self) -> None:
        self.export(
            VIEW
            + self.BALL
            + "material surface dielectric { ior 1.3 }\nmedium inside homogeneous { scattering 3 per-m; absorption 1 per-m; phase henyey-greenstein 0.5 }\n"
        )
        stage = self.opened()
        shader = UsdShade.Shader(stage.GetPrimAtPath("/Looks/surface/surface"))
        value = {
            name: shader.GetInput(name).Get()
            for name in ("transmission_depth", "transmission_color", "transmission_scatter", "transmission_scatter_anisotropy")
        }
        # The mean free path of 4 per metre, what is left after it, and what it scatters of that.
        self.assertAlmostEqual(value["transmission_depth"], 0.25, 6)
        np.testing.assert_allclose(value["transmission_color"], [np.exp(-1)] * 3, rtol=1e-6)
        np.testing.assert_allclose(value["transmission_scatter"], [0.75] * 3, rtol=1e-6)
        self.assertAlmostEqual(value["transmission_scatter_anisotropy"], 0.5, 6)

    def test_coloured_media(self) -> None:
        self.agree(
            VIEW
            + self.BALL
            + "material surface dielectric { ior 1.3 }\nmedium inside homogeneous { scattering 1 per-m; absorption rgb 0.2 0.6 1.5 per-m }\n",
            0.03,
            96,
            remarks=("a medium that varies with the wavelength",),
        )

    def test_what_others_cannot_hold_is_named(self) -> None:
        self.export(VIEW + self.BALL + "material surface boundary\nmedium inside noise { scale 20 cm; extinction 4 per-m }\n")
        self.assertIn("a `boundary` is left out", self.said)
        self.export(VIEW + self.BALL + "material surface dielectric { ior 1.3 }\nmedium inside noise { scale 20 cm; extinction 4 per-m }\n")
        self.assertIn("an `interior` is left out", self.said)

    def test_translucent_materials(self) -> None:
        self.agree(
            VIEW
            + self.BALL.replace("; interior inside", "")
            + "material surface subsurface { reflectance rgb 0.8 0.5 0.3; mean-free-path 5 cm; roughness 0.3; ior 1.4; boundary diffuse }\n",
            0.03,
            96,
            remarks=("`subsurface` is approximated",),
        )
        self.agree(VIEW + WALL + "material surface diffuse-transmission { reflectance 0.2; transmittance 0.5 }\n", 0.01)


if __name__ == "__main__":
    unittest.main()
