"""Renders: the bits of the command line, how they end, and what they leave behind."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
from small import InFolder, ball, command

import abbe

LONG = 1_000_000  # samples, which nobody waits for


def threads_of_this_process() -> int:
    return len(os.listdir("/proc/self/task"))


class Bits(InFolder):
    def test_those_of_the_command_line(self) -> None:
        path = self.folder / "a.scene"
        scene = ball(layers={"albedo": True, "depth": True, "components": True, "spectral": (380, 780, 40)}, output='"a.exr" half=off')
        scene.write(path)
        command("render", str(path), "--samples", "8", "--seed", "5", "-o", str(self.folder / "cli.exr"), "--quiet")
        theirs = abbe.read_image(self.folder / "cli.exr")
        for ours in (scene.render(samples=8, seed=5), abbe.load(path).render(samples=8, seed=5, threads=1)):
            self.assertEqual(sorted(ours.channels), sorted(theirs.channels))
            ours.save(self.folder / "api.exr")
            saved = abbe.read_image(self.folder / "api.exr")
            for channel in theirs.channels:
                self.assertEqual(saved.channel(channel).tobytes(), theirs.channel(channel).tobytes(), channel)
                self.assertEqual(ours.channel(channel).tobytes(), theirs.channel(channel).tobytes(), channel)

    def test_a_second_render_keeps_what_it_can_and_its_bits(self) -> None:
        scene = ball()
        first, second = scene.render(samples=4), scene.render(samples=4)
        self.assertTrue((first.rgb() == second.rgb()).all())
        scene.forget()
        self.assertTrue((first.rgb() == scene.render(samples=4).rgb()).all())

    def test_changes_are_seen(self) -> None:
        path = self.folder / "a.scene"
        ball().write(path)
        scene = abbe.load(path)
        before = scene.render(samples=1)
        path.write_text(path.read_text().replace("radius 0.5", "radius 0.2"))
        os.utime(path, (1, 1))
        self.assertFalse((before.rgb() == scene.render(samples=1).rgb()).all())

    def test_output_is_the_files_of_the_command(self) -> None:
        image = ball().render(samples=2, output=self.folder / "a.exr")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.exr", "a.exr.json", "a.png"])
        self.assertEqual(len(image.files), 2)
        self.assertTrue((abbe.read_image(self.folder / "a.exr").rgb() == image.rgb()).all())

    def test_parts_come_together(self) -> None:
        scene, path = ball(), self.folder / "a.scene"
        scene.write(path)
        whole = scene.render(samples=8)
        parts = []
        for k in (1, 2):
            self.assertIsNone(abbe.load(path).render(samples=8, part=(k, 2), output=self.folder / f"{k}.abbe"))
        parts = sorted(self.folder.glob("*.abbe"))
        self.assertEqual(len(parts), 2)
        merged = abbe.merge(parts)
        self.assertTrue((merged.rgb() == whole.rgb()).all())
        with self.assertRaises((abbe.SceneError, ValueError)):
            abbe.merge(parts[:1])
        self.assertRaises(ValueError, abbe.merge, [path])

    def test_a_render_is_resumed(self) -> None:
        scene, path, output = ball(64, 48), self.folder / "a.scene", self.folder / "a.exr"
        scene.write(path)
        scene = abbe.load(path)
        whole = scene.render(samples=600)

        def stop(progress: dict[str, object]) -> None:
            if progress["done"] > 0.2:
                raise StopIteration

        try:
            scene.render(samples=600, output=output, progress=stop)
        except StopIteration:
            self.assertTrue((self.folder / "a.exr.ckpt").exists())
        resumed = scene.render(samples=600, output=output, resume=True)
        self.assertTrue((resumed.rgb() == whole.rgb()).all())


class Ends(InFolder):
    def ends_within_a_second(self, scene: abbe.Scene, expected: type[BaseException], **options: object) -> None:
        before = threads_of_this_process()
        began = time.monotonic()
        with self.assertRaises(expected):
            scene.render(samples=LONG, **options)
        self.assertLess(time.monotonic() - self.asked, 1.0)
        self.assertLess(time.monotonic() - began, 60)
        self.assertLessEqual(threads_of_this_process(), before + 1)  # the pool's threads are there before
        burnt = time.process_time()
        time.sleep(0.3)
        self.assertLess(time.process_time() - burnt, 0.1, "something still renders")

    def setUp(self) -> None:
        super().setUp()
        self.scene = ball(64, 48)
        self.scene.render(samples=1)  # the pool of threads
        self.asked = 0.0

    def test_by_an_exception(self) -> None:
        def progress(state: dict[str, object]) -> None:
            self.asked = time.monotonic()
            raise ZeroDivisionError

        self.ends_within_a_second(self.scene, ZeroDivisionError, progress=progress)

    def test_by_ctrl_c(self) -> None:
        def interrupt() -> None:
            self.asked = time.monotonic()
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(0.8, interrupt)
        timer.start()
        self.ends_within_a_second(self.scene, KeyboardInterrupt)
        timer.join()
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)  # as it was

    def test_by_its_time(self) -> None:
        image = self.scene.render(samples=LONG, time=0.5)
        self.assertGreater(image.samples, 0)

    def test_by_its_noise(self) -> None:
        image = self.scene.render(samples=LONG, noise=0.2)
        self.assertLessEqual(image.noise, 0.2)

    def test_others_go_on_meanwhile(self) -> None:
        turns, done = 0, threading.Event()

        def count() -> None:
            nonlocal turns
            while not done.wait(0.01):
                turns += 1

        thread = threading.Thread(target=count)
        thread.start()
        self.scene.render(samples=LONG, time=1)
        done.set()
        thread.join()
        self.assertGreater(turns, 20)

    def test_renders_take_turns(self) -> None:
        images: list[abbe.Image] = []
        threads = [threading.Thread(target=lambda: images.append(ball().render(samples=16))) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(images), 3)
        self.assertTrue(all((image.rgb() == images[0].rgb()).all() for image in images))

    def test_progress_is_told_on_this_thread(self) -> None:
        told: list[dict[str, object]] = []
        who: set[int] = set()

        def progress(state: dict[str, object]) -> None:
            told.append(state)
            who.add(threading.get_ident())

        self.scene.render(samples=200, progress=progress)
        self.assertEqual(who, {threading.get_ident()})
        done = [state["done"] for state in told]
        self.assertEqual(done, sorted(done))
        self.assertEqual(done[-1], 1.0)
        self.assertEqual(told[-1]["of_samples"], 200)

    def test_a_progress_function_cannot_render(self) -> None:
        with self.assertRaisesRegex(RuntimeError, "progress"):
            self.scene.render(samples=LONG, progress=lambda _: self.scene.render(samples=1))


class Leaks(InFolder):
    def test_a_thousand_renders(self) -> None:
        def resident() -> int:
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

        def render(number: int) -> None:
            scene = abbe.Scene()
            scene.film(size=(4, 3))
            scene.camera(from_=(0, 0, 4), look_at=(0, 0, 0))
            scene.light("point", position=(0, 4, 4), intensity="100 cd")
            points = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, number * 1e-4]], dtype=np.float32)
            scene.shape("mesh", points=points, faces=np.array([[0, 1, 2]], dtype=np.uint32))
            image = scene.render(samples=1)
            image.channel("R")
            image.rgb("acescg")

        for number in range(100):
            render(number)
        before, tasks = resident(), threads_of_this_process()
        for number in range(900):
            render(number)
        self.assertLess(resident() - before, 12 << 20)
        self.assertLessEqual(threads_of_this_process(), tasks + 1)
