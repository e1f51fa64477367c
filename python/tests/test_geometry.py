"""Shapes, meshes, curves, points: where they are, and which faces, edges and coordinates they have."""

from __future__ import annotations

import math

import numpy as np
from support import HEADER, StageTest

GRID = """
        int[] faceVertexCounts = [4, 4]
        int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 5, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)]
"""


def world(body: str) -> str:
    return f'def Xform "World" {{\n{body}\n}}\n'


def polygons(extra: str = "") -> str:
    return world(f'def Mesh "m" {{\n{GRID}\n uniform token subdivisionScheme = "none"\n{extra}\n }}')


def cage(extra: str = "") -> str:
    return world(f'def Mesh "m" {{\n{GRID}\n{extra}\n }}')


class Shapes(StageTest):
    def test_bounds_of_formulas(self) -> None:
        cases = {
            'Sphere "s" { double radius = 2': ([-2, -2, -2], [2, 2, 2]),
            'Cube "s" { double size = 3': ([-1.5] * 3, [1.5] * 3),
            'Cone "s" { double radius = 1\n double height = 4\n uniform token axis = "X"': ([-2, -1, -1], [2, 1, 1]),
            'Cylinder "s" { double radius = 1\n double height = 4': ([-1, -1, -2], [1, 1, 2]),
            'Cylinder "s" { double radius = 1\n double height = 4\n uniform token axis = "Y"': ([-1, -2, -1], [1, 2, 1]),
            'Cylinder_1 "s" { double radiusTop = 1\n double radiusBottom = 2\n double height = 4': ([-2, -2, -2], [2, 2, 2]),
            'Capsule "s" { double radius = 1\n double height = 4\n uniform token axis = "Y"': ([-1, -3, -1], [1, 3, 1]),
            'Capsule_1 "s" { double radiusTop = 1\n double radiusBottom = 2\n double height = 4': ([-2, -2, -4], [2, 2, 3]),
            'Plane "s" { double width = 4\n double length = 6': ([-2, -3, 0], [2, 3, 0]),
            'Plane "s" { double width = 4\n double length = 6\n uniform token axis = "Y"': ([-2, 0, -3], [2, 0, 3]),
            'Plane "s" { double width = 4\n double length = 6\n uniform token axis = "X"': ([0, -3, -2], [0, 3, 2]),
        }
        for text, (lower, upper) in cases.items():
            self.convert(world(f"def {text}\n }}"))
            self.assert_bounds(lower, upper, 3)

    def test_the_tip_of_a_cone_is_up_its_axis(self) -> None:
        for up in "YZ":
            scene = self.convert(world('def Cone "c" { uniform token axis = "Z"\n }'), HEADER.replace('"Y"', f'"{up}"'))
            self.assertIn("cone { axis 0 0 1; radius 1; height 2 }", scene.scene_text)

    def test_planes_face_their_axis(self) -> None:
        # Front and back differ where something emits: light leaves the outer side.
        for axis, position in (("X", "(-3, 0, 0)"), ("Y", "(0, -3, 0)"), ("Z", "(0, 0, -3)")):
            scene = self.convert(world(f'def Plane "p" {{ uniform token axis = "{axis}"\n }}'))
            del position
            line = next(x for x in scene.scene_text.splitlines() if x.startswith("shape"))
            rows = [[float(x) for x in row.split()] for row in line.split("{ -", 1)[1].split(" }")[0].split("; -")]
            a, b, c = (np.array(row) for row in rows[:3])
            normal = np.cross(b - a, c - a)
            self.assertEqual(int(normal.argmax()), "XYZ".index(axis))
            self.assertGreater(normal.max(), 0)

    def test_units_and_the_up_axis(self) -> None:
        body = world(
            'def Sphere "s" { double radius = 2\n double3 xformOp:translate = (0, 0, 10)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }'
        )
        for metres in (0.01, 0.001, 1.0, 0.0254, 0.25):
            scene = self.convert(body, HEADER.replace("metersPerUnit = 1", f"metersPerUnit = {metres}").replace('"Y"', '"Z"'))
            self.assert_bounds([-2 * metres, -2 * metres, 8 * metres], [2 * metres, 2 * metres, 12 * metres])
            self.assertIn("up=z", scene.scene_text)

    def test_transforms(self) -> None:
        body = """def Xform "a" {
            double3 xformOp:translate = (1, 2, 3)
            float3 xformOp:rotateXYZ = (0, 0, 90)
            float3 xformOp:scale = (2, 1, 1)
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]
            def Cube "c" { double size = 2
                double3 xformOp:translate = (1, 0, 0)
                uniform token[] xformOpOrder = ["xformOp:translate"]
            }
            def Cube "reset" { double size = 1
                double3 xformOp:translate = (-5, 0, 0)
                uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]
            }
        }"""
        scene = self.convert(world(body))
        # The cube is scaled to x -0 … 4, turned so that x is up, and moved.
        boxes = {s["name"]: s["bounds_m"] for s in self.info()["shape_list"] if s["kind"] == "shape"}
        np.testing.assert_allclose(boxes["World/a/c"]["lower"], [0, 2, 2], atol=1e-4)
        np.testing.assert_allclose(boxes["World/a/c"]["upper"], [2, 6, 4], atol=1e-4)
        np.testing.assert_allclose(boxes["World/a/reset"]["lower"], [-5.5, -0.5, -0.5], atol=1e-4)
        self.assertEqual(scene.report.remarks, [])

    def test_purpose_and_visibility(self) -> None:
        body = """
            def Sphere "a" { }
            def Sphere "b" { uniform token purpose = "proxy"
            }
            def Xform "guides" { uniform token purpose = "guide"
                def Sphere "c" { }
            }
            def Xform "hidden" { token visibility = "invisible"
                def Sphere "d" { }
            }"""
        scene = self.convert(world(body))
        self.assertEqual(self.info()["shapes"], 1)
        self.assertEqual({f.value: n for f, n in scene.report.counts["Sphere"].items()}, {"carried over": 1, "not shown": 3})
        self.convert(world(body), purposes=["default", "guide", "proxy"])
        self.assertEqual(self.info()["shapes"], 3)

    def test_sizes_that_make_no_sense(self) -> None:
        errors = self.errors(world('def Sphere "s" { double radius = -1\n }'))
        self.assertEqual((errors[0].code, errors[0].path, errors[0].layer), ("E0802", "/World/s", "stage.usda"))
        self.errors(world('def Sphere "s" { double radius = nan\n }'))
        scene = self.convert(world('def Sphere "s" { double radius = 0\n }'))
        self.remark(scene, "what has no extent")


