"""Damaged and hostile stages: a diagnostic, or a scene that can be read, and never anything else."""

from __future__ import annotations

import os
import random
import re
import resource
import subprocess
import sys
import time
import unittest

from support import HEADER, StageTest

from abbe import usd

# Something of everything, each on a line of its own.
EVERYTHING = """
def Xform "World" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 10: (1, 2, 3) }
    float3 xformOp:rotateXYZ = (10, 20, 30)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    rel material:binding = </World/M>
    def Camera "cam" {
        float focalLength = 50
        float horizontalAperture = 20
        float fStop = 2
        float focusDistance = 4
        double shutter:open = 0
        double shutter:close = 0.5
        float exposure = 1
    }
    def RenderSettings "settings" {
        int2 resolution = (16, 16)
        float4 dataWindowNDC = (0, 0, 1, 1)
        float pixelAspectRatio = 1
        rel camera = </World/cam>
    }
    def Mesh "polygons" {
        int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 2, 3, 0, 1, 2]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        vector3f[] velocities = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)]
        normal3f[] normals = [(0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1)] (interpolation = "faceVarying")
        int[] primvars:st:indices = [0, 1, 2, 0, 1, 2, 0]
        color3f[] primvars:displayColor = [(1, 1, 1), (0, 0, 0)] (interpolation = "uniform")
        int[] holeIndices = [1]
        uniform token subdivisionScheme = "none"
    }
    def Mesh "cage" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        int[] creaseIndices = [0, 1, 2]
        int[] creaseLengths = [3]
        float[] creaseSharpnesses = [2.5]
        int[] cornerIndices = [3]
        float[] cornerSharpnesses = [5]
        def GeomSubset "part" (prepend apiSchemas = ["MaterialBindingAPI"]) {
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices = [0]
            rel material:binding = </World/M>
        }
    }
    def BasisCurves "hair" {
        uniform token type = "cubic"
        uniform token basis = "bezier"
        int[] curveVertexCounts = [4]
        point3f[] points = [(0, 0, 0), (0, 1, 0), (0, 2, 1), (0, 3, 1)]
        float[] widths = [0.1, 0.05] (interpolation = "varying")
    }
    def Points "spray" {
        point3f[] points = [(0, 0, 0), (1, 1, 1)]
        float[] widths = [0.1, 0.2]
    }
    def Sphere "ball" {
        double radius = 2
    }
    def Cone "cone" {
        double radius = 1
        double height = 2
    }
    def Capsule "pill" {
        double radius = 1
        double height = 2
    }
    def PointInstancer "many" {
        rel prototypes = [</World/ball>, </World/cone>]
        int[] protoIndices = [0, 1, 0]
        point3f[] positions = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
        quath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]
        float3[] scales = [(1, 1, 1), (2, 2, 2), (1, 1, 1)]
        int64[] invisibleIds = [1]
    }
    def "copy" (instanceable = true
        references = </World/polygons>) {
    }
    def RectLight "rect" (prepend apiSchemas = ["ShapingAPI"]) {
        float inputs:intensity = 100
        float inputs:exposure = 2
        color3f inputs:color = (1, 0.5, 0.2)
        float inputs:width = 2
        float inputs:height = 3
        float inputs:shaping:cone:angle = 40
        bool inputs:normalize = true
        rel light:filters = </World/M>
    }
    def DomeLight "dome" {
        float inputs:intensity = 1
        float inputs:colorTemperature = 5000
        bool inputs:enableColorTemperature = true
    }
    def Material "M" {
        token outputs:surface.connect = </World/M/s.outputs:surface>
        def Shader "s" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </World/M/mix.outputs:out>
            float inputs:roughness = 0.4
            float inputs:opacity = 0.5
            token outputs:surface
        }
        def Shader "mix" {
            uniform token info:id = "ND_mix_color3"
            color3f inputs:bg.connect = </World/M/noise.outputs:out>
            color3f inputs:fg = (1, 0, 0)
            float inputs:mix = 0.5
            color3f outputs:out
        }
        def Shader "noise" {
            uniform token info:id = "ND_fractal3d_color3"
            float inputs:lacunarity = 2
            int inputs:octaves = 3
            color3f outputs:out
        }
    }
}
"""
NUMBER = re.compile(r"(?<![\w.:])-?\d+(?:\.\d+)?(?![\w.:])")
ODD = ["nan", "inf", "-inf", "-1", "0", "1e30", "1e-30", "2147483647", "-2147483648", "65536"]
PATHS = ["</World>", "</World/M>", "</Gone>", "</World/M/s.outputs:surface>", "</World/M/mix.outputs:out>", "</World/many>", "</World/polygons>"]
ROUNDS = int(os.environ.get("ABBE_USD_DAMAGE", "250"))


def damaged(text: str, chance: random.Random) -> str:
    """One or two faults: a number, a path, a lost value, a lost line, a doubled one."""
    for _ in range(chance.randint(1, 2)):
        kind = chance.randrange(5)
        if kind == 0:
            found = list(NUMBER.finditer(text))
            at = chance.choice(found)
            text = text[: at.start()] + chance.choice(ODD) + text[at.end() :]
        elif kind == 1:
            found = list(re.finditer(r"</[^>]*>", text))
            at = chance.choice(found)
            text = text[: at.start()] + chance.choice(PATHS) + text[at.end() :]
        elif kind == 2:
            found = list(re.finditer(r", (?:\([^()]*\)|-?[\d.]+)(?=[\],])", text))
            at = chance.choice(found)
            text = text[: at.start()] + text[at.end() :]
        else:
            lines = text.split("\n")
            i = chance.choice(
                [i for i, line in enumerate(lines) if " = " in line and "(" not in line.split(" = ")[0] and not line.rstrip().endswith("{")]
            )
            lines[i : i + 1] = [] if kind == 3 else [lines[i].replace("= [", "= [][").split("][")[0] + "]" if "= [" in lines[i] else lines[i]]
            text = "\n".join(lines)
    return text


