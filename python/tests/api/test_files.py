"""Which files a scene may read (docs/language/files.md), as Python states it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from unittest import mock

from small import InFolder, ball

import abbe

PICTURE = 'scene 1\ncamera {{ from 0 0 4; look-at 0 0 0 }}\nlight daylight\ntexture bark image "{0}"\nshape sphere {{ material diffuse {{ reflectance bark }} }}\n'


class Search(InFolder):
    def setUp(self) -> None:
        super().setUp()
        self.folder = self.folder.resolve()
        self.library = self.folder / "library"
        self.shot = self.folder / "shot"
        for folder in (self.library, self.shot):
            folder.mkdir()
        ball().render(samples=1).save(self.library / "bark.png")
        self.path = self.shot / "a.scene"
        self.path.write_text(PICTURE.format("../library/bark.png"))

    def codes(self, error: abbe.SceneError) -> list[str]:
        return [one.code for one in error.diagnostics if one.severity == "error"]

    def test_refused_without(self) -> None:
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.load(self.path)
        self.assertEqual(self.codes(caught.exception), ["E0417"])
        self.assertIn("--search", str(caught.exception))

    def test_read_with(self) -> None:
        for folder in (self.library, str(self.library), self.folder, "/"):
            scene = abbe.load(self.path, search=[folder])
            self.assertEqual(scene.render(samples=1, size=(8, 8)).rgb().shape, (8, 8, 3))

    def test_one_folder_too_many_or_too_few(self) -> None:
        other = self.folder / "other"
        other.mkdir()
        self.assertRaises(abbe.SceneError, abbe.load, self.path, search=[other])
        abbe.load(self.path, search=[other, self.library])

    def test_names_are_looked_up(self) -> None:
        self.path.write_text(PICTURE.format("bark.png"))
        with self.assertRaises(abbe.SceneError) as caught:
            abbe.load(self.path)
        self.assertEqual(self.codes(caught.exception), ["E0401"])
        abbe.load(self.path, search=[self.library])

    def test_relative_folders_are_of_the_call(self) -> None:
        """As they were when the scene was loaded, wherever it is rendered."""
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        os.chdir(self.folder)
        scene = abbe.load(self.path, search=["library"])
        os.chdir(here)
        scene.forget()
        scene.check()

    def test_what_a_program_names_itself_may_lie_anywhere(self) -> None:
        file = self.library / "bark.png"
        seen = set()
        for reflectance in ("bark", abbe.node("image", str(file)), abbe.node("image", file), ("image", file), ("image", str(file))):
            scene = abbe.Scene()
            scene.camera(from_=(0, 0, 4), look_at=(0, 0, 0))
            scene.light("daylight")
            scene.texture("bark", "image", str(file))
            scene.shape("sphere", material=abbe.node("diffuse", reflectance=reflectance))
            seen.add(scene.render(samples=1, size=(8, 8)).rgb().tobytes())
        self.assertEqual(len(seen), 1)

    def test_but_what_that_file_names_may_not(self) -> None:
        """An include that the program names reads its own folder, and not whatever its text says."""
        secret = self.folder / "secret"
        secret.mkdir()
        ball().render(samples=1).save(secret / "bark.png")
        part = self.library / "part.scene"
        part.write_text('scene 1\ntexture bark image "../secret/bark.png"\n')

        def scene(**options: object) -> abbe.Scene:
            made = abbe.Scene(**options)
            made.camera(from_=(0, 0, 4), look_at=(0, 0, 0))
            made.light("daylight")
            made.include(part)
            made.shape("sphere", material=abbe.node("diffuse", reflectance="bark"))
            return made

        with self.assertRaises(abbe.SceneError) as caught:
            scene().check()
        self.assertEqual(self.codes(caught.exception), ["E0417"])
        scene(search=[secret]).check()

    def test_the_environment(self) -> None:
        program = "import abbe, sys; abbe.load(sys.argv[1])"
        for folders, status in (("", 1), (f"/nowhere:{self.library}", 0)):
            with mock.patch.dict(os.environ, {"ABBE_PATH": folders}):
                done = subprocess.run([sys.executable, "-c", program, self.path], capture_output=True, text=True)
            self.assertEqual(done.returncode, status, done.stderr)

    def test_commands_hear_of_it(self) -> None:
        """`abbe.study` and the like run the command, which needs the folders, too."""
        scene = abbe.load(self.path, search=[self.library])
        self.assertIn(str(self.library), scene._folders())

    def test_a_project(self) -> None:
        Path(self.folder / ".abbe-project").touch()
        abbe.load(self.path)
