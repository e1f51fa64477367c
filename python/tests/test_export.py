"""Scenes as stages and back: the pictures are equal, tile by tile, and usd-core has nothing to say against the stages.

Of both scenes several pictures are rendered with independent random numbers. A tile's difference is compared with its standard
error, to which the relative difference is added that the case allows. The bound of 5 was fixed before: 48 tiles of three
channels and some twenty cases exceed it by chance once in five hundred runs.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom, UsdShade, UsdUtils
from support import StageTest, program, read_exr
from test_materials import write_png

from abbe import usd

SIZE, TILE, SEEDS, BOUND = (32, 24), 4, 4, 5.0
VIEW = """scene 1
camera eye { from 0 1.5 6; look-at 0 0.5 0; lens 40 mm; exposure -1 stops }
film { size 32 24 }
light sky { luminance 30000 nits }
shape ground quad { points -4 0 4  4 0 4  4 0 -4  -4 0 -4; material grey }
material grey diffuse { reflectance 0.5 }
material red diffuse { reflectance rgb 0.6 0.1 0.1 }
"""


class RoundTrip(StageTest):
    count = 0

    def export(self, text: str) -> dict[str, object]:
        """Writes the scene and its stage, of another name each time: USD reads what somebody holds once. What the program says of it."""
        self.count += 1
        self.usda = self.folder / f"stage{self.count}.usda"
        (self.folder / "in.scene").write_text(text)
        command = [program(), "export", str(self.folder / "in.scene"), "--to", "usda", "-o", str(self.usda), "--force", "--json"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.said = done.stderr
        result: dict[str, object] = json.loads(done.stdout)
        return result

    def pictures(self, scene: Path, samples: int) -> npt.NDArray[np.float64]:
        found = []
        for seed in range(SEEDS):
            out = self.folder / f"{scene.stem}.{seed}.exr"
            words = [
                program(),
                "render",
                str(scene),
                "-o",
                str(out),
                "--samples",
                str(samples),
                "--seed",
                str(seed + (100 if scene.stem == "in" else 0)),
            ]
            done = subprocess.run([*words, "--quiet"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr + (scene.read_text() if scene.stem != "in" else ""))
            found.append(read_exr(out))
        return np.array(found)

    def agree(self, text: str, rel: float = 0.004, samples: int = 48, remarks: tuple[str, ...] = (), more: tuple[str, ...] = ()) -> str:
        """Exports, imports, renders both and compares. Returns the text of the stage."""
        result = self.export(text)
        for remark in remarks:
            self.assertIn(remark, self.said)
        told = [line for line in self.said.splitlines() if line.startswith(("warning[W08", "error"))]
        self.assertEqual(len(told), len(remarks), self.said)
        self.assertGreaterEqual(result["warnings"], len(told))
        scene = usd.load(self.usda)
        self.assertEqual([str(r) for r in scene.report.remarks if not any(m in str(r) for m in more)], [])
        self.scene = self.folder / "back.scene"
        scene.write(self.scene, force=True)
        a, b = (self.tiles(self.pictures(self.folder / name, samples)) for name in ("in.scene", "back.scene"))
        allowed = np.sqrt((a[1] + b[1]) / SEEDS) + rel * np.abs(a[0]) + 1e-4
        ratio = np.abs(a[0] - b[0]) / allowed
        worst = np.unravel_index(int(ratio.argmax()), ratio.shape)
        self.assertLess(ratio.max(), BOUND, f"tile {worst}: {a[0][worst]:.4g} and {b[0][worst]:.4g}\n{scene.scene_text}")
        self.assertGreater(a[0].max(), 0.01)
        self.complies()
        return (self.usda).read_text()

    @staticmethod
    def tiles(pictures: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Means of all tiles and channels, and the variance of one picture's."""
        n, height, width, _ = pictures.shape
        cut = pictures.reshape(n, height // TILE, TILE, width // TILE, TILE, 3).mean(axis=(2, 4))
        return cut.mean(axis=0), np.maximum(cut.var(axis=0, ddof=1), cut.var(axis=0, ddof=1).mean())

    def complies(self) -> None:
        path = str(self.usda)
        if hasattr(UsdUtils, "ComplianceChecker"):
            checker = UsdUtils.ComplianceChecker(arkit=False, skipARKitRootLayerCheck=True)
            checker.CheckCompliance(path)
            self.assertEqual(list(checker.GetErrors()) + list(checker.GetFailedChecks()), [])
        stage = Usd.Stage.Open(path)
        self.assertEqual(list(stage.GetCompositionErrors()), [])
        for prim in stage.TraverseAll():
            self.assertTrue(prim.IsDefined() or prim.IsAbstract(), prim.GetPath())
            for material in [UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]]:
                self.assertTrue(not material or material.GetPrim().IsA(UsdShade.Material))


