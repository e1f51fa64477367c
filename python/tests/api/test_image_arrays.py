"""Image textures out of arrays: the same as out of files of the same pixels, and what is no picture is refused."""

from __future__ import annotations

import gc
import os
import struct
import unittest
import unittest.mock
import zlib
from pathlib import Path

import numpy as np
from small import InFolder

import abbe


def write_png(path: Path, pixels: np.ndarray) -> None:
    """8 bits, of 1 to 4 channels."""
    height, width, channels = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_pfm(path: Path, pixels: np.ndarray) -> None:
    """32 bits, of 1 or 3 channels; rows from the bottom."""
    height, width, channels = pixels.shape
    path.write_bytes(f"P{'F' if channels == 3 else 'f'}\n{width} {height}\n-1.0\n".encode() + pixels[::-1].astype("<f4").tobytes())


def bytes_of(channels: int, height: int = 37, width: int = 70) -> np.ndarray:
    return np.random.default_rng(channels).integers(0, 256, (height, width, channels), dtype=np.uint8)


def floats_of(channels: int) -> np.ndarray:
    return np.random.default_rng(channels).uniform(0, 1, (37, 70, channels)).astype(np.float32)


def wall(reflectance: object, scene: abbe.Scene | None = None, **properties: object) -> abbe.Scene:
    scene = scene or abbe.Scene()
    scene.film(size=(32, 24))
    scene.camera(from_=(0, 0, 1.5), look_at=(0, 0, 0))
    scene.light("sun", elevation="40 deg", azimuth="180 deg")
    scene.light("environment", image=np.ones((4, 8, 3), dtype=np.float32))
    scene.shape("quad", material=abbe.node("diffuse", reflectance=reflectance, **properties))
    return scene


def picture(scene: abbe.Scene) -> np.ndarray:
    return scene.render(samples=4).rgb()


class Pictures(InFolder):
    def setUp(self) -> None:
        """A cache without textures, so that all of them are made anew; what else is kept there takes a while to make."""
        super().setUp()
        known = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "abbe"
        cache = self.folder / "cache" / "abbe"
        cache.mkdir(parents=True)
        for entry in known.glob("*"):
            if entry.name != "textures":
                (cache / entry.name).symlink_to(entry)
        change = unittest.mock.patch.dict(os.environ, {"XDG_CACHE_HOME": str(self.folder / "cache")})
        change.start()
        self.addCleanup(change.stop)

    def equal(self, array: np.ndarray, path: Path, space: str | None = None) -> np.ndarray:
        """The bits of the array and of the file."""
        keys = {"space": space} if space else {}
        ours = picture(wall(abbe.image(array, space)))
        self.assertTrue((ours == picture(wall(abbe.node("image", str(path), keys=keys)))).all())
        return ours

    def test_the_bits_of_a_png(self) -> None:
        seen = []
        for channels in (1, 2, 3, 4):
            path = self.folder / f"{channels}.png"
            write_png(path, bytes_of(channels))
            seen.append(self.equal(bytes_of(channels), path))
        seen.append(self.equal(bytes_of(3), self.folder / "3.png", "lin_rec709_scene"))
        self.assertTrue(list((self.folder / "cache" / "abbe" / "textures").glob("image-*.tif")))
        self.assertTrue(all((seen[i] != seen[j]).any() for i in range(5) for j in range(i)))

    def test_the_bits_of_floats(self) -> None:
        for channels in (1, 3):
            path = self.folder / f"{channels}.pfm"
            write_pfm(path, floats_of(channels))
            self.equal(floats_of(channels), path, "lin_rec709_scene" if channels == 3 else "data")

    def test_alpha(self) -> None:
        write_png(self.folder / "4.png", bytes_of(4))
        ours = picture(wall("rgb 0.5 0.5 0.5", opacity=abbe.image(bytes_of(4), take="alpha", wrap="clamp")))
        node = abbe.node("image", str(self.folder / "4.png"), take="alpha", wrap="clamp")
        self.assertTrue((ours == picture(wall("rgb 0.5 0.5 0.5", opacity=node))).all())

    def test_a_texture_by_name(self) -> None:
        scene = abbe.Scene()
        scene.texture("bark", "image", abbe.image(bytes_of(3)))
        self.assertTrue((picture(wall("bark", scene)) == picture(wall(abbe.image(bytes_of(3))))).all())

    def test_two_dimensions_and_other_types(self) -> None:
        one = picture(wall(abbe.image(floats_of(1))))
        for same in (floats_of(1)[:, :, 0], floats_of(1).astype(float), np.asfortranarray(floats_of(1)[..., 0])):
            self.assertTrue((picture(wall(abbe.image(same))) == one).all())

    def test_the_scene_keeps_them(self) -> None:
        scene = wall(abbe.image(bytes_of(3)))
        gc.collect()
        junk = [bytes_of(3) for _ in range(100)]
        first = picture(scene)
        scene.forget()
        del junk
        self.assertTrue((picture(scene) == first).all())

    def test_without_a_copy(self) -> None:
        for pixels, all_white in ((bytes_of(3), 255), (floats_of(3), 1)):
            scene = wall(abbe.image(pixels))
            pixels[:] = all_white  # what nobody should do: it shows that the renderer looks at this very array
            self.assertTrue((picture(scene) == picture(wall(abbe.image(np.full_like(pixels, all_white))))).all())

    def test_no_text(self) -> None:
        scene = abbe.Scene()
        scene.shape("quad", material=abbe.node("diffuse", reflectance=abbe.image(bytes_of(3))))
        with self.assertRaisesRegex(ValueError, r"array of \(37, 70, 3\) has no place"):
            scene.write(self.folder / "a.scene")
        self.assertFalse(list(self.folder.glob("*.scene*")))
        self.assertRaises(ValueError, scene.render, part=(1, 2), output="x.exr")


class Refusals(unittest.TestCase):
    def test_shapes_and_types(self) -> None:
        for fault, pattern, array, more in (
            (ValueError, r"\(height, width\)", floats_of(3)[0, 0], {}),
            (ValueError, r"\(height, width\)", np.zeros((4, 4, 5), dtype=np.float32), {}),
            (ValueError, r"\(height, width\)", np.zeros((0, 4, 3), dtype=np.uint8), {}),
            (TypeError, "numbers", floats_of(3).astype(complex), {}),
            (ValueError, "not finite", floats_of(3) * np.inf, {}),
            (ValueError, "no alpha", floats_of(3), {"take": "alpha"}),
            (TypeError, "space", floats_of(3), {"space": 3}),
        ):
            with self.assertRaisesRegex(fault, pattern):
                abbe.image(array, **more)

    def test_names(self) -> None:
        with self.assertRaisesRegex(abbe.SceneError, "srgbb"):
            wall(abbe.image(bytes_of(3), "srgbb")).check()
        with self.assertRaisesRegex(abbe.SceneError, "torus"):
            wall(abbe.image(bytes_of(3), wrap="torus")).check()

    def test_places(self) -> None:
        with self.assertRaisesRegex(TypeError, "texture"):
            abbe.Scene().shape("sphere", radius=abbe.image(bytes_of(1)))


if __name__ == "__main__":
    unittest.main()
