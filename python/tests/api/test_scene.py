"""Scenes by calls: what becomes of values, what is refused, and that nothing is lost on the way through a file."""

from __future__ import annotations

import pickle
import unittest

from small import InFolder, ball, command

import abbe


class Text(InFolder):
    def test_words_units_blocks_and_nodes(self) -> None:
        scene = abbe.Scene(length="cm")
        scene.camera(from_=(0, 1, 4), look_at="0 0.5 0", fov="40 deg")
        scene.shape(
            "ball", "sphere", radius="10 mm", material=abbe.node("diffuse", reflectance=0.5), transform=[("rotate", "y", "45 deg"), ("scale", 2)]
        )
        self.assertEqual(
            scene.text(),
            "scene 1 length=cm\n"
            "camera {\n    from 0 1 4\n    look-at 0 0.5 0\n    fov 40 deg\n}\n"
            "shape ball sphere {\n    radius 10 mm\n    material diffuse {\n        reflectance 0.5\n    }\n"
            "    transform {\n        rotate y 45 deg\n        scale 2\n    }\n}\n",
        )

    def test_layout_is_that_of_fmt(self) -> None:
        path = self.folder / "a.scene"
        ball(layers={"albedo": True, "spectral": (380, 780, 20)}).write(path)
        command("fmt", "--check", str(path))  # exit code 4, and so an exception, if anything would change

    def test_a_file_reads_back_equal(self) -> None:
        path = self.folder / "a.scene"
        scene = ball()
        with scene.group("pair", transform=[("translate", 1, 0, 0)]) as pair:
            pair.shape("sphere", center=(0, 0.2, 0), radius=0.2, material="glass")
        scene.param("turn", "25 deg", "of nothing")
        scene.write(path)
        again = abbe.load(path)
        self.assertEqual(again.text(self.folder), scene.text(self.folder))
        self.assertTrue((again.render(samples=4).rgb() == scene.render(samples=4).rgb()).all())

    def test_no_text_leaves_its_value(self) -> None:
        hostile = [
            'a"b',
            "a\\b",
            "a\nshape sphere",
            'x" }\nlight sky',
            "{",
            "}",
            "// no",
            "/* no */",
            "a;b",
            "\u202e",
            "\ufeff",
            "\x00",
            "\x7f",
            "é",
            "true",
            "1x",
            "-1",
            "",
        ]
        for name in hostile:
            scene = ball()
            if not name:
                self.assertRaises(ValueError, scene.material, name, "diffuse")
                continue
            scene.material(name, "diffuse", reflectance=0.3)
            scene.shape("sphere", radius=0.1, material=name)
            scene.shape(name + "2", "sphere", radius=0.1)
            scene.check()
            path = self.folder / "hostile.scene"
            scene.write(path)
            self.assertEqual(abbe.load(path).text(self.folder), scene.text(self.folder), repr(name))
        self.assertRaises(ValueError, ball().material, "\ud800", "diffuse")

    def test_numbers_keep_their_bits(self) -> None:
        for value in (0.1, 1e-300, 1.7976931348623157e308, 5e-324, 123456789.123456789):
            scene = abbe.Scene()
            scene.param("x", value)
            self.assertIn(repr(value), scene.text())
        for wrong in (float("nan"), float("inf")):
            self.assertRaises(ValueError, abbe.Scene().shape, "sphere", radius=wrong)

    def test_parameters_variants_and_settings(self) -> None:
        path = self.folder / "a.scene"
        path.write_text("scene 1\nparam high 0.5\nparam turn 10 deg\n" + ball().text().split("\n", 1)[1].replace("radius 0.5", "radius $high"))
        plain = abbe.load(path).render(samples=1, seed=3)
        larger = abbe.load(path, high=0.9, set={"film.size": (40, 30)}).render(samples=1, seed=3)
        self.assertEqual((plain.width, larger.width), (32, 40))
        with self.assertRaisesRegex(ValueError, "abbe.load"):
            abbe.load(path, high=0.9).write(self.folder / "b.scene")
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.load(path, hihg=0.9)
        self.assertIn("E0221", [d.code for d in caught.exception.diagnostics])

    def test_definitions_are_added_to_a_file(self) -> None:
        path = self.folder / "a.scene"
        ball().write(path)
        scene = abbe.load(path)
        scene.shape("second", "sphere", center=(1, 0.5, 0), radius=0.3, material="glass")
        scene.override("film", size=(16, 12))
        self.assertEqual(scene.render(samples=1).width, 16)
        scene.write(self.folder / "b.scene")
        self.assertEqual(abbe.load(self.folder / "b.scene").render(samples=1).width, 16)

    def test_every_kind_has_a_method_with_units_and_defaults(self) -> None:
        for kind in (
            "camera",
            "light",
            "shape",
            "group",
            "object",
            "instance",
            "instances",
            "material",
            "phase",
            "medium",
            "volume",
            "atmosphere",
            "spectrum",
            "texture",
            "film",
            "render_settings",
        ):
            self.assertGreater(len(getattr(abbe.Scene, kind).__doc__), 30, kind)
        self.assertIn("radius: number in m, 1e-30 to 1e+15; default 0.5", abbe.Scene.shape.__doc__)
        self.assertIn("focal", abbe.explain("camera.lens").lower())
        self.assertRaises(KeyError, abbe.explain, "lenz-of-nothing")


class Errors(InFolder):
    def test_a_misspelt_property(self) -> None:
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.Scene().shape("ball", "sphere", radios=0.1)
        [fault] = caught.exception.diagnostics
        self.assertEqual((fault.code, fault.severity), ("E0201", "error"))
        self.assertIn("`radius`", fault.help)

    def test_another_programs_word(self) -> None:
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.Scene().material("m", "diffuse", Kd=0.5)
        self.assertIn("`reflectance`", str(caught.exception))

    def test_a_misspelt_type(self) -> None:
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.Scene().shape("ball", "spere")
        self.assertEqual(caught.exception.diagnostics[0].code, "E0205")

    def test_all_faults_with_their_places(self) -> None:
        path = self.folder / "bad.scene"
        path.write_text("scene 1\ncamera { from 0 1 4; look-at 0 0 0; fov 40 kg }\nshape sphere { radius -1; material gold }\n")
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.load(path)
        faults = caught.exception.diagnostics
        self.assertGreaterEqual(len(faults), 3)
        self.assertTrue(all(f.file == str(path) and f.line in (2, 3) and f.column > 1 for f in faults if f.severity == "error"))
        self.assertIn("^", str(caught.exception))
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual(again.diagnostics, faults)

    def test_undefined_names_come_with_the_nearest(self) -> None:
        scene = ball()
        scene.shape("sphere", material="glas")
        with self.assertRaises(abbe.SceneError) as caught:
            scene.render(samples=1)
        self.assertEqual(caught.exception.diagnostics[0].label, "did you mean `glass`?")

    def test_a_missing_file(self) -> None:
        with self.assertRaises(abbe.SceneError):
            abbe.load(self.folder / "nothing.scene")

    def test_wrong_values(self) -> None:
        scene = ball()
        for wrong in (
            {"samples": 0},
            {"samples": 2.5},
            {"noise": -1},
            {"size": (0, 1)},
            {"size": (1, 2, 3)},
            {"crop": (3, 0, 1, 1)},
            {"part": (1, 2)},
            {"resume": True},
        ):
            with self.assertRaises(ValueError, msg=str(wrong)):
                scene.render(**wrong)
        self.assertRaises(TypeError, scene.shape, "sphere", radius={"a": 1}, material=object())


if __name__ == "__main__":
    unittest.main()
