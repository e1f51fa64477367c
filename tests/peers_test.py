#!/usr/bin/env python3
"""The pure parts of bench/peers: figures of renders whose error is known, tables, and blocks of text that are written twice.

Exit code 77: there is no numpy.
"""
import math
import pathlib
import sys
import tempfile
import unittest
import zlib

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench/peers"))
try:
    import numpy as np
except ImportError:
    print("skipped: no numpy; name a Python that has it in ABBE_PEER_PYTHON")
    sys.exit(77)
import figures
import report
import scene_reader

WHOLE = (0, 0, 1, 1)


def even(side=128):
    """The renders of another renderer, without noise."""
    return [np.full((side, side, 3), 7.0)]


def renders(count, deviation, seed, truth=0.25, side=128):
    """An even picture with noise of that standard deviation, of a share of it."""
    random = np.random.default_rng(seed)
    return [truth * (1 + deviation * random.standard_normal((side, side, 3))) for _ in range(count)]


def relative_error(deviation):
    return (0.25 * deviation) ** 2 / (0.25 ** 2 + 0.01)


class Priced:
    """Renders nothing, and says what it would have taken."""
    def __init__(self, besides, each):
        self.besides, self.each = besides, each

    def render(self, samples, _seed):
        return None, self.besides + self.each * samples