class Geometry(RoundTrip):
    def test_simple_shapes(self) -> None:
        self.agree(
            VIEW + "shape ball sphere { center -1.5 0.6 0; radius 0.6; material red }\n"
            "shape block box { min -0.3 0 -0.3; max 0.4 0.9 0.3; material red; transform { rotate y 30 deg } }\n"
            "shape can cylinder { center 1.4 0.5 0; radius 0.4; height 1; axis 0.2 1 0 }\n"
            "shape hat cone { center 2.4 0.5 -1; radius 0.4; height 1; material red }\n"
        )

    def test_shapes_that_usd_lacks_are_polygons(self) -> None:
        self.agree(
            VIEW + "shape ring torus { center 0 0.8 0; axis 0 0 1; major-radius 0.6; minor-radius 0.2; material red }\n"
            "shape plate disk { center -1.6 0.6 0; normal 0 0.3 1; radius 0.5; material red }\n"
            "shape pipe cylinder { center 1.6 0.6 0; radius 0.4; height 1; caps off }\n",
            0.01,
            remarks=("`torus` is approximated", "`disk` is approximated", "`cylinder` is approximated"),
        )

    def test_meshes_with_coordinates_and_attributes(self) -> None:
        mesh = (
            "shape sheet mesh { points { - -1 0 0; - 1 0 0; - 1 1.5 0; - -1 1.5 0 }; faces { - 0 1 2 3 }; uvs { - 0 0; - 1 0; - 1 1; - 0 1 }\n"
            '  attribute "color" { - 1 0 0; - 0 1 0; - 0 0 1; - 1 1 1 }; material { diffuse { reflectance attribute "color" } } }\n'
        ).replace('material { diffuse { reflectance attribute "color" } }', 'material diffuse { reflectance attribute "color" }')
        text = self.agree(VIEW + mesh)
        self.assertIn("primvars:displayColor", text)
        self.assertIn("texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)]", text)

    def test_subdivision(self) -> None:
        cube = "points { - -1 0 -1; - 1 0 -1; - 1 0 1; - -1 0 1; - -1 2 -1; - 1 2 -1; - 1 2 1; - -1 2 1 }; faces { - 0 1 2 3; - 4 7 6 5; - 0 4 5 1; - 1 5 6 2; - 2 6 7 3; - 3 7 4 0 }"
        for rules in ("crease 4 5 6 7 4 sharpness=2.5; corner 0 sharpness=4", "holes 1; boundary edge-only", "scheme bilinear"):
            text = self.agree(VIEW + f"shape cage subdivision {{ {cube}; {rules}; material red }}\n")
            stage = Usd.Stage.Open(str(self.usda))
            mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/World/cage"))
            self.assertEqual(len(mesh.GetFaceVertexCountsAttr().Get()), 6)
            if "crease" in rules:
                self.assertEqual(list(mesh.GetCreaseIndicesAttr().Get()), [4, 5, 5, 6, 6, 7, 7, 4])
                self.assertEqual(list(mesh.GetCreaseSharpnessesAttr().Get()), [2.5] * 4)
                self.assertEqual((list(mesh.GetCornerIndicesAttr().Get()), list(mesh.GetCornerSharpnessesAttr().Get())), ([0], [4]))
            self.assertEqual(list(mesh.GetHoleIndicesAttr().Get() or []), [1] if "holes" in rules else [])
        self.assertIn('subdivisionScheme = "bilinear"', text)

    def test_seams_of_cages(self) -> None:
        self.agree(
            VIEW
            + "shape cage subdivision { points { - -1 0 0; - 0 0 0.3; - 1 0 0; - -1 1.6 0; - 0 1.6 0.3; - 1 1.6 0 }; faces { - 0 1 4 3; - 1 2 5 4 }\n"
            "  uvs { - 0 0; - 0.5 0; - 0.5 1; - 0 1; - 0.6 0; - 1 0; - 1 1; - 0.6 1 }; uv-faces { - 0 1 2 3; - 4 5 6 7 }; material red }\n"
        )

    def test_curves_and_points(self) -> None:
        self.agree(
            VIEW + "shape wire curves { radius 0.08; points { - -2 0 0; - -1 1 0; - 0 1.5 0.5; - 1 1 0; - 2 0 0 }; material red }\n"
            "shape pole curves { basis linear; radii 0.1 0.02; points { - 2 0 0; - 2 1.6 0 } }\n"
            "shape spray points { radius 0.15; points { - -2 1 0; - -1.6 1.4 0; - -2.2 1.6 0.2 }; material red }\n",
            0.006,
        )

    def test_instances_and_groups(self) -> None:
        text = self.agree(
            VIEW
            + "object tree { shape trunk cylinder { center 0 0.5 0; radius 0.1; height 1 }; shape crown sphere { center 0 1.1 0; radius 0.4; material red } }\n"
            "object row { instance tree { transform { translate -0.5 0 0 } }; instance tree { transform { scale 0.7; translate 0.5 0 0 } } }\n"
            "group { transform { rotate y 20 deg }; instance row { transform { translate -1 0 0 } }; instance row { transform { translate 1 0 -1 } } }\n"
        )
        self.assertEqual(text.count("instanceable = true"), 4)
        stage = Usd.Stage.Open(str(self.usda))
        self.assertEqual(len(stage.GetPrototypes()), 2)  # a row, and the tree in it

    def test_z_up_and_grid(self) -> None:
        self.agree(
            "scene 1 up=z\ncamera { from 0 -6 2; look-at 0 0 0.5 }\nfilm { size 32 24 }\nlight sky { luminance 60000 nits }\n"
            "object pin { shape cylinder { center 0 0 0.4; radius 0.1; height 0.8 } }\ninstances pin { grid 3 2 1; spacing 1 1 1 }\n"
            "shape ground disk { radius 4 }\n",
            remarks=("`disk` is approximated",),
        )