class Meshes(StageTest):
    def test_polygons(self) -> None:
        self.convert(polygons())
        info = self.info()
        self.assertEqual((info["quads"], info["triangles"]), (2, 0))
        self.assert_bounds([0, 0, 0], [2, 1, 0])

    def test_seams_split_points_and_nothing_else(self) -> None:
        st = 'texCoord2f[] primvars:st = [(0, 0), (0.5, 0), (0.5, 1), (0, 1), {}, (1, 0), (1, 1), {}] (interpolation = "faceVarying")'
        scene = self.convert(polygons(st.format("(0.5, 0)", "(0.5, 1)")))
        self.assertIn("faces { - 0 1 2 3; - 1 4 5 2 }", scene.scene_text)
        self.assertIn("uvs { - 0 0; - 0.5 0; - 0.5 1; - 0 1; - 1 0; - 1 1 }", scene.scene_text)
        scene = self.convert(polygons(st.format("(0.6, 0)", "(0.6, 1)")))
        line = next(x for x in scene.scene_text.splitlines() if "uvs" in x)
        self.assertEqual(line.count("-"), 8)
        self.assertIn("faces { - 0 6 7 3; - 1 4 5 2 }", scene.scene_text)

    def test_indexed_primvars(self) -> None:
        st = 'texCoord2f[] primvars:st = [(0.25, 0.75), (0.5, 0.5)] (interpolation = "vertex")\n int[] primvars:st:indices = [0, 1, 0, 1, 0, 1]'
        self.assertIn("uvs { - 0.25 0.75; - 0.5 0.5; - 0.25 0.75;", self.convert(polygons(st)).scene_text)

    def test_left_handed_faces_are_turned(self) -> None:
        scene = self.convert(polygons('uniform token orientation = "leftHanded"'))
        self.assertIn("faces { - 3 2 1 0; - 2 5 4 1 }", scene.scene_text)

    def test_holes_of_polygons_are_left_out(self) -> None:
        self.convert(polygons("int[] holeIndices = [1]"))
        self.assertEqual(self.info()["quads"], 1)

    def test_normals(self) -> None:
        scene = self.convert(
            polygons('normal3f[] normals = [(0, 0, 1), (0, 1, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)] (interpolation = "vertex")')
        )
        (content,) = scene.files.values()
        rows = np.frombuffer(content.split(b"end_header\n")[1][: 6 * 24], "<f4").reshape(6, 6)
        np.testing.assert_array_equal(rows[1], [1, 0, 0, 0, 1, 1])

    def test_display_colour_of_all_interpolations(self) -> None:
        red, blue = "(1, 0, 0)", "(0, 0, 1)"
        cases = {
            "constant": [red],
            "uniform": [red, blue],
            "vertex": [red, red, blue, blue, red, blue],
            "varying": [red] * 5 + [blue],
            "faceVarying": [red] * 4 + [blue] * 4,
        }
        for interpolation, values in cases.items():
            scene = self.convert(polygons(f'color3f[] primvars:displayColor = [{", ".join(values)}] (interpolation = "{interpolation}")'))
            if interpolation == "constant":
                self.assertIn("reflectance rgb 1 0 0", scene.scene_text)
                continue
            self.assertIn('reflectance attribute "color"', scene.scene_text)
            points = 8 if interpolation in ("uniform", "faceVarying") else 6
            block = scene.scene_text.split('attribute "color" {')[1].split("}")[0]
            self.assertEqual(block.count("-"), points, block)

    def test_subsets(self) -> None:
        material = 'def Material "{0}" {{\n token outputs:surface.connect = </World/{0}/s.outputs:surface>\n def Shader "s" {{\n uniform token info:id = "UsdPreviewSurface"\n token outputs:surface\n }}\n }}\n'
        subset = 'def GeomSubset "half" (prepend apiSchemas = ["MaterialBindingAPI"]) {\n uniform token elementType = "face"\n uniform token familyName = "materialBind"\n int[] indices = [1]\n rel material:binding = </World/B>\n }'
        both = material.format("A") + material.format("B")
        mesh = 'def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {{\n{}\n uniform token subdivisionScheme = "{}"\n rel material:binding = </World/A>\n{}\n }}'
        scene = self.convert(world(both + mesh.format(GRID, "none", subset)))
        self.assertIn('shape "World/m/half" mesh', scene.scene_text)
        self.assertEqual(self.info()["shapes"], 2)
        scene = self.convert(world(both + mesh.format(GRID, "catmullClark", subset)))
        self.assertIn('material "World/B" group=subset-0-half', scene.scene_text)
        (content,) = scene.files.values()
        self.assertIn(b"g subset-0-half\nf 2 5 6 3\n", content)
        self.assertEqual(self.info()["shapes"], 1)

    def test_subdivision_schemes_and_rules(self) -> None:
        extra = """
            uniform token subdivisionScheme = "{}"
            int[] creaseIndices = [0, 1, 4, 1, 2]
            int[] creaseLengths = [3, 2]
            float[] creaseSharpnesses = [2.5, 10]
            int[] cornerIndices = [3]
            float[] cornerSharpnesses = [4]
            int[] holeIndices = [1]
            uniform token interpolateBoundary = "edgeOnly"
            uniform token faceVaryingLinearInterpolation = "boundaries"
        """
        scene = self.convert(cage(extra.format("catmullClark")))
        for part in (
            "crease 0 1 4 sharpness=2.5",
            "crease 1 2\n",
            "corner 3 sharpness=4",
            "holes 1",
            "boundary edge-only",
            "texture-boundary boundaries",
        ):
            self.assertIn(part, scene.scene_text)
        self.assertIn("scheme bilinear", self.convert(cage(extra.format("bilinear"))).scene_text)
        self.remark(self.convert(cage(extra.format("loop"))), "the scheme loop")

    def test_sharpness_of_each_edge(self) -> None:
        scene = self.convert(cage("int[] creaseIndices = [0, 1, 4]\n int[] creaseLengths = [3]\n float[] creaseSharpnesses = [1, 2]"))
        self.assertIn("crease 0 1 sharpness=1", scene.scene_text)
        self.assertIn("crease 1 4 sharpness=2", scene.scene_text)

    def test_the_limit_of_a_cube(self) -> None:
        # The limit of a corner of a cube by Catmull and Clark is at (n V + 4 Σ E … ) = 5/9 of it; with a corner it stays.
        cube = """def Mesh "m" {
            int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
            int[] faceVertexIndices = [0,1,3,2, 4,6,7,5, 0,4,5,1, 2,3,7,6, 0,2,6,4, 1,5,7,3]
            point3f[] points = [(-1,-1,-1), (-1,-1,1), (-1,1,-1), (-1,1,1), (1,-1,-1), (1,-1,1), (1,1,-1), (1,1,1)]
            %s
        }"""
        self.convert(world(cube % ""))
        upper = np.array(self.info()["bounds_m"]["upper"])
        self.assertTrue((upper < 0.95).all() and (upper > 0.5).all(), upper)
        self.convert(world(cube % "int[] cornerIndices = [7]\n float[] cornerSharpnesses = [10]"))
        np.testing.assert_allclose(self.info()["bounds_m"]["upper"], [1, 1, 1], atol=1e-3)

    def test_seams_of_cages_stay_seams(self) -> None:
        st = 'texCoord2f[] primvars:st = [(0, 0), (0.5, 0), (0.5, 1), (0, 1), (0.6, 0), (1, 0), (1, 1), (0.6, 1)] (interpolation = "faceVarying")'
        (content,) = self.convert(cage(st)).files.values()
        self.assertIn(b"f 2/5 5/6 6/7 3/8\n", content)
        joined = st.replace("(0.6, 0)", "(0.5, 0)").replace("(0.6, 1)", "(0.5, 1)")
        self.assertEqual(self.convert(cage(joined)).files, {})

    def test_deformation_and_velocities(self) -> None:
        camera = 'def Camera "c" { double shutter:open = -0.25\n double shutter:close = 0.25\n double3 xformOp:translate = (0, 0, 9)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n }'
        moved = GRID.replace("point3f[] points = [", "point3f[] points.timeSamples = { 0: [").replace(
            "(2, 1, 0)]", "(2, 1, 0)], 2: [(0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2), (2, 0, 2), (2, 1, 2)] }"
        )
        header = HEADER.replace("metersPerUnit", "timeCodesPerSecond = 10\n    metersPerUnit")
        scene = self.convert(world(f'{camera}\n def Mesh "m" {{\n{moved}\n uniform token subdivisionScheme = "none"\n }}'), header, frame=1)
        self.assertIn("at 0.075 s { points { - 0 0 0.75;", scene.scene_text)
        self.assertIn("at 0.125 s { points { - 0 0 1.25;", scene.scene_text)
        self.assertIn("time 0.075 s", scene.scene_text)
        self.assertIn("shutter 0.05 s", scene.scene_text)
        sampled = GRID.replace("points = [", "points.timeSamples = { 1: [").replace("(2, 1, 0)]", "(2, 1, 0)] }")
        values = ", ".join(["(0, 0, 8)"] * 6)
        velocities = f'{camera}\n def Mesh "m" {{\n{sampled}\n uniform token subdivisionScheme = "none"\n vector3f[] velocities.timeSamples = {{ 1: [{values}] }}\n }}'
        # 8 units a second, a quarter of a frame of a tenth of a second on either side.
        scene = self.convert(world(velocities), header, frame=1)
        self.assertIn("at 0.075 s { points { - 0 0 -0.2;", scene.scene_text)
        self.assertIn("at 0.125 s { points { - 0 0 0.2;", scene.scene_text)

    def test_damage_is_located(self) -> None:
        cases = {
            "a face has point 9": GRID.replace("5, 2]", "9, 2]"),
            "a face has point -1": GRID.replace("5, 2]", "-1, 2]"),
            "asks for 9 corners": GRID.replace("[4, 4]", "[4, 5]"),
            "-4 corners": GRID.replace("[4, 4]", "[4, -4]"),
            "point 5 is not finite": GRID.replace("(2, 1, 0)", "(2, nan, 0)"),
            "primvar st (vertex) has 1 values for 6": GRID + 'texCoord2f[] primvars:st = [(0, 0)] (interpolation = "vertex")',
            "leave its 1 values": GRID
            + 'texCoord2f[] primvars:st = [(0, 0)] (interpolation = "vertex")\n int[] primvars:st:indices = [0, 0, 0, 0, 0, 7]',
            "holeIndices names face 7": GRID + "int[] holeIndices = [7]",
            "creaseIndices names point 70": GRID + "int[] creaseIndices = [0, 70]\n int[] creaseLengths = [2]\n float[] creaseSharpnesses = [1]",
            "creaseSharpnesses has 3": GRID + "int[] creaseIndices = [0, 1]\n int[] creaseLengths = [2]\n float[] creaseSharpnesses = [1, 1, 1]",
        }
        for why, text in cases.items():
            scheme = "catmullClark" if "crease" in why else "none"
            errors = self.errors(world(f'def Mesh "m" {{\n{text}\n uniform token subdivisionScheme = "{scheme}"\n }}'))
            self.assertEqual((errors[0].code, errors[0].path, errors[0].layer), ("E0802", "/World/m", "stage.usda"))
            self.assertIn(why, errors[0].why)
        self.remark(self.convert(world('def Mesh "m" { }')), "without faces")


