"""The scenes of bench/peers: each is written once, as a scene of Mitsuba's that Abbe imports or of Abbe's that it exports.

Every one asks for something else: bounces between walls, light through a slit, the choice of a light, many triangles, a
cloud, a caustic. All have 512 × 512 pixels with a box filter unless they are told otherwise.
"""
import dataclasses
import pathlib
import re
import struct

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]


@dataclasses.dataclass
class Scene:
    name: str
    about: str
    depth: int                      # scattering events of a path
    write: object                   # (folder, size, depth) -> path of an .xml or a .scene
    region: tuple = (0, 0, 1, 1)    # of the picture that is judged: x0, y0, x1, y1 as shares of its sides
    mitsuba: tuple = ()             # integrators of Mitsuba's beside that of the file
    cycles: tuple = ()              # what else of Cycles', cycles_peer.py
    luxcore: tuple = ()             # what else of LuxCore's, luxcore_peer.py
    aspect: float = 1               # height over width
    gltf: bool = False              # all read it as glTF, as `abbe export` makes it; Cycles alone can here


def of_repository(relative):
    """A scene file of this repository, with as many scattering events as the comparison has."""
    def write(folder, size, depth):
        text = (ROOT / relative).read_text()
        text, found = re.subn(r"render\s*\{", f"render {{ max-depth {depth}; ", text, count=1)
        film = re.compile(r"film\s*\{\s*size \d+ \d+")
        if not found or not film.search(text):
            raise RuntimeError(f"{relative} has no `render {{` or no `film {{ size` in it")
        text = film.sub(f"film {{ filter box 0.5; size {size} {size}", text, count=1) if "filter" not in text else \
            film.sub(f"film {{ size {size} {size}", text, count=1)
        text = re.sub(r'(output "[^"]*")', r"\1 space=rec709", text, count=1) # the channels that Mitsuba writes
        path = folder / pathlib.Path(relative).name
        path.write_text(text)
        return path
    return write


def document(size, depth, integrator, look_at, fov, body):
    eye, target = look_at
    return f"""<scene version="3.0.0">
<integrator type="{integrator}"><integer name="max_depth" value="{depth + 1}"/></integrator>
<sensor type="perspective"><float name="fov" value="{fov}"/>
  <transform name="to_world"><lookat origin="{eye}" target="{target}" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="{size}"/>
    <rfilter type="box"/></film>
  <sampler type="independent"/></sensor>
{body}</scene>
"""


def diffuse(value):
    return f'<bsdf type="diffuse"><spectrum name="reflectance" value="{value}"/></bsdf>'


def floor(half, height=0, value=0.6):
    return f"""<shape type="rectangle"><transform name="to_world"><scale value="{half}"/><rotate x="1" angle="-90"/>
  <translate y="{height}"/></transform>{diffuse(value)}</shape>
"""


def lights(folder, size, depth):
    """A thousand small balls of very different power over a floor with blocks."""
    random = np.random.default_rng(1)
    body = floor(6)
    for x, z in random.uniform(-4, 4, (24, 2)):
        height = random.uniform(0.2, 1.2)
        body += f"""<shape type="cube"><transform name="to_world"><scale x="0.25" y="{height / 2:.4f}" z="0.25"/>
  <translate x="{x:.4f}" y="{height / 2:.4f}" z="{z:.4f}"/></transform>{diffuse(0.5)}</shape>
"""
    for _ in range(1000):
        x, z = random.uniform(-5, 5, 2)
        y, radius = random.uniform(0.1, 2), random.uniform(0.005, 0.02)
        radiance = 10 ** random.uniform(0.5, 3)
        body += f"""<shape type="sphere"><point name="center" x="{x:.4f}" y="{y:.4f}" z="{z:.4f}"/>
  <float name="radius" value="{radius:.5f}"/>
  <emitter type="area"><spectrum name="radiance" value="{radiance:.3f}"/></emitter></shape>
"""
    path = folder / "lights.xml"
    path.write_text(document(size, depth, "path", ("0, 4, 9", "0, 0.5, 0"), 45, body))
    return path


def write_ply(path, points, faces):
    with open(path, "wb") as out:
        out.write(f"""ply
format binary_little_endian 1.0
element vertex {len(points)}
property float x
property float y
property float z
element face {len(faces)}
property list uchar int vertex_indices
end_header
""".encode())
        out.write(points.astype("<f4").tobytes())
        rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, faces
        out.write(rows.tobytes())


