"""Images: planes, colours, spectra, files, and the functions that are commands."""

from __future__ import annotations

import re
import struct
import subprocess
import sys
import unittest

import numpy as np
from small import InFolder, ball, command

import abbe

XYZ_OF_AP0 = np.array([[0.9525523959, 0.0, 0.0000936786], [0.3439664498, 0.7281660966, -0.0721325464], [0.0, 0.0, 1.0088251844]])


class Planes(InFolder):
    @classmethod
    def setUpClass(cls) -> None:
        cls.image = ball(layers={"albedo": True, "normal": True, "depth": True, "spectral": (380, 780, 20)}).render(samples=8)

    def test_colours(self) -> None:
        rgb = self.image.rgb()
        self.assertEqual((rgb.shape, rgb.dtype), ((24, 32, 3), np.float32))
        np.testing.assert_allclose(self.image.xyz, rgb @ XYZ_OF_AP0.T, rtol=2e-5, atol=1e-7)
        for space in ("acescg", "lin_rec709_scene", "lin_rec2020_scene"):
            self.assertFalse(np.allclose(self.image.rgb(space), rgb))
        with self.assertRaisesRegex(ValueError, "acescg"):
            self.image.rgb("rec.nothing")

    def test_no_copy_and_no_writing(self) -> None:
        plane = self.image.channel("G")
        self.assertEqual(plane.__array_interface__["data"][0], self.image.channel("G").__array_interface__["data"][0])
        self.assertFalse(plane.flags.writeable)
        image = ball().render(samples=1)
        red, expected = image.channel("R"), image.channel("R").copy()
        del image
        self.assertTrue((red == expected).all())

    def test_layers_by_name(self) -> None:
        self.assertEqual(self.image["albedo"].shape, (24, 32, 3))
        np.testing.assert_allclose(np.linalg.norm(self.image["normal"][20:], axis=-1).max(), 1, atol=1e-3)
        with self.assertRaisesRegex(KeyError, "albedo"):
            self.image["albeda"]
        self.assertRaises(KeyError, self.image.channel, "Q")

    def test_spectra(self) -> None:
        wavelengths, values = self.image.spectrum()
        np.testing.assert_allclose(wavelengths, np.arange(390, 780, 20))
        coarse, means = self.image.spectrum(5)
        np.testing.assert_allclose(coarse, [420, 500, 580, 660, 740])
        np.testing.assert_allclose(means[..., 0], values[..., :4].mean(axis=-1), rtol=1e-6)
        self.assertRaises(ValueError, self.image.spectrum, 7)
        self.assertRaises(KeyError, ball().render(samples=1).spectrum)

    def test_error_and_what_is_known(self) -> None:
        error = self.image.error
        self.assertTrue(0 < error.low <= error.value <= error.high < 1)
        self.assertEqual((self.image.samples, self.image.partial), (8, False))
        self.assertEqual(self.image.header["abbe.samples"], 8)
        self.assertIn("--samples 8", self.image.header["abbe.command"])

    def test_crops(self) -> None:
        image = ball().render(samples=8, crop=(4, 5, 20, 17))
        self.assertEqual((image.width, image.height, image.window, image.display_size), (16, 12, (4, 5, 20, 17), (32, 24)))
        whole = ball().render(samples=8)
        self.assertTrue((image.rgb() == whole.rgb()[5:17, 4:20]).all())

    def test_files(self) -> None:
        self.image.save(self.folder / "a.exr")
        again = abbe.read_image(self.folder / "a.exr")
        for name in self.image.channels:
            self.assertEqual(again.channel(name).shape, (24, 32))
        again.save(self.folder / "b.exr")
        self.assertTrue((abbe.read_image(self.folder / "b.exr").rgb() == again.rgb()).all())
        png = self.image._repr_png_()
        self.assertEqual((png[:8], struct.unpack(">II", png[16:24])), (b"\x89PNG\r\n\x1a\n", (32, 24)))
        self.image.save(self.folder / "a.png", exposure=1, bits=16)
        command("convert", str(self.folder / "a.exr"), str(self.folder / "c.png"))
        self.image.save(self.folder / "d.png")
        self.assertEqual(png, (self.folder / "d.png").read_bytes())
        self.assertRaises(OSError, self.image.save, self.folder / "a.jpg")
        self.assertRaises(OSError, self.image.save, self.folder / "no" / "a.exr")
        self.assertRaises(OSError, abbe.read_image, self.folder / "nothing.exr")
        self.assertRaises(OSError, abbe.read_image, __file__)


class Tools(InFolder):
    def test_compare(self) -> None:
        one, other = ball().render(samples=4), ball().render(samples=4, seed=2)
        figures = abbe.compare(one, other, threshold={"relmse": 0})
        self.assertFalse(figures["within"])
        self.assertTrue(abbe.compare(one, one, threshold={"relmse": 0})["within"])
        self.assertTrue(abbe.compare(one, other, ball().render(samples=4, seed=3)))
        self.assertRaises(TypeError, abbe.compare, one)
        with self.assertRaisesRegex(RuntimeError, "nothing.exr"):
            abbe.compare(one, self.folder / "nothing.exr")

    def test_verify(self) -> None:
        result = abbe.verify(ball(), samples=32, size=(16, 12))
        self.assertTrue(result["agree"])

    def test_study(self) -> None:
        result = abbe.study(ball(), samples=8, seeds=2, size=(16, 12), variants="none")
        self.assertTrue(result)


class Package(unittest.TestCase):
    def test_the_program_is_there(self) -> None:
        run = [sys.executable, "-m", "abbe"]
        self.assertIn(abbe.__version__, subprocess.run([*run, "--version"], capture_output=True, text=True, check=True).stdout)
        farm = subprocess.run([*run, "farm", "status", "x"], capture_output=True, text=True, check=False)
        self.assertEqual((farm.returncode, farm.stdout), (2, ""))
        self.assertIn("CMake", farm.stderr)

    def test_nothing_of_the_system_is_needed(self) -> None:
        """Libraries that are loaded come from the wheel, but for those that Python itself needs."""
        if sys.platform != "linux" or "site-packages" not in abbe.__file__:
            self.skipTest("not installed")
        from small import wheel_is_whole

        if not wheel_is_whole():
            self.skipTest("a wheel for this machine alone")
        ball().render(samples=1)
        with open("/proc/self/maps", encoding="ascii") as file:
            loaded = {line.split()[-1] for line in file if ".so" in line}
        # extensions of Python's own, such as _ctypes, bring theirs
        base = re.compile(
            r"/(ld-linux.*|lib(c|m|dl|rt|pthread|util|resolv|stdc\+\+|gcc_s|z|expat|bz2|lzma|ffi|crypto|ssl|sqlite3|uuid|mpdec|readline|tinfo|ncursesw|python3.*))\.so[0-9.]*$"
        )
        foreign = {path for path in loaded if not base.search(path) and "site-packages" not in path and "lib-dynload" not in path}
        foreign = {path for path in foreign if not re.search(r"/lib(z|bz2|c|m|stdc\+\+|gcc_s|expat|lzma|ffi|python3\.[0-9]+)[.-]", path)}
        self.assertEqual(foreign, set())


if __name__ == "__main__":
    unittest.main()