class Damage(StageTest):
    def test_everything_is_read_whole(self) -> None:
        scene = self.convert(EVERYTHING, strict=False)
        self.assertIn("many", scene.scene_text)

    def test_faults_by_chance_are_told_or_read(self) -> None:
        """Whatever is wrong: errors of the report, or a scene whose every number is finite."""
        refused = 0
        for seed in range(ROUNDS):
            text = damaged(EVERYTHING, random.Random(seed))
            path = self.stage(text)
            with self.subTest(seed=seed):
                try:
                    scene = usd.load(path, frames=(0, 10) if seed % 2 else None)
                    self.assertNotRegex(scene.scene_text, r"(?<![\w\"/.-])(nan|inf)(?![\w\"/.-])")
                    self.assertTrue(all(scene.files.values()))
                except usd.StageError as fault:
                    refused += 1
                    self.assertTrue(fault.report.errors)
        self.assertGreater(refused, ROUNDS // 20)
        self.assertLess(refused, ROUNDS)

    def test_cycles(self) -> None:
        cases = {
            "of inheritance": ('class "A" (inherits = </B>) { }\nclass "B" (inherits = </A>) { }\ndef "World" (inherits = </A>) { }', "E0802"),
            "of payloads": ('def "World" (payload = </World>) { }', "E0802"),
            "of a reference to what holds it": ('def Xform "World" { def "a" (references = </World>) { }\n }', "E0802"),
        }
        for name, (text, code) in cases.items():
            with self.subTest(name):
                self.assertIn(code, [e.code for e in self.errors(text)])
        (self.folder / "below.usda").write_text("#usda 1.0\n( subLayers = [@stage.usda@] )\n")
        errors = self.errors('def "World" { }', HEADER.replace("metersPerUnit = 1", "metersPerUnit = 1\n    subLayers = [@below.usda@]"))
        self.assertIn("cycle", errors[0].what)

    def test_nodes_that_feed_themselves(self) -> None:
        text = EVERYTHING.replace("</World/M/noise.outputs:out>", "</World/M/mix.outputs:out>")
        try:
            usd.load(self.stage(text))
        except usd.StageError as fault:
            self.assertIn("/World/M", fault.report.errors[0].path)

    def test_what_is_missing_is_named_with_its_place(self) -> None:
        for arc, code in (("references", "E0401"), ("payload", "E0401")):
            errors = self.errors(f'def "World" {{ def "a" ({arc} = @no/such/layer.usdc@) {{ }}\n }}')
            self.assertEqual((errors[0].code, errors[0].path, errors[0].layer), (code, "/World/a", "stage.usda"))
            self.assertIn("no/such/layer.usdc", str(errors[0]))
        errors = self.errors("", HEADER.replace("metersPerUnit = 1", "metersPerUnit = 1\n    subLayers = [@no/such/layer.usdc@]"))
        self.assertEqual(errors[0].code, "E0401")

    def test_a_billion_instances(self) -> None:
        """A thousand of a thousand of a thousand: levels stay levels, in a second and without memory for them."""
        places = ", ".join(f"({i}, 0, 0)" for i in range(1000))
        text, inner = "", "</World/ball>"
        for level in ("a", "b", "c"):
            text += f'def PointInstancer "{level}" {{ rel prototypes = [{inner}]\n int[] protoIndices = [{", ".join(["0"] * 1000)}]\n point3f[] positions = [{places}]\n }}\n'
            inner = f"</World/{level}>"
        start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        scene = usd.load(self.stage(f'def Xform "World" {{ def Sphere "ball" {{ double radius = 0.1\n }}\n{text} }}'))
        self.assertLess(time.monotonic() - start, 10)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 200_000)  # KiB
        self.assertLess(sum(map(len, scene.files.values())), 1_000_000)
        self.assertEqual(scene.scene_text.count("object "), 3)

    def test_cut_and_flipped_bytes(self) -> None:
        """Crates with faults: USD may end by a signal there, so each is read by a process of its own, which has to end by itself."""
        from pxr import Usd

        whole = self.folder / "whole.usdc"
        Usd.Stage.Open(str(self.stage(EVERYTHING))).Export(str(whole))
        content = whole.read_bytes()
        chance = random.Random(1)
        for i in range(4):
            broken = bytearray(content[: len(content) * (i + 1) // 5] if i < 2 else content)
            for _ in range(8 if i >= 2 else 0):
                broken[chance.randrange(88, len(broken))] ^= 1 << chance.randrange(8)
            path = self.folder / f"broken{i}.usdc"
            path.write_bytes(bytes(broken))
            command = [sys.executable, "-m", "abbe.usd.command", str(path), "-o", str(self.folder / f"o{i}.scene")]
            done = subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
            self.assertNotEqual(done.returncode, 70, done.stderr)  # no fault of ours
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
