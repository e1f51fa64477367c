"""Renders a scene with Blender's Cycles for peers.py: cycles_peer.py SCENE.xml|SCENE.glb DEPTH SIZE [guiding] (protocol: peer_process.py).

Settings are Blender's but for what biases: no clamping, no glossy filter, no threshold for lights, no adaptive sampling, no denoiser, as
many bounces of each kind as the scene has. A ball that shines is a point light of its radius, which Cycles samples best; many are meshes, as
rays are tested against all point lights.
"""
import pathlib
import sys
import tempfile

import numpy as np

import peer_process # before the renderer
import bpy
import mathutils
import scene_reader


def settings(scene, size, depth, guiding):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.volume_bounces = depth - 1
    cycles.transparent_max_bounces = 128
    cycles.use_guiding = guiding


def place(name, data, matrix=np.eye(4)):
    thing = bpy.data.objects.new(name, data)
    thing.matrix_world = mathutils.Matrix(np.asarray(matrix).tolist())
    bpy.context.scene.collection.objects.link(thing)
    return thing


def node(tree, kind, **inputs):
    made = tree.nodes.new(kind)
    for name, value in inputs.items():
        made.inputs[name.replace("_", " ")].default_value = (*value, 1) if isinstance(value, (tuple, list)) else value
    return made


def scattering(tree, surface):
    if surface.kind == "dielectric":
        return node(tree, "ShaderNodeBsdfGlass", Color=(1, 1, 1), Roughness=0, IOR=surface.ior)
    if surface.kind == "conductor":
        metal = node(tree, "ShaderNodeBsdfMetallic", Roughness=surface.alpha ** 0.5)
        metal.distribution, metal.fresnel_type = "GGX", "PHYSICAL_CONDUCTOR"
        metal.inputs["IOR"].default_value, metal.inputs["Extinction"].default_value = surface.eta, surface.k
        return metal
    return node(tree, "ShaderNodeBsdfDiffuse", Color=surface.color, Roughness=0)


def material(surface):
    made = bpy.data.materials.new("m")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    out = tree.nodes.new("ShaderNodeOutputMaterial")
    shader = scattering(tree, surface)
    if surface.emission:
        strength = max(surface.emission)
        glow = node(tree, "ShaderNodeEmission", Color=tuple(x / strength for x in surface.emission), Strength=strength)
        front, side, both = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "NewGeometry", "AddShader"))
        tree.links.new(side.outputs["Backfacing"], front.inputs[0])
        tree.links.new(glow.outputs[0], front.inputs[1])
        tree.links.new(front.outputs[0], both.inputs[0])
        tree.links.new(shader.outputs[0], both.inputs[1])
        shader = both
        made.cycles.emission_sampling = "FRONT"
    tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return made


def add_mesh(points, faces, surface, smooth):
    mesh = bpy.data.meshes.new("mesh")
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.loops.add(3 * len(faces))
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.full(len(faces), smooth))
    mesh.update(calc_edges=True)
    mesh.materials.append(material(surface))
    place("mesh", mesh)


def add_ball(ball, many):
    if not ball.surface.emission:
        points, faces = scene_reader.icosphere(6)
        add_mesh(ball.center + ball.radius * points, faces, ball.surface, True)
        return
    if many:
        add_mesh(*scene_reader.shining(ball), ball.surface, False)
        return
    light = bpy.data.lights.new("ball", "POINT")
    strength = max(ball.surface.emission)
    light.color, light.shadow_soft_size = [x / strength for x in ball.surface.emission], ball.radius
    light.energy = strength * 4 * np.pi ** 2 * ball.radius ** 2
    light.use_soft_falloff = False
    matrix = np.eye(4)
    matrix[:3, 3] = ball.center
    place("ball", light, matrix).visible_camera = True