class Figures(unittest.TestCase):
    def test_samples_fill_the_time_with_what_each_render_costs_besides(self):
        for besides, each in ((0, 0.001), (0.5, 0.001), (1.5, 0.05), (0.9, 1e-5), (0, 0.9)):
            samples = figures.samples_for(Priced(besides, each), 4)
            self.assertTrue(1 / 1.42 < (besides + samples * each) / 4 < 1.42, (besides, each, samples))
        self.assertEqual(figures.samples_for(Priced(5, 1), 4), 1)

    def test_samples_are_not_taken_for_what_begins_with_some_number_of_them(self):
        class Learning(Priced):
            def render(self, samples, _seed):
                return None, super().render(samples, _seed)[1] + (1.5 if samples >= 16 else 0)
        samples = figures.samples_for(Learning(0, 0.02), 4)
        self.assertTrue(1 / 1.42 < (1.5 + samples * 0.02) / 4 < 1.42, samples)

    def test_efficiency_is_that_of_the_noise(self):
        value, spread, trimmed = figures.efficiency(figures.errors_between(renders(4, 0.05, 1), WHOLE, even()), [3.0, 5.0, 4.0, 4.0])
        expected = 1 / (relative_error(0.05) * 4)
        self.assertAlmostEqual(value / expected, 1, delta=0.01)
        self.assertGreater(trimmed, value)
        self.assertLess(spread, 0.5 * value)

    def test_brightness_does_not_matter(self):
        dark = figures.errors_between([0.001 * image for image in renders(3, 0.2, 2)], WHOLE)
        bright = figures.errors_between(renders(3, 0.2, 2), WHOLE)
        self.assertAlmostEqual(dark[1, 0][0] / bright[1, 0][0], 1, delta=1e-9)

    def test_interval_is_as_wide_as_values_scatter(self):
        # Renders of 8 × 8 pixels, so that their errors scatter: about 19 of 20 intervals hold the truth.
        expected, held, widths, values = 1 / relative_error(0.2), 0, [], []
        for seed in range(200):
            value, spread, _ = figures.efficiency(figures.errors_between(renders(6, 0.2, seed, side=8), WHOLE, even(8)), [1.0] * 6)
            held += abs(value - expected) < spread
            widths.append(spread / 2)
            values.append(value)
        self.assertGreater(held, 160)
        self.assertLess(held, 200)
        self.assertAlmostEqual(np.mean(widths) / np.std(values), 1, delta=0.3)

    def test_two_seeds_have_no_interval(self):
        self.assertTrue(math.isnan(figures.efficiency(figures.errors_between(renders(2, 0.1, 3), WHOLE), [1.0, 1.0])[1]))

    def test_bias_counts(self):
        truth = renders(4, 0.05, 4, side=256)
        unbiased = figures.efficiency(figures.errors_against(renders(3, 0.1, 5, side=256), truth, WHOLE), [1.0] * 3)[0]
        self.assertAlmostEqual(unbiased * relative_error(0.1), 1, delta=0.05)
        # A tenth too dark in the left half, which is judged; when the whole is as bright as the truth, that is 0.05 / 0.95.
        step = np.ones((256, 256, 3))
        step[:, :128] = 0.9
        found = figures.errors_against([step, step], truth, (0, 0, 0.5, 1))[0, 0][0]
        self.assertAlmostEqual(found / relative_error(0.05 / 0.95), 1, delta=0.05)

    def test_region_and_trimming(self):
        pictures = renders(2, 0, 6)
        pictures[0][10, 100] = 100
        self.assertLess(figures.errors_between(pictures, (0, 0, 0.5, 1))[1, 0][0], 1e-20)
        outlier = figures.errors_between(pictures, (0.5, 0, 1, 1))[1, 0]
        self.assertAlmostEqual(outlier[0] * 64 * 128, 2, delta=0.05) # half of 100² by the square of their mean
        self.assertLess(outlier[1], 1e-9)

    def test_outliers_do_not_hide_themselves(self):
        pictures, others = renders(2, 0, 6), [2 * image for image in renders(2, 0, 8)]
        pictures[0][10, 100] = 100
        scale = 0.25 / np.mean(pictures)
        expected = 0.5 * (scale * 100) ** 2 / (0.25 ** 2 + 0.01) / 128 ** 2
        self.assertAlmostEqual(figures.errors_between(pictures, WHOLE, others)[1, 0][0] / expected, 1, delta=0.01)

    def test_dark_noise_of_the_other_does_not_count(self):
        noisy = [np.maximum(0, image) for image in renders(1, 1, 9)]
        clean = figures.errors_between(renders(2, 0.05, 10), WHOLE, even())[1, 0][0]
        self.assertLess(figures.errors_between(renders(2, 0.05, 10), WHOLE, noisy)[1, 0][0], 1.1 * clean)

    def test_about(self):
        image = np.random.default_rng(11).uniform(0, 1, (9, 7, 3))
        found = figures.about(image)
        np.testing.assert_allclose(found[4, 3], image[2:7, 1:6].mean(axis=(0, 1)))
        np.testing.assert_allclose(found[0, 6], image[0:3, 4:7].mean(axis=(0, 1)))

    def test_same_scene(self):
        picture = np.random.default_rng(7).uniform(0.1, 1, (64, 64, 3))
        self.assertLess(figures.coarse_difference([3 * picture], [picture]), 1e-9)
        self.assertGreater(figures.coarse_difference([picture[::-1]], [picture]), 0.05)


def row(scene, family, value, biased=False, spread=1.0):
    return {"scene": scene, "renderer": family, "family": family, "biased": biased, "samples": 4, "core_seconds": 1.0, "efficiency": value,
            "spread": spread, "trimmed": value, "version": "1", "off": 0.01, "load_seconds": 1, "first_seconds": 2, "peak_mib": 3}


ROWS = [row("box", "Abbe", 50), row("box", "P", 20), row("box", "Q", 40, biased=True), row("fog", "P", 9), row("fog", "Abbe", 3, spread=math.nan)]
RUN = {"size": 8, "seconds": 1, "seeds": 3, "date": "today", "versions": {"Abbe": "1", "P": "2"}}
ABOUT = {"box": "a box", "fog": "a <fog>"}


