"""Reads the scenes of bench/peers, as Mitsuba's files have them, for renderers that cannot read those: meshes, balls, lights, RGB.

Only what scenes.py writes and `abbe export --to mitsuba` makes of its scenes is understood; anything else is an error. World space is
kept as it is (y up, right-handed). Spectra become linear Rec.709: emission as the standard observer sees it, what multiplies light as
it is seen under the first lamp, so that the first reflection has the right colour.
"""
import dataclasses
import pathlib
import re
import struct
import xml.etree.ElementTree as xml

import numpy as np

OBSERVER = pathlib.Path(__file__).resolve().parents[2] / "src/spectrum/data/cie1931.inl"
REC709 = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.969266, 1.8760108, 0.041556], [0.0556434, -0.2040259, 1.0572252]])


@dataclasses.dataclass
class Surface:
    kind: str = "diffuse"    # or dielectric, conductor
    color: tuple = (0.5, 0.5, 0.5)
    ior: float = 1.5
    eta: tuple = ()          # of a conductor, with k
    k: tuple = ()
    alpha: float = 0         # width of GGX
    emission: tuple = None   # radiance, from the front side alone


@dataclasses.dataclass
class Mesh:
    surface: Surface
    points: np.ndarray       # n × 3
    faces: np.ndarray        # m × 3, counterclockwise as seen from the front
    file: pathlib.Path = None  # where the same lies as a PLY


@dataclasses.dataclass
class Ball:
    surface: Surface
    center: np.ndarray
    radius: float


@dataclasses.dataclass
class Cloud:
    grid: np.ndarray         # z, y, x: extinction at the centres of cells, times scale
    corners: tuple           # of the box
    scale: float
    albedo: float
    g: float                 # of Henyey and Greenstein


@dataclasses.dataclass
class Scene:
    camera: np.ndarray = None  # to world; it looks along its +z, its +x is on the left of the picture
    fov: float = 0           # across, in degrees
    depth: int = 0           # scattering events of a path
    meshes: list = dataclasses.field(default_factory=list)
    balls: list = dataclasses.field(default_factory=list)
    sky: tuple = None        # radiance from everywhere
    suns: list = dataclasses.field(default_factory=list)  # direction of the light, irradiance across it
    cloud: Cloud = None


def read_observer():
    rows = re.findall(r"^\{([^}]*)\}", OBSERVER.read_text(), re.MULTILINE)
    return np.array([[float(x) for x in row.split(",")] for row in rows])


OBSERVER = read_observer()
NM = np.arange(360, 360 + len(OBSERVER))


def spectrum(node):
    """At NM, nothing outside its wavelengths."""
    text = node.get("value")
    if ":" not in text:
        return np.full(len(NM), float(text))
    nm, values = np.array([[float(x) for x in pair.split(":")] for pair in text.split(",")]).T
    return np.interp(NM, nm, values, 0, 0)


def color(node, lamp=None):
    """Rec.709 of radiance in W/(m² sr nm), or of what multiplies the light of `lamp`, a spectrum."""
    if node.tag == "rgb":
        return tuple(float(x) for x in node.get("value").replace(",", " ").split())
    seen = REC709 @ (spectrum(node) * (1 if lamp is None else lamp) @ OBSERVER)
    return tuple(seen / OBSERVER[:, 1].sum() if lamp is None else np.maximum(0, seen / (REC709 @ (lamp @ OBSERVER))))


def named(node, name, default=None):
    for child in node:
        if child.get("name") == name:
            return child
    if default is None:
        raise RuntimeError(f"<{node.tag} type=\"{node.get('type')}\"> has no `{name}`")
    return xml.Element("float", value=str(default))


def number(node, name, default=None):
    return float(named(node, name, default).get("value"))


def vector(node, default=0):
    if node.get("value"):
        values = [float(x) for x in node.get("value").replace(",", " ").split()]
        return np.array(values * 3 if len(values) == 1 else values)
    return np.array([float(node.get(axis, default)) for axis in "xyz"])


def rotation(axis, degrees):
    x, y, z = axis = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def look_at(node):
    origin, target, up = (np.array([float(x) for x in node.get(name).split(",")]) for name in ("origin", "target", "up"))
    forward = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    return np.column_stack([left, np.cross(forward, left), forward, origin])


def transform(node):
    whole = np.eye(4)
    for step in next((child for child in node if child.tag == "transform"), ()):
        matrix = np.eye(4)
        if step.tag == "matrix":
            matrix = np.array([float(x) for x in step.get("value").split()]).reshape(4, 4)
        elif step.tag == "scale":
            matrix[:3, :3] = np.diag(vector(step, 1))
        elif step.tag == "translate":
            matrix[:3, 3] = vector(step)
        elif step.tag == "rotate":
            matrix[:3, :3] = rotation(vector(step), float(step.get("angle")))
        elif step.tag == "lookat":
            matrix[:3] = look_at(step)
        else:
            raise RuntimeError(f"<{step.tag}> is no transform that is known here")
        whole = matrix @ whole
    return whole


def surface(node, lamp):
    kind = node.get("type")
    if kind == "twosided":
        return surface(next(child for child in node if child.tag == "bsdf"), lamp)
    if kind == "diffuse":
        return Surface(color=color(named(node, "reflectance"), lamp))
    if kind == "dielectric":
        return Surface("dielectric", ior=number(node, "int_ior"))
    if kind == "roughconductor":
        return Surface("conductor", eta=color(named(node, "eta"), lamp), k=color(named(node, "k"), lamp),
                       alpha=number(node, "alpha"))
    raise RuntimeError(f"a bsdf `{kind}` is not known here")