def add_sun(direction, irradiance):
    light = bpy.data.lights.new("sun", "SUN")
    light.angle, light.energy, light.color = 0, max(irradiance), [x / max(irradiance) for x in irradiance]
    place("sun", light, mathutils.Vector(direction).to_track_quat("-Z", "Y").to_matrix().to_4x4())


def set_sky(radiance):
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (*(radiance or (0, 0, 0)), 1), 1


def add_cloud(cloud, folder):
    # It lies among Blender's own packages.
    sys.path += [str(folder) for folder in pathlib.Path(bpy.utils.resource_path("LOCAL")).glob("python/lib/*/site-packages")]
    import openvdb
    grid = openvdb.FloatGrid()
    grid.copyFromArray(np.ascontiguousarray(cloud.grid.transpose(2, 1, 0)))
    low, high = cloud.corners
    cell = (high - low) / cloud.grid.shape[::-1]
    # A file's voxel i lies about (i + ½) cells from its origin, as Blender has it.
    grid.transform = openvdb.createLinearTransform([[cell[0], 0, 0, 0], [0, cell[1], 0, 0], [0, 0, cell[2], 0], [*low, 1]])
    grid.name = "density"
    openvdb.write(str(folder / "cloud.vdb"), grids=[grid])
    volume = bpy.data.volumes.new("cloud")
    volume.filepath = str(folder / "cloud.vdb")
    made = bpy.data.materials.new("cloud")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    inside = node(tree, "ShaderNodeVolumePrincipled", Color=(cloud.albedo,) * 3, Density=cloud.scale, Anisotropy=cloud.g)
    inside.inputs["Density Attribute"].default_value = "density"
    tree.links.new(inside.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    volume.materials.append(made)
    place("cloud", volume)


class Cycles:
    version = bpy.app.version_string

    def __init__(self, path, depth, size, *also):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=pathlib.Path(path).parent))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        settings(self.scene, int(size), int(depth), "guiding" in also)
        self.open_gltf(path) if path.endswith(".glb") else self.open_xml(path, int(depth))
        bpy.app.handlers.render_stats.append(self.told)

    def open_gltf(self, path):
        """What Blender makes of it; the picture is as high as the file's camera has it, and no light comes from elsewhere."""
        bpy.ops.import_scene.gltf(filepath=path)
        self.scene.camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
        self.scene.render.resolution_y = round(self.scene.render.resolution_x * 9 / 16)
        set_sky(None)

    def open_xml(self, path, depth):
        read = scene_reader.read(path, depth)
        camera = bpy.data.cameras.new("camera")
        camera.angle, camera.clip_start, camera.clip_end = np.radians(read.fov), 1e-3, 1e3
        self.scene.camera = place("camera", camera, read.camera @ np.diag([-1, 1, -1, 1]))
        set_sky(read.sky)
        for mesh in read.meshes:
            add_mesh(mesh.points, mesh.faces, mesh.surface, False)
        for ball in read.balls:
            add_ball(ball, len(read.balls) > 16)
        for sun in read.suns:
            add_sun(*sun)
        if read.cloud:
            add_cloud(read.cloud, self.folder)

    def told(self, text, *_):
        """Copying the scene and building trees, anew for each render, comes before the first sample."""
        if self.began is None and "Sample" in str(text):
            self.began = peer_process.core_seconds()

    def render(self, samples, seed):
        out = self.folder / "picture.exr"
        self.scene.cycles.samples, self.scene.cycles.seed, self.scene.render.filepath = samples, seed, str(out)
        self.began = None
        bpy.ops.render.render(write_still=True)
        spent = peer_process.core_seconds() - self.began
        picture = bpy.data.images.load(str(out))
        values = np.empty(len(picture.pixels), np.float32)
        picture.pixels.foreach_get(values)
        width, height = picture.size
        bpy.data.images.remove(picture)
        return values.reshape(height, width, 4)[::-1], spent, samples


peer_process.serve(Cycles, *sys.argv[1:])
