"""Small scenes for the tests of `import abbe`, which run against the package as it is installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import abbe


class InFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="abbe-api-"))
        self.addCleanup(shutil.rmtree, self.folder)


def ball(width: int = 32, height: int = 24, **film: object) -> abbe.Scene:
    """A ball of glass on a floor, in daylight."""
    scene = abbe.Scene()
    scene.film(size=(width, height), **film)
    scene.camera(from_=(0, 1, 4), look_at=(0, 0.5, 0))
    scene.light("daylight", elevation="30 deg")
    scene.material("glass", "dielectric", ior="glass BK7")
    scene.shape("ball", "sphere", center=(0, 0.5, 0), radius=0.5, material="glass")
    scene.shape("plane", material=abbe.node("diffuse", reflectance="rgb 0.6 0.5 0.4"))
    return scene


def command(*words: str, **options: object) -> subprocess.CompletedProcess[str]:
    """The program: $ABBE, else that of the package."""
    program = [os.environ["ABBE"]] if "ABBE" in os.environ else [sys.executable, "-m", "abbe"]
    return subprocess.run([*program, *words], capture_output=True, text=True, check=True, **options)  # type: ignore[call-overload,no-any-return]


def wheel_is_whole() -> bool:
    """Whether the package that is tested has its shared libraries inside (tests/python_package.sh)."""
    return os.environ.get("ABBE_WHEEL") == "whole"
