"""Spectra and colours against what is known of them."""

from __future__ import annotations

import unittest

import numpy as np

import abbe


class Spectra(unittest.TestCase):
    def test_values_of_any_shape(self) -> None:
        flat = abbe.spectrum(0.18)
        np.testing.assert_allclose(flat(np.full((3, 4), 550.0)), np.full((3, 4), 0.18), rtol=1e-7)
        self.assertEqual(flat(550).shape, ())
        table = abbe.spectrum({400: 0.1, 500: 0.3, 700: 0.9})
        np.testing.assert_allclose(table([400, 450, 600, 800]), [0.1, 0.2, 0.6, 0.9], rtol=1e-6)
        self.assertRaises(ValueError, flat, np.nan)

    def test_glass_by_its_formula(self) -> None:
        self.assertAlmostEqual(float(abbe.spectrum("glass BK7")(587.5618)), 1.5168, places=4)

    def test_a_black_body_by_plancks_law(self) -> None:
        nm = np.array([450.0, 550.0, 650.0])
        planck = nm**-5 / np.expm1(1.438776877e-2 / (nm * 1e-9 * 3200))
        shape = abbe.spectrum("blackbody 3200 K")(nm)
        np.testing.assert_allclose(shape / shape[1], planck / planck[1], rtol=2e-4)

    def test_equal_energy(self) -> None:
        np.testing.assert_allclose(abbe.spectrum(1.0).xyz, (1, 1, 1), atol=2e-3)

    def test_white_is_white(self) -> None:
        x, y, z = abbe.spectrum("illuminant D65").xyz
        np.testing.assert_allclose((x / (x + y + z), y / (x + y + z)), (0.31272, 0.32903), atol=3e-4)
        np.testing.assert_allclose(abbe.color("illuminant D65"), (1, 1, 1), atol=1e-3)
        np.testing.assert_allclose(abbe.color(0.5), (0.5, 0.5, 0.5), atol=1e-3)

    def test_rgb_comes_back(self) -> None:
        for rgb in ((0.8, 0.2, 0.1), (0.1, 0.5, 0.3), (0.05, 0.05, 0.6)):
            np.testing.assert_allclose(abbe.color(("rgb", *rgb)), rgb, atol=2e-3)

    def test_faults_are_diagnostics(self) -> None:
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.spectrum("illuminant FL111")
        self.assertIn("FL11", str(caught.exception))
        self.assertRaises(abbe.SceneError, abbe.spectrum, 1.5)  # no reflectance
        self.assertRaises(ValueError, abbe.spectrum, 0.5, role="nothing")
        self.assertRaises(abbe.SceneError, abbe.spectrum, "x { y }")


if __name__ == "__main__":
    unittest.main()
