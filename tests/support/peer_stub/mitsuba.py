"""Stands in for Mitsuba in tests of `abbe study --against mitsuba`: pictures of one grey with noise that falls as it
should. STUB_FAULT in the environment makes it fail: start, crash, hang, damaged or late."""
import array
import os
import random
import sys
import time

__version__ = "3.stub"
FAULT = os.environ.get("STUB_FAULT", "")
GREY = 0.25
if FAULT == "start":
    raise ImportError("no stub today")


def variants():
    return ["scalar_rgb", "scalar_spectral", "llvm_ad_spectral"]


def set_variant(variant):
    # As an LLVM that is too old ends the whole process.
    if variant.startswith("llvm") and FAULT != "llvm":
        os.abort()


def set_log_level(level):
    pass


class LogLevel:
    Error = 1


class Struct:
    class Type:
        Float32 = 1


def ScalarVector2u(value):
    return value


ScalarPoint2u = ScalarVector2u


class Sampler:
    count = 0

    def sample_count(self):
        return self.count


class Sensor:
    def __init__(self):
        self.size = [1, 1]
        self.taken = Sampler()

    def sampler(self):
        return self.taken


class Scene:
    def __init__(self):
        self.camera = Sensor()

    def sensors(self):
        return [self.camera]


def load_file(path):
    with open(path) as file:
        if "<scene" not in file.read():
            sys.exit("no scene")
    return Scene()


class Parameters(dict):
    def __init__(self, sensor):
        super().__init__()
        self.sensor = sensor

    def update(self):
        self.sensor.size = self["film.size"]


def traverse(sensor):
    return Parameters(sensor)


class Image:
    def __init__(self, size, values):
        self.size, self.values = size, values


def render(scene, sensor, spp, seed):
    width, height = sensor.size
    large = width * height > 64
    if FAULT == "hang" and large:
        time.sleep(1000)
    if FAULT == "crash" and large:
        os.abort()
    if FAULT == "late" and spp > 64:
        sys.exit("the stub has had enough")
    sensor.taken.count = spp
    generator = random.Random(seed)
    time.sleep(spp * 1e-4)
    spread = 0.1 / spp**0.5
    values = array.array("f", (GREY + generator.gauss(0, spread) for _ in range(3 * width * height)))
    return Image((width, height), values)


class Bitmap:
    class PixelFormat:
        RGB = 1

    def __init__(self, image):
        self.image = image

    def convert(self, pixel_format, component, srgb_gamma):
        return self

    def write(self, path):
        width, height = self.image.size
        with open(path, "wb") as file:
            file.write(b"PF\n%d %d\n-1\n" % (width, height))
            bytes_ = self.image.values.tobytes()
            file.write(bytes_[: len(bytes_) // 2] if FAULT == "damaged" else bytes_)