def mesh(folder, size, depth):
    """A rough ball of 2.1 million triangles under an even sky and a sun."""
    n = 1024
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, n + 1), np.linspace(0.002, np.pi - 0.002, n + 1))
    radius = 1 + 0.03 * np.sin(23 * u) * np.sin(19 * v) + 0.01 * np.sin(91 * u + 7 * v) + 0.004 * np.cos(301 * v)
    points = np.stack([radius * np.sin(v) * np.cos(u), radius * np.cos(v), radius * np.sin(v) * np.sin(u)], -1)
    i = (np.arange(n)[:, None] * (n + 1) + np.arange(n)[None, :]).ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + n + 2], -1), np.stack([i, i + n + 2, i + n + 1], -1)])
    write_ply(folder / "ball.ply", points.reshape(-1, 3), faces)
    body = f"""<shape type="ply"><string name="filename" value="ball.ply"/>
  <boolean name="face_normals" value="true"/><bsdf type="twosided">{diffuse(0.5)}</bsdf></shape>
{floor(8, -1.05)}<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>
<emitter type="directional"><vector name="direction" value="-0.5, -1, -0.4"/>
  <spectrum name="irradiance" value="6"/></emitter>
"""
    path = folder / "mesh.xml"
    path.write_text(document(size, depth, "path", ("0, 1, 4", "0, -0.1, 0"), 40, body))
    return path


def write_vol(path, grid):
    """Mitsuba's grid volume, version 3: numbers of 4 bytes, x fastest, in the unit cube."""
    z, y, x = grid.shape
    header = b"VOL" + struct.pack("<B5i6f", 3, 1, x, y, z, 1, 0, 0, 0, 1, 1, 1)
    path.write_bytes(header + grid.astype("<f4").tobytes())


def cloud(folder, size, depth):
    """A cloud of albedo 0.999 with forward scattering, under a sun and an even sky."""
    n = 96
    random = np.random.default_rng(3)
    axis = (np.arange(n) + 0.5) / n
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    density = np.zeros((n, n, n))
    for _ in range(60):
        cx, cz = random.normal(0.5, 0.13, 2)
        cy, r = random.uniform(0.25, 0.6), random.uniform(0.05, 0.14)
        density += np.exp(-((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) / (r * r))
    density = np.clip(density - 0.8, 0, 1) * (0.6 + 0.4 * np.sin(40 * x + 9 * y) * np.sin(37 * z) * np.sin(33 * y))
    write_vol(folder / "cloud.vol", density)
    body = """<shape type="cube"><transform name="to_world"><scale value="1"/></transform>
  <bsdf type="null"/><medium name="interior" type="heterogeneous">
    <volume name="sigma_t" type="gridvolume"><string name="filename" value="cloud.vol"/>
      <transform name="to_world"><scale value="2"/><translate x="-1" y="-1" z="-1"/></transform></volume>
    <spectrum name="albedo" value="0.999"/><float name="scale" value="40"/>
    <phase type="hg"><float name="g" value="0.6"/></phase></medium></shape>
<emitter type="constant"><spectrum name="radiance" value="0.3"/></emitter>
<emitter type="directional"><vector name="direction" value="-0.6, -1, -0.3"/>
  <spectrum name="irradiance" value="5"/></emitter>
"""
    path = folder / "cloud.xml"
    path.write_text(document(size, depth, "volpath", ("0, 0.3, 4", "0, -0.1, 0"), 36, body))
    return path


def caustic(folder, size, depth):
    """A ball of glass on a floor below a small lamp; judged where the caustic is."""
    body = floor(3) + """<shape type="sphere"><point name="center" x="0" y="0.6" z="0"/>
  <float name="radius" value="0.5"/>
  <bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf></shape>
<shape type="sphere"><point name="center" x="-1.6" y="2.6" z="0"/><float name="radius" value="0.05"/>
  <emitter type="area"><spectrum name="radiance" value="400"/></emitter></shape>
"""
    path = folder / "caustic.xml"
    path.write_text(document(size, depth, "path", ("0.6, 3, 4", "0.3, 0.2, 0"), 34, body))
    return path


SCENES = [
    Scene("cornell", "bounces between walls", 16, of_repository("scenes/cornell-box/cornell-box.scene")),
    Scene("ajar", "a room that is lit through a slit", 24, of_repository("bench/peers/ajar.scene"), cycles=("guiding",)),
    Scene("lights", "a thousand lights", 16, lights),
    Scene("mesh", "2.1 million triangles, sky and sun", 8, mesh),
    Scene("cloud", "albedo 0.999, forward scattering", 128, cloud, mitsuba=("volpathmis",)),
    Scene("caustic", "of a glass ball, on the floor", 16, caustic, region=(0.5, 0.42, 0.72, 0.62), 
          mitsuba=("ptracer",), luxcore=("bidir", "photons")),
]

# Rendered where it is asked for by name.
EXTRA = [
    Scene("hero", "the still life, exported to glTF", 32, lambda *_: ROOT / "scenes/hero/hero.scene", aspect=9 / 16, gltf=True),
]
