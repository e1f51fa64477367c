"""What a scene of a stage may read: `abbe-usd` names the folders that its user has to state, and no others."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import subprocess
from pathlib import Path
from unittest import mock

import numpy as np
from support import HEADER, LOOKING_DOWN, StageTest, program
from test_materials import write_png

from abbe import usd
from abbe.usd import command


def textured(picture: str) -> str:
    """A square with a picture."""
    return (
        'def Xform "World" {\n    def DomeLight "sky" { }\n'
        + LOOKING_DOWN
        + f"""
    def Mesh "floor" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        uniform token subdivisionScheme = "none"
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
        rel material:binding = </World/paint>
    }}
    def Material "paint" {{
        token outputs:surface.connect = </World/paint/shader.outputs:surface>
        def Shader "shader" {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </World/paint/picture.outputs:rgb>
            token outputs:surface
        }}
        def Shader "picture" {{
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @{picture}@
            float3 outputs:rgb
        }}
    }}
}}
"""
    )


class Reach(StageTest):
    def setUp(self) -> None:
        super().setUp()
        self.folder = self.folder.resolve()
        for name in ("shot", "library", "out"):
            (self.folder / name).mkdir()
        for name in ("shot", "library"):
            write_png(self.folder / name / "bark.png", np.full((4, 4, 3), 128, np.uint8))

    def shot(self, picture: str) -> Path:
        path = self.folder / "shot" / "stage.usda"
        path.write_text(HEADER + textured(picture), encoding="utf-8")
        return path

    def converted(self, picture: str, scene: Path) -> list[str]:
        """The words that the last line of `abbe-usd` hands to the next command."""
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            self.assertEqual(command.run([str(self.shot(picture)), "-o", str(scene), "--force"]), 0)
        words = shlex.split(re.sub(r".*; next: abbe render ", "", out.getvalue().splitlines()[-1]))
        self.assertEqual(words[0], str(scene))
        return words[1:]

    def check(self, scene: Path, *words: str) -> str:
        done = subprocess.run([program(), "check", str(scene), *words], capture_output=True, text=True)
        return "" if done.returncode == 0 else done.stdout + done.stderr

    def assert_told(self, picture: str, scene: Path, folder: Path) -> None:
        words = self.converted(picture, scene)
        self.assertEqual(words, ["--search", str(folder)])
        self.assertIn("E0417", self.check(scene))
        self.assertEqual(self.check(scene, *words), "")

    def test_beside_the_stage_nothing_is_stated(self) -> None:
        scene = self.folder / "shot" / "stage.scene"
        self.assertEqual(self.converted("bark.png", scene), [])
        self.assertEqual(self.check(scene), "")

    def test_a_scene_elsewhere_is_told_where_the_stage_is(self) -> None:
        self.assert_told("bark.png", self.folder / "out" / "it's.scene", self.folder / "shot")

    def test_a_picture_elsewhere(self) -> None:
        self.assert_told("../library/bark.png", self.folder / "shot" / "stage.scene", self.folder / "library")

    def test_a_link_counts_where_it_leads(self) -> None:
        (self.folder / "shot" / "linked.png").symlink_to(self.folder / "library" / "bark.png")
        self.assert_told("linked.png", self.folder / "shot" / "stage.scene", self.folder / "library")

    def test_one_project_holds_all(self) -> None:
        (self.folder / ".abbe-project").touch()
        scene = self.folder / "out" / "stage.scene"
        self.assertEqual(self.converted("../library/bark.png", scene), [])
        self.assertEqual(self.check(scene), "")

    def test_the_environment_is_heard(self) -> None:
        with mock.patch.dict(os.environ, {"ABBE_PATH": f"/nowhere:{self.folder / 'library'}"}):
            scene = self.folder / "shot" / "stage.scene"
            self.assertEqual(self.converted("../library/bark.png", scene), [])
            self.assertEqual(self.check(scene), "")

    def test_in_python_and_as_json(self) -> None:
        stage, scene = self.shot("../library/bark.png"), self.folder / "out" / "stage.scene"
        self.assertEqual(usd.load(stage).search(scene), [str(self.folder / "library")])
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            self.assertEqual(command.run([str(stage), "-o", str(scene), "--json"]), 0)
        self.assertEqual(json.loads(out.getvalue())["search"], [str(self.folder / "library")])