class CurvesAndPoints(StageTest):
    POINTS = "point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]\n int[] curveVertexCounts = [4]\n"

    def curves(self, extra: str) -> str:
        return world(f'def BasisCurves "c" {{\n{self.POINTS}{extra}\n }}')

    def strand_points(self, scene: object) -> np.ndarray:
        (content,) = scene.files.values()  # type: ignore[attr-defined]
        head, rest = content.split(b"end_header\n", 1)
        count = int(head.split(b"element vertex ")[1].split()[0])
        return np.frombuffer(rest[: 16 * count], "<f4").reshape(count, 4)

    def test_bases(self) -> None:
        width = 'float[] widths = [0.2] (interpolation = "constant")'
        for basis, ends in (("bezier", (0, 3)), ("bspline", (1, 2)), ("catmullRom", (1, 2))):
            scene = self.convert(self.curves(f'uniform token basis = "{basis}"\n{width}'))
            self.assertIn(f"basis {basis.replace('catmullRom', 'catmull-rom')}", scene.scene_text)
            bounds = self.info()["bounds_m"]
            self.assertAlmostEqual(bounds["lower"][0], ends[0], delta=0.11)
            self.assertAlmostEqual(bounds["upper"][0], ends[1], delta=0.11)
            self.assertAlmostEqual(bounds["upper"][1], 0.1, delta=0.01)
        self.convert(self.curves(f'uniform token type = "linear"\n{width}'))
        self.assert_bounds([-0.1, -0.1, -0.1], [3.1, 0.1, 0.1], 2)

    def test_wraps(self) -> None:
        width = 'float[] widths = [0.2] (interpolation = "constant")'
        scene = self.convert(self.curves(f'uniform token basis = "catmullRom"\n uniform token wrap = "pinned"\n{width}'))
        np.testing.assert_allclose(self.strand_points(scene)[:, 0], [-1, 0, 1, 2, 3, 4])
        scene = self.convert(self.curves(f'uniform token basis = "bspline"\n uniform token wrap = "periodic"\n{width}'))
        np.testing.assert_allclose(self.strand_points(scene)[:, 0], [0, 1, 2, 3, 0, 1, 2])

    def test_varying_widths_of_a_bezier_curve(self) -> None:
        scene = self.convert(self.curves('float[] widths = [0.2, 0.8] (interpolation = "varying")'))
        np.testing.assert_allclose(self.strand_points(scene)[:, 3], [0.1, 0.2, 0.3, 0.4], rtol=1e-6)

    def test_stretched_curves_are_instances(self) -> None:
        scene = self.convert(
            self.curves(
                'float[] widths = [0.2] (interpolation = "constant")\n float3 xformOp:scale = (1, 3, 1)\n uniform token[] xformOpOrder = ["xformOp:scale"]'
            )
        )
        self.assertIn("instance", scene.scene_text)
        self.assertAlmostEqual(self.info()["bounds_m"]["upper"][1], 0.3, delta=0.03)

    def test_nurbs_and_hermite(self) -> None:
        # A quarter of a circle as a rational curve of order 3.
        w = math.sqrt(0.5)
        text = f"""def NurbsCurves "n" {{
            point3f[] points = [(1, 0, 0), (1, 1, 0), (0, 1, 0)]
            int[] curveVertexCounts = [3]
            int[] order = [3]
            double[] knots = [0, 0, 0, 1, 1, 1]
            double[] pointWeights = [1, {w}, 1]
            float[] widths = [0.1] (interpolation = "constant")
        }}"""
        points = self.strand_points(self.convert(world(text)))
        np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 1, atol=1e-6)
        text = """def HermiteCurves "h" {
            point3f[] points = [(0, 0, 0), (3, 0, 0)]
            vector3f[] tangents = [(3, 3, 0), (3, 0, 0)]
            int[] curveVertexCounts = [2]
            float[] widths = [0.1] (interpolation = "constant")
        }"""
        points = self.strand_points(self.convert(world(text)))
        np.testing.assert_allclose(points[:, :3], [[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, 0, 0]])

    def test_points(self) -> None:
        self.convert(world('def Points "p" { point3f[] points = [(0, 0, 0), (4, 0, 0)]\n float[] widths = [1, 2]\n }'))
        self.assertEqual(self.info()["points"], 2)
        self.assert_bounds([-0.5, -1, -1], [5, 1, 1], 3)

    def test_damage(self) -> None:
        self.assertIn("asks for 9", self.errors(self.curves("").replace("[4]", "[9]"))[0].why)
        self.assertIn("not finite", self.errors(world('def Points "p" { point3f[] points = [(nan, 0, 0)]\n }'))[0].why)
        self.remark(self.convert(self.curves('uniform token basis = "bezier"\n').replace("[4]", "[2, 2]")), "too few points")
