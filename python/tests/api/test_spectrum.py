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

    def test_a_reflectance_in_illuminant_a(self) -> None:
        """Against the published white of A (CIE 15:2018, table 11.3), and a band of red by hand: Planck's formula of A times the fits of the
        observer by Wyman, Sloan and Shirley (2013), which are within some per cent of it."""
        white = np.array([1.09850, 1.0, 0.35585])
        np.testing.assert_allclose(abbe.spectrum(1.0).under("illuminant A"), white, atol=5e-4)
        np.testing.assert_allclose(abbe.spectrum(0.5).under("illuminant A"), 0.5 * white, atol=3e-4)
        # However bright the light is stated to be.
        np.testing.assert_allclose(abbe.spectrum(0.5).under(abbe.spectrum("blackbody 2856 K")), 0.5 * white, atol=1e-3)

        nm = np.arange(380.0, 781.0)
        light = (560 / nm) ** 5 * np.expm1(1.435e7 / (2848 * 560)) / np.expm1(1.435e7 / (2848 * nm))

        def lobe(height: float, mean: float, left: float, right: float) -> np.ndarray:
            return height * np.exp(-0.5 * ((nm - mean) * np.where(nm < mean, left, right)) ** 2)

        x_bar = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382)
        y_bar = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
        band = np.interp(nm, [590, 600, 610], [0, 1, 0])
        x, y, z = abbe.spectrum({400: 0, 590: 0, 600: 1, 610: 0, 700: 0}).under("illuminant A")
        total = (light * y_bar).sum()
        np.testing.assert_allclose((x, y), ((band * light * x_bar).sum() / total, (band * light * y_bar).sum() / total), rtol=0.03)
        self.assertLess(z, 1e-3)
        self.assertAlmostEqual(y, 0.0755, delta=0.0015)  # 10 nm · 129.04 · 0.6310 / 10789, from the tables of CIE 15

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