class Motion(RoundTrip):
    def test_turning_and_moving(self) -> None:
        text = self.agree(
            VIEW.replace("lens 40 mm", "lens 40 mm; shutter 0.5 s; time 0.25 s")
            + "shape block box { size 1 0.4 0.4; material red; transform { at 0 s { rotate y 0 deg; translate 0 1 0 }; at 1 s { rotate y 180 deg; translate 0.5 1 0 } } }\n"
            "group { transform { at 0 s { translate -1 0 0 }; at 1 s { translate -2 0.5 0 } }; shape sphere { center 0 0.5 0; radius 0.4 } }\n",
            0.006,
        )
        self.assertIn("xformOp:transform.timeSamples", text)

    def test_a_turn_of_two_rounds(self) -> None:
        self.export(VIEW + "shape block box { transform { at 0 s { rotate y 0 deg }; at 1 s { rotate y 720 deg } } }\n")
        stage = Usd.Stage.Open(str(self.usda))
        block = UsdGeom.Xformable(stage.GetPrimAtPath("/World/block"))
        for code, turn in ((0, 0), (3, 90), (6, 180), (9, 270), (12, 360)):  # two rounds a second are 30 degrees a frame
            m = np.array(block.GetLocalTransformation(float(code)))
            np.testing.assert_allclose(m[0, :3], [np.cos(np.radians(turn)), 0, -np.sin(np.radians(turn))], atol=1e-6)

    def test_deformation(self) -> None:
        text = self.agree(
            VIEW.replace("lens 40 mm", "lens 40 mm; shutter 1 s")
            + "shape sheet mesh { faces { - 0 1 2 3 }; at 0 s { points { - -1 0 0; - 1 0 0; - 1 1 0; - -1 1 0 } }; at 1 s { points { - -1 0 0; - 1 0 0; - 1 2 0; - -1 1 0 } }; material red }\n"
        )
        self.assertIn("point3f[] points.timeSamples", text)

    def test_a_camera_that_moves(self) -> None:
        self.agree(
            VIEW.replace(
                "camera eye { from 0 1.5 6; look-at 0 0.5 0; lens",
                "camera eye { at 0 s { from 0 1.5 6; look-at 0 0.5 0 }; at 1 s { from 0.6 1.5 6; look-at 0 0.5 0 }; shutter 1 s; lens",
            )
            + "shape ball sphere { center 0 0.6 0; radius 0.6; material red }\n",
            0.006,
        )


