"""What the tests of abbe.usd share: stages from text, the program `abbe`, and a reader of its pictures."""

from __future__ import annotations

import json
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from abbe import usd

NIT = 1 / 72983.0  # what a nit shows without an exposure
HEADER = '#usda 1.0\n(\n    upAxis = "Y"\n    metersPerUnit = 1\n    defaultPrim = "World"\n)\n'

# AP0, in which pictures are written, to XYZ and to linear Rec. 709, without adaptation of the white.
XYZ_OF_AP0 = np.array([[0.9525523959, 0.0, 0.0000936786], [0.3439664498, 0.7281660966, -0.0721325464], [0.0, 0.0, 1.0088251844]])
REC709_OF_XYZ = np.array(
    [[3.2409699419, -1.5373831776, -0.4986107603], [-0.9692436363, 1.8759675015, 0.0415550574], [0.0556300797, -0.2039769589, 1.0569715142]]
)


def program() -> str:
    """The program `abbe`: $ABBE, else the one of the build, else that of PATH."""
    here = Path(__file__).resolve().parents[2]
    candidates = [os.environ.get("ABBE", ""), str(here / "build/dev/abbe"), str(here / "build/release/abbe")]
    found = next((c for c in candidates if c and os.access(c, os.X_OK)), shutil.which("abbe"))
    if not found:
        raise unittest.SkipTest("there is no program abbe: $ABBE names it")
    return found


def read_exr(path: Path) -> npt.NDArray[np.float64]:
    """Rows × columns × (R G B) of a scan-line file of 32-bit floats, packed by zip."""
    data = path.read_bytes()
    assert struct.unpack_from("<I", data)[0] == 20000630, "no OpenEXR"
    at, header = 8, {}
    while data[at]:
        end = data.index(0, at)
        kind_end = data.index(0, end + 1)
        size = struct.unpack_from("<I", data, kind_end + 1)[0]
        header[data[at:end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        at = kind_end + 5 + size
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    names, channels, p = [], header["channels"], 0
    while channels[p]:
        end = channels.index(0, p)
        assert struct.unpack_from("<I", channels, end + 1)[0] == 2, "no 32-bit floats"
        names.append(channels[p:end].decode())
        p = end + 17
    assert header["compression"] == b"\x03", "not packed by zip"
    width, height = x1 - x0 + 1, y1 - y0 + 1
    out = np.zeros((height, len(names), width), np.float32)
    offsets = struct.unpack_from(f"<{(height + 15) // 16}Q", data, at + 1)
    for offset in offsets:
        y, size = struct.unpack_from("<iI", data, offset)
        rows = min(16, y1 - y + 1)
        packed, raw_size = data[offset + 8 : offset + 8 + size], rows * len(names) * width * 4
        if size < raw_size:
            raw = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
            raw[1:] -= 128
            raw = (np.cumsum(raw) % 256).astype(np.uint8)
            half = (len(raw) + 1) // 2
            joined = np.empty(len(raw), np.uint8)
            joined[0::2], joined[1::2] = raw[:half], raw[half:]
            packed = joined.tobytes()
        block = np.frombuffer(packed, "<f4").reshape(rows, len(names), width)
        out[y - y0 : y - y0 + rows] = block
    return np.stack([out[:, names.index(c), :] for c in "RGB"], axis=2).astype(np.float64)


# Of scenes as a whole: a stage with a ball around its camera, or a pane of glass, is odd and yet what a test is about.
OF_THE_WHOLE = {"W0605", "W0609", "W0613", "W0696"}


class StageTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="abbe-usd-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def stage(self, body: str, header: str = HEADER, name: str = "stage.usda") -> Path:
        path = self.folder / name
        path.write_text(header + body, encoding="utf-8")
        return path

    def convert(self, body: str | Path, header: str = HEADER, strict: bool = True, **options: Any) -> usd.Scene:
        """Loads a stage, writes its scene to `self.scene`, and lets the program check it, without warnings if `strict`."""
        path = body if isinstance(body, Path) else self.stage(body, header)
        scene = usd.load(path, **options)
        self.scene = self.folder / "stage.scene"
        scene.write(self.scene, force=True)
        done = subprocess.run([program(), "check", str(self.scene)], capture_output=True, text=True)
        said = done.stdout + done.stderr
        self.assertEqual(done.returncode, 0, said + scene.scene_text)
        warnings = set(re.findall(r"warning\[(W\d+)\]", said))
        self.assertFalse(strict and warnings - OF_THE_WHOLE, said + scene.scene_text)
        return scene

    def volume(self, kind: str, name: str, resolution: int) -> Path:
        """An OpenVDB file of a cloud or of smoke in the test's folder; skips the test where the program has no volumes."""
        path = self.folder / name
        made = subprocess.run([program(), "volume", "make", kind, str(path), "--resolution", str(resolution)], capture_output=True, text=True)
        if made.returncode != 0:
            self.skipTest(f"no volumes here: {made.stderr}")
        return path

    def errors(self, body: str | Path, header: str = HEADER, **options: Any) -> list[usd.Remark]:
        """The errors of a stage that cannot be read."""
        path = body if isinstance(body, Path) else self.stage(body, header)
        with self.assertRaises(usd.StageError) as caught:
            usd.load(path, **options)
        return caught.exception.report.errors

    def codes(self, scene: usd.Scene) -> list[str]:
        return [remark.code for remark in scene.report.remarks]

    def remark(self, scene: usd.Scene, part: str) -> usd.Remark:
        """The one remark whose words hold a text."""
        found = [r for r in scene.report.remarks if part in f"{r.what}: {r.why}"]
        self.assertEqual(len(found), 1, f"{part} in {[str(r) for r in scene.report.remarks]}")
        return found[0]

    def info(self) -> dict[str, Any]:
        done = subprocess.run([program(), "info", "--json", str(self.scene)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        result: dict[str, Any] = json.loads(done.stdout)
        return result

    def assert_bounds(self, lower: list[float], upper: list[float], places: int = 4) -> None:
        bounds = self.info()["bounds_m"]
        np.testing.assert_allclose(bounds["lower"], lower, atol=10**-places)
        np.testing.assert_allclose(bounds["upper"], upper, atol=10**-places)

    def render(self, samples: int = 64, *arguments: str) -> npt.NDArray[np.float64]:
        """The picture in linear Rec. 709."""
        out = self.folder / "picture.exr"
        command = [program(), "render", str(self.scene), "-o", str(out), "--samples", str(samples), *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return read_exr(out) @ (REC709_OF_XYZ @ XYZ_OF_AP0).T


# A camera 2 units up that looks straight down on 2 × 2 units, without perspective; 1 nit shows as 1.
LOOKING_DOWN = """
    def Camera "cam" {
        token projection = "orthographic"
        float horizontalAperture = 20
        float verticalAperture = 20
        double3 xformOp:translate = (0, 2, 0)
        double xformOp:rotateX = -90
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
    }
    def RenderSettings "settings" { int2 resolution = (16, 16)
    }
"""
# A white matte square, 2 × 2 units about the origin, that faces up.
WHITE_FLOOR = """
    def Mesh "floor" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        uniform token subdivisionScheme = "none"
        color3f[] primvars:displayColor = [(1, 1, 1)]
    }
"""