class Report(unittest.TestCase):
    def test_ratio_is_against_the_best_unbiased_peer(self):
        text = report.table(ROWS, ["R, box: no such module"])
        self.assertIn("| **2.5** |", text)
        self.assertIn("Q, biased", text)
        self.assertIn("| **0.333** |", text)
        self.assertIn("3 ± ?", text)
        self.assertIn("not compared: R, box", text)
        self.assertEqual({line.count("|") for line in text.splitlines() if line.startswith("|")}, {len(report.HEAD) + 1})

    def test_short_table(self):
        text = report.short_table(ROWS, ABOUT)
        self.assertIn("| box: a box | **50** | 20 | (40) |", text)
        self.assertIn("| fog: a <fog> | 3 | **9** | – |", text)

    def test_block_is_written_once(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "page.md"
            path.write_text("before\n<!-- peers: a -->\nold \\1\n<!-- peers end -->\nbetween\n<!-- peers: b -->\n<!-- peers end -->\nafter\n")
            report.write_block(path, "a", "new \\1 text")
            once = path.read_text()
            self.assertEqual(once, "before\n<!-- peers: a -->\n\nnew \\1 text\n\n<!-- peers end -->\nbetween\n<!-- peers: b -->\n"
                                   "<!-- peers end -->\nafter\n")
            report.write_block(path, "a", "new \\1 text")
            self.assertEqual(path.read_text(), once)
            for name in ("c", "."):
                with self.assertRaises(RuntimeError):
                    report.write_block(path, name, "text")

    def test_pages_have_their_blocks(self):
        root = pathlib.Path(__file__).resolve().parents[1]
        self.assertEqual((root / "docs/performance.md").read_text().count("<!-- peers: six scenes -->"), 1)
        self.assertEqual((root / "README.md").read_text().count("<!-- peers: short -->"), 1)

    def test_page(self):
        text = report.page(ROWS, ["<R>"], RUN, {(r["scene"], r["renderer"]): report.png(1, 1, b"\1\2\3") for r in ROWS}, ABOUT, ["note"])
        self.assertEqual(text.count("data:image/png;base64,"), len(ROWS))
        self.assertNotIn("<R>", text)
        self.assertNotIn("<fog>", text)
        self.assertNotIn("**", text)
        self.assertIn("<b>2.5</b>", text)

    def test_png(self):
        data = report.png(2, 1, b"abcdef")
        at = data.index(b"IDAT")
        self.assertEqual(zlib.decompress(data[at + 4:-16]), b"\0abcdef")


class Reader(unittest.TestCase):
    def test_icosphere(self):
        points, faces = scene_reader.icosphere(2)
        self.assertEqual((len(points), len(faces)), (162, 320))
        a, b, c = (points[faces[:, i]] for i in range(3))
        self.assertTrue((np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0).all())
        points, faces = scene_reader.shining(scene_reader.Ball(None, np.array([1, 2, 3]), 0.5))
        a, b, c = (points[faces[:, i]] for i in range(3))
        self.assertAlmostEqual(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, np.pi, places=9)

    def test_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.xml"
            path.write_text("""<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="-90"/><translate y="3"/></transform>
<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="0.3"/></bsdf></bsdf>
<emitter type="area"><spectrum name="radiance" value="10"/></emitter></shape>
<shape type="rectangle"><transform name="to_world"><matrix value="-1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1"/></transform></shape></scene>""")
            read = scene_reader.read(path, 5)
            np.testing.assert_allclose(read.camera[:3], [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 4]], atol=1e-12)
            mesh = read.meshes[0]
            a, b, c = mesh.points[mesh.faces[0]]
            np.testing.assert_allclose(np.cross(b - a, c - a), [0, 16, 0], atol=1e-9) # up, where its normal was turned
            np.testing.assert_allclose(mesh.points.mean(0), [0, 3, 0], atol=1e-9)
            a, b, c = read.meshes[1].points[read.meshes[1].faces[0]]
            np.testing.assert_allclose(np.cross(b - a, c - a), [0, 0, 4], atol=1e-9) # mirrored, its normal is where it was
            np.testing.assert_allclose(mesh.surface.color, [0.3] * 3, atol=1e-9)
            np.testing.assert_allclose(mesh.surface.emission, [12.05, 9.48, 9.09], atol=0.05) # an even spectrum is a little red
            path.write_text('<scene><shape type="torus"><spectrum name="radiance" value="1"/></shape></scene>')
            with self.assertRaises(RuntimeError):
                scene_reader.read(path, 5)


if __name__ == "__main__":
    unittest.main()