class Cameras(RoundTrip):
    BALLS = "shape near sphere { center -0.6 0.6 2; radius 0.4; material red }\nshape far sphere { center 1 0.8 -3; radius 0.8; material red }\n"

    def test_depth_of_field(self) -> None:
        self.agree(VIEW.replace("lens 40 mm", "lens 80 mm; f-stop 0.8; focus 4 m") + self.BALLS, 0.006, 128)

    def test_shift_fov_and_crop(self) -> None:
        text = self.agree(VIEW.replace("lens 40 mm", "fov 40 deg; shift 6 -3 mm") + self.BALLS)
        self.assertIn("horizontalApertureOffset", text)

    def test_orthographic(self) -> None:
        self.agree(VIEW.replace("camera eye {", "camera eye orthographic { width 5;").replace("lens 40 mm;", "") + self.BALLS)

    def test_several_cameras_and_the_output(self) -> None:
        text = VIEW.replace("film {", 'camera other { from 3 1 3; look-at 0 0 0 }\nfilm { output "shot.exr";')
        self.export(text)
        scene = usd.load(self.usda)
        self.assertIn('output "shot.exr"', scene.scene_text.replace("output shot.exr", 'output "shot.exr"'))
        self.assertEqual(scene.scene_text.count("camera "), 2)


class Lights(RoundTrip):
    DARK = VIEW.replace("light sky { luminance 30000 nits }\n", "")

    def test_lights_with_a_surface(self) -> None:
        for light in (
            "quad { size 1 0.6; luminance 900000 nits; transform { rotate x 90 deg; translate 0 2.5 0 } }",
            "quad { points -1 2.4 -0.5  1 2.4 -0.5  1 2.4 0.5  -1 2.4 0.5; power 90000 lm }",
            "disk { center 0 2.4 0; normal 0.2 -1 0; radius 0.5; luminance 900000 nits; color rgb 1 0.6 0.3 }",
            "sphere { center 1 1.5 1; radius 0.3; power 120000 lm; color blackbody 3000 K }",
        ):
            with self.subTest(light):
                self.agree(self.DARK + f"light lamp {light}\nshape ball sphere {{ center -0.5 0.5 0; radius 0.5; material red }}\n", 0.006, 64)

    def test_points_and_spots(self) -> None:
        shaped = ("the shaping of a light with an area",)
        self.agree(self.DARK + "light lamp point { position 1 2 1; intensity 300000 cd; color rgb 0.5 0.8 1 }\n", samples=64)
        self.agree(
            self.DARK + "light lamp spot { position 0 3 1; look-at 0 0 0; angle 60 deg; inner-angle 30 deg; intensity 900000 cd }\n",
            samples=64,
            more=shaped,
        )

    def test_far_lights(self) -> None:
        self.agree(
            VIEW.replace("30000 nits", "10000 nits; color rgb 0.5 0.7 1")
            + "light day sun { elevation 40 deg; azimuth 120 deg; irradiance 50 klx; angular-diameter 4 deg }\n"
            "shape ball sphere { center 0 0.6 0; radius 0.6 }\n",
            0.006,
            128,
        )
        self.agree(
            VIEW + "light day sun { toward 1 -2 -1; irradiance 30 klx; angular-diameter 0 deg }\nshape ball sphere { center 0 0.6 0; radius 0.6 }\n",
            samples=64,
        )

    def test_environments_stand_as_they_stood(self) -> None:
        from test_lights import sky

        picture = sky([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], [(1, 1, 0), (0, 1, 1), (1, 0, 1), (0, 0, 0)])
        (self.folder / "sky.hdr").write_bytes(picture)
        for head, turn in (("scene 1", "rotate y 25 deg"), ("scene 1 up=z", "rotate z 40 deg")):
            ahead = "from 0 0 0; look-at 1 0.5 0.2" if "up" not in head else "from 0 0 0; look-at 1 0.2 0.5"
            self.agree(
                f'{head}\ncamera {{ {ahead}; fov 100 deg }}\nfilm {{ size 32 24 }}\nlight environment "sky.hdr" {{ exposure 0.5 stops; transform {{ {turn} }} }}\n'
            )

    def test_meshes_that_shine(self) -> None:
        lamp = "points { - -0.5 2.4 -0.5; - 0.5 2.4 -0.5; - 0.5 2.4 0.5; - -0.5 2.4 0.5 }; faces { - 0 1 2 3 }"
        text = self.agree(self.DARK + f"light lamp mesh {{ {lamp}; luminance 900000 nits }}\n", 0.006, 64)
        self.assertIn("MeshLightAPI", text)

    def test_what_usd_lacks_is_named(self) -> None:
        result = self.export(VIEW + "light day daylight { }\n")
        self.assertEqual(result["warnings"], 1)
        self.assertIn("light `daylight` is left out", self.said)


