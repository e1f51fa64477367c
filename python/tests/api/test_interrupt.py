"""Ctrl-C while a scene is read and built, which nothing ends: the call returns, and what still runs harms nobody."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from small import InFolder, ball

import abbe

BALLS = 120_000  # some seconds of reading


def large_scene(folder: Path) -> Path:
    path = folder / "large.scene"
    balls = "".join(f"shape b{i} sphere {{ center {i % 400} 0.{i} {i // 400}; radius 0.25 }}\n" for i in range(BALLS))
    path.write_text(f"scene 1\ncamera {{ from 0 1 4; look-at 0 0 0 }}\nlight daylight\n{balls}")
    return path


class Interrupted(InFolder):
    def setUp(self) -> None:
        super().setUp()
        # A shell's background jobs begin with Ctrl-C ignored.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        self.path = large_scene(self.folder)

    def returns_within_a_second(self, call: Callable[[], object]) -> None:
        sent = []

        def interrupt() -> None:
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(0.2, interrupt)
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            call()
        self.assertLess(time.monotonic() - sent[0], 1.0)
        timer.join()

    def test_load_check_and_render(self) -> None:
        scene = abbe.Scene()
        scene._path = os.fspath(self.path)
        began = time.monotonic()
        scene.check()
        took = time.monotonic() - began
        self.assertGreater(took, 0.5, "the scene is too small for this test")
        self.returns_within_a_second(lambda: abbe.load(self.path))
        self.returns_within_a_second(scene.check)
        self.returns_within_a_second(lambda: scene.render(samples=1, size=(8, 8)))
        # The abandoned render still holds the renderer; what waits for it hears Ctrl-C as well.
        self.returns_within_a_second(lambda: scene.render(samples=1, size=(8, 8)))
        # And others have their turn, with their bits.
        self.assertTrue((ball().render(samples=1).rgb() == ball().render(samples=1).rgb()).all())

    def test_nothing_is_written_by_what_was_abandoned(self) -> None:
        output = self.folder / "a.exr"
        self.returns_within_a_second(lambda: abbe.Scene.render(self.unread(), samples=1, size=(8, 8), output=output))
        ball().render(samples=1)  # waits for it
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("a.")], [])

    def unread(self) -> abbe.Scene:
        scene = abbe.Scene()
        scene._path = os.fspath(self.path)
        return scene

    def end_of(self, program: str) -> tuple[int, float, str]:
        """Exit status of a program that is interrupted while it loads, seconds from then to its end, and its last line."""
        program = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n" + program
        with subprocess.Popen([sys.executable, "-c", program, self.path], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(0.2)
            process.send_signal(signal.SIGINT)
            began = time.monotonic()
            _, said = process.communicate(timeout=120)
            return process.returncode, time.monotonic() - began, said.strip().splitlines()[-1] if said.strip() else ""

    def test_a_program_ends_as_programs_do(self) -> None:
        status, seconds, said = self.end_of("import abbe, sys; print('at it', flush=True); abbe.load(sys.argv[1])")
        self.assertEqual((status, said), (-signal.SIGINT, "KeyboardInterrupt"))
        self.assertLess(seconds, 1.5)

    def test_a_program_that_catches_it_ends_well(self) -> None:
        status, _, said = self.end_of(
            "import abbe, sys\ntry:\n    print('at it', flush=True); abbe.load(sys.argv[1])\nexcept KeyboardInterrupt:\n    sys.exit(7)"
        )
        self.assertEqual((status, said), (7, ""))