def read_ply(path):
    data = path.read_bytes()
    head, _, rest = data.partition(b"end_header\n")
    words = [line.split() for line in head.decode().splitlines()]
    count = {line[1]: int(line[2]) for line in words if line[0] == "element"}
    names = [line[2] for line in words if line[0] == "property" and line[1] == "float"]
    if words[1][1] != "binary_little_endian" or ["property", "list", "uchar"] not in [line[:3] for line in words]:
        raise RuntimeError(f"{path.name}: a PLY of a kind that is not known here")
    points = np.frombuffer(rest, "<f4", count["vertex"] * len(names)).reshape(-1, len(names))
    faces = np.frombuffer(rest, [("n", "u1"), ("v", "<i4", 3)], count["face"], points.nbytes)
    if (faces["n"] != 3).any():
        raise RuntimeError(f"{path.name}: a face that is no triangle")
    return points[:, [names.index(axis) for axis in "xyz"]].astype(np.float64), faces["v"].astype(np.int32)


SQUARE = (np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))
CUBE = (np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]),
        np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2],
                  [1, 3, 7], [1, 7, 5]]))

SHAPES = {"rectangle": SQUARE, "cube": CUBE}


def icosphere(times):
    """Points of the unit sphere and triangles: an icosahedron, each triangle cut into four so often."""
    golden = (1 + 5 ** 0.5) / 2
    points = np.array([p for a in (-1, 1) for b in (-golden, golden) for p in ((0, a, b), (a, b, 0), (b, 0, a))], float)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 2.1
    faces = [(a, b, c) for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12) if near[a, b] and near[b, c] and near[a, c]]
    faces = np.array([f if np.linalg.det(points[list(f)]) > 0 else f[::-1] for f in faces])
    for _ in range(times):
        edges, inverse = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), 1), axis=0, return_inverse=True)
        middle = inverse.reshape(-1, 3) + len(points)
        points = np.concatenate([points, points[edges].mean(1)])
        a, b, c, ab, bc, ca = *faces.T, *middle.T
        faces = np.concatenate([np.stack(f, 1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points / np.linalg.norm(points, axis=1, keepdims=True), faces


def shining(ball):
    """Points and triangles in place of a ball that shines: few, of its area and so of its power."""
    points, faces = icosphere(1)
    a, b, c = (points[faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return ball.center + ball.radius * (4 * np.pi / area) ** 0.5 * points, faces


def read_cloud(medium, folder, corners):
    volume = named(medium, "sigma_t")
    data = (folder / named(volume, "filename").get("value")).read_bytes()
    x, y, z = struct.unpack("<3i", data[8:20])
    grid = np.frombuffer(data, "<f4", x * y * z, 48).reshape(z, y, x)
    return Cloud(grid, corners, number(medium, "scale"), number(medium, "albedo"), number(next(child for child in medium if child.tag == "phase"), "g"))


def add_shape(scene, node, folder, surfaces, lamp):
    found = Surface()
    for child in node:
        if child.tag == "bsdf" and child.get("type") != "null":
            found = surface(child, lamp)
        elif child.tag == "ref":
            found = surfaces[child.get("id")]
        elif child.tag == "emitter":
            found = dataclasses.replace(found, emission=color(named(child, "radiance")))
    matrix, kind, file = transform(node), node.get("type"), None
    if kind == "sphere":
        scene.balls.append(Ball(found, vector(named(node, "center")), number(node, "radius")))
        return
    if kind == "ply":
        file = folder / named(node, "filename").get("value")
        points, faces = read_ply(file)
        file = file if np.allclose(matrix, np.eye(4)) else None
    elif kind in SHAPES:
        points, faces = SHAPES[kind]
    else:
        raise RuntimeError(f"a shape `{kind}` is not known here")
    points = points @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0:
        faces = faces[:, ::-1]
    medium = next((child for child in node if child.tag == "medium"), None)
    if medium is not None:
        scene.cloud = read_cloud(medium, folder, (points.min(0), points.max(0)))
    else:
        scene.meshes.append(Mesh(found, points, faces, file))


def read(path, depth):
    path = pathlib.Path(path)
    scene, surfaces = Scene(depth=depth), {}
    document = xml.parse(path).getroot()
    lamp = next((spectrum(part) for part in document.iter("spectrum") if part.get("name") in ("radiance", "irradiance")))
    for node in document:
        if node.tag == "sensor":
            scene.camera, scene.fov = transform(node), number(node, "fov")
        elif node.tag == "bsdf":
            surfaces[node.get("id")] = surface(node, lamp)
        elif node.tag == "shape":
            add_shape(scene, node, path.parent, surfaces, lamp)
        elif node.tag == "emitter" and node.get("type") == "constant":
            scene.sky = color(named(node, "radiance"))
        elif node.tag == "emitter" and node.get("type") == "directional":
            scene.suns.append((vector(named(node, "direction")), color(named(node, "irradiance"))))
        elif node.tag != "integrator":
            raise RuntimeError(f"<{node.tag} type=\"{node.get('type')}\"> is not known here")
    return scene