class Materials(RoundTrip):
    BALL = "shape ball sphere { center 0 0.8 0; radius 0.8; material surface }\n"

    def test_openpbr(self) -> None:
        for parameters in (
            "base-color rgb 0.2 0.5 0.8; base-diffuse-roughness 0.6; specular-roughness 0.4; specular-ior 1.7",
            "base-metalness 1; base-color rgb 0.9 0.6 0.3; specular-color rgb 0.9 0.9 1; specular-roughness 0.25; specular-roughness-anisotropy 0.5",
            "coat-weight 1; coat-color rgb 0.9 0.5 0.4; coat-roughness 0.1; base-color 0.6; fuzz-weight 0.4; fuzz-color rgb 0.3 0.4 1",
            "transmission-weight 1; transmission-color rgb 0.6 0.9 0.7; transmission-depth 30 cm; specular-roughness 0.1",
            "subsurface-weight 1; subsurface-color rgb 0.8 0.5 0.3; subsurface-radius 10 cm",
            "thin-film-weight 1; thin-film-thickness 400 nm; base-metalness 1; specular-roughness 0.2",
            "emission-luminance 20000 nits; emission-color rgb 1 0.5 0.2; base-weight 0.2",
            "geometry-thin-walled on; transmission-weight 1; specular-roughness 0; opacity 0.7",
        ):
            with self.subTest(parameters):
                self.agree(VIEW + self.BALL + f"material surface openpbr {{ {parameters} }}\n", 0.008, 48)
                # An even sky shows little of gloss, so the numbers are looked at, too.
                back = " ".join(self.scene.read_text().translate(str.maketrans("{};", "   ")).split())
                for part in parameters.replace("30 cm", "0.3 m").replace("10 cm", "0.1 m").split("; "):
                    self.assertIn(f" {part} ", back)

    def test_other_materials(self) -> None:
        self.agree(VIEW + self.BALL + "material surface dielectric { ior 1.4; roughness 0.2 }\n", 0.01, 96)
        self.agree(VIEW + self.BALL + "material surface conductor { index metal Au; roughness 0.3 }\n", 0.05, 48, ("`conductor` is approximated",))
        result = self.export(VIEW + self.BALL + "material surface mix { first diffuse; second diffuse; amount 0.5 }\n")
        self.assertIn("`mix` is approximated", self.said)
        self.assertEqual(result["warnings"], 1)

    def test_pictures(self) -> None:
        pixels = np.zeros((16, 16, 3))
        pixels[:8, :8], pixels[8:, :8], pixels[:8, 8:], pixels[8:, 8:] = (200, 40, 40), (40, 200, 40), (40, 40, 200), (220, 220, 220)
        write_png(self.folder / "map.png", pixels)
        wall = "shape wall mesh { points { - -1.5 0 0; - 1.5 0 0; - 1.5 2 0; - -1.5 2 0 }; faces { - 0 1 2 3 }; uvs { - 0 0; - 1 0; - 1 1; - 0 1 }; material surface }\n"
        for texture in (
            'image "map.png"',
            'image "map.png" space=data',
            'placed { map image "map.png"; scale 2 3; rotate 30 deg; offset 0.2 0.1 }',
            'product { first image "map.png"; second rgb 0.5 0.9 0.2 }',
        ):
            with self.subTest(texture):
                text = self.agree(VIEW + wall + f"texture t {texture}\nmaterial surface diffuse {{ reflectance t }}\n")
                self.assertIn("outputs:surface.connect", text)
        self.agree(
            VIEW
            + wall
            + 'material surface openpbr { base-color 0.5; specular-roughness image "map.png" space=data; normal image "map.png" space=data strength=0.5 }\n',
            0.01,
            128,
        )

    def test_textures_that_cannot_be_written_are_named(self) -> None:
        self.export(VIEW + self.BALL + "material surface diffuse { reflectance triplanar { map checker { scale 4 } } }\n")
        self.assertIn("texture `triplanar` is left out", self.said)

    def test_programs_without_materialx_see_a_preview(self) -> None:
        self.export(VIEW + self.BALL + "material surface openpbr { base-color rgb 0.2 0.5 0.8; base-metalness 1; specular-roughness 0.4 }\n")
        stage = Usd.Stage.Open(str(self.usda))
        shader = UsdShade.Material(stage.GetPrimAtPath("/Looks/surface")).ComputeSurfaceSource()[0]
        self.assertEqual(shader.GetIdAttr().Get(), "UsdPreviewSurface")
        self.assertAlmostEqual(shader.GetInput("roughness").Get(), 0.4, 6)
        np.testing.assert_allclose(shader.GetInput("diffuseColor").Get(), [0.2, 0.5, 0.8], rtol=1e-6)


class Command(RoundTrip):
    SCENE = VIEW + "shape ball sphere { center 0 0.6 0; radius 0.6; material red }\n"

    def run_command(self, *words: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "ABBE": program(), "PYTHONPATH": os.pathsep.join(sys.path)}
        return subprocess.run([sys.executable, "-m", "abbe.usd.command", *words], capture_output=True, text=True, cwd=self.folder, env=environment)

    def test_text_and_crates_are_the_same_stage(self) -> None:
        (self.folder / "a.scene").write_text(self.SCENE)
        texts = []
        for name in ("a.usda", "b.usdc", "new/c.usd"):
            done = self.run_command("a.scene", "--to", name)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            texts.append(usd.load(self.folder / name).scene_text.split("\n", 1)[1])
        self.assertTrue((self.folder / "b.usdc").read_bytes().startswith(b"PXR-USDC"))
        self.assertEqual(len(set(texts)), 1)
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith(".")], [])

    def test_what_goes_wrong(self) -> None:
        (self.folder / "a.scene").write_text(self.SCENE)
        (self.folder / "there.usda").write_text("")
        for words, code, said in (
            (("a.scene", "--to", "a.obj"), 2, ".usdc"),
            (("a.scene", "--to", "there.usda"), 2, "--force"),
            (("a.scene", "--to", "b.usda", "--frame", "3"), 2, "--frame"),
            (("gone.scene", "--to", "b.usda"), 3, "gone.scene"),
        ):
            done = self.run_command(*words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(said, done.stderr)
        self.assertFalse((self.folder / "b.usda").exists())


class Volumes(RoundTrip):
    def test_a_cloud(self) -> None:
        self.volume("cumulus", "cloud.vdb", 16)
        self.agree(
            "scene 1\ncamera { from 0 236 1500; look-at 0 236 0; fov 45 deg }\nfilm { size 32 24 }\nlight sky { luminance 60000 nits }\n"
            'volume cloud vdb "cloud.vdb" { scattering 0.01 per-m; absorption rgb 0.01 0.02 0.03 per-m; phase henyey-greenstein 0.6 }\n',
            0.01,
            256,
        )


if __name__ == "__main__":
    unittest.main()
