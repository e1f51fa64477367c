"""Materials: parameters of UsdPreviewSurface, OpenPBR and the standard surface, and networks of nodes."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from support import LOOKING_DOWN, StageTest

from abbe import usd

FLOOR = """
    def Mesh "floor" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
        float[] primvars:wear = [0, 0.25, 0.5, 0.75] (interpolation = "vertex")
        uniform token subdivisionScheme = "none"
        rel material:binding = </World/M>
    }
    def DomeLight "sky" { }
"""
DARK = "def DomeLight"  # replaced where a surface is seen by its own light


def material(shader: str, nodes: str = "", context: str = "", more: str = "") -> str:
    output = f"outputs:{context}surface"
    return f"""
    def Material "M" {{
        token {output}.connect = </World/M/s.outputs:surface>
        {more}
        def Shader "s" {{
            {shader}
            token outputs:surface
        }}
        {nodes}
    }}"""


def preview(inputs: str, nodes: str = "", more: str = "") -> str:
    text = material(f'uniform token info:id = "UsdPreviewSurface"\n{inputs}', nodes, "", more)
    return f'def Xform "World" {{\n{LOOKING_DOWN}{FLOOR}{text}\n}}\n'


def mtlx(kind: str, inputs: str, nodes: str = "") -> str:
    text = material(f'uniform token info:id = "ND_{kind}_surfaceshader"\n{inputs}', nodes, "mtlx:")
    return f'def Xform "World" {{\n{LOOKING_DOWN}{FLOOR}{text}\n}}\n'


def node(name: str, identifier: str, inputs: str, outputs: str = "color3f outputs:out") -> str:
    return f'def Shader "{name}" {{\n uniform token info:id = "{identifier}"\n{inputs}\n{outputs}\n }}\n'


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Rows × columns × 3 of bytes."""
    rows = b"".join(b"\0" + row.tobytes() for row in pixels.astype(np.uint8))

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


READER = node("st", "UsdPrimvarReader_float2", 'string inputs:varname = "st"', "float2 outputs:result")


class MaterialTest(StageTest):
    def block(self, scene: usd.Scene) -> str:
        """The material M without line ends."""
        text = scene.scene_text.split('material "World/M"', 1)[1].split("\n\n", 1)[0]
        return " ".join(text.split())

    def picture(self, name: str = "map.png", colour: tuple[int, int, int] = (188, 128, 64), size: int = 8) -> None:
        write_png(self.folder / name, np.tile(np.array(colour), (size, size, 1)))

    def has(self, scene: usd.Scene, *parts: str) -> None:
        block = self.block(scene)
        for part in parts:
            self.assertIn(part, block)


class Preview(MaterialTest):
    def test_parameters(self) -> None:
        scene = self.convert(
            preview("""
            color3f inputs:diffuseColor = (0.8, 0.1, 0.2)
            float inputs:metallic = 0.5
            float inputs:roughness = 0.25
            float inputs:ior = 1.4
            float inputs:clearcoat = 0.7
            float inputs:clearcoatRoughness = 0.2
        """)
        )
        self.has(scene, "openpbr", "base-color rgb 0.8 0.1 0.2", "base-metalness 0.5", "specular-roughness 0.25", "specular-ior 1.4",
                 "coat-weight 0.7", "coat-roughness 0.2", "coat-ior 1.5", "coat-darkening 0")  # fmt: skip
        self.assertEqual(scene.report.remarks, [])

    def test_defaults_are_those_of_the_specification(self) -> None:
        self.has(self.convert(preview("")), "base-color 0.18", "specular-roughness 0.5")

    def test_emission_is_in_nits(self) -> None:
        # A light of its own colour; the sky is taken away.
        text = preview("color3f inputs:emissiveColor = (4, 2, 1)\n color3f inputs:diffuseColor = (0, 0, 0)\n float inputs:ior = 1.0").replace(
            'def DomeLight "sky" { }', ""
        )
        self.convert(text)
        np.testing.assert_allclose(self.render(16)[4:12, 4:12].mean(axis=(0, 1)), [4, 2, 1], rtol=0.03)

    def test_specular_workflow(self) -> None:
        scene = self.convert(preview("int inputs:useSpecularWorkflow = 1\n color3f inputs:specularColor = (0.08, 0.04, 0.02)"))
        self.has(scene, "specular-weight 2", "specular-color rgb 1 0.5 0.25")
        self.remark(scene, "useSpecularWorkflow")

    def test_opacity(self) -> None:
        self.has(self.convert(preview("float inputs:opacity = 0.25")), "opacity 0.25")
        self.has(self.convert(preview("float inputs:opacity = 0.25\n float inputs:opacityThreshold = 0.5")), "opacity 0")
        self.assertNotIn("opacity", self.block(self.convert(preview("float inputs:opacity = 0.75\n float inputs:opacityThreshold = 0.5"))))
        # Through what is half there the floor's light is halved: black below it, radiance 1 of the sky on it.
        scene = self.convert(preview("float inputs:opacity = 0.5\n color3f inputs:emissiveColor = (1, 1, 1)"))
        self.remark(scene, "a surface with holes cannot emit")

    def test_textures(self) -> None:
        self.picture()
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n float2 inputs:st.connect = </World/M/st.outputs:result>\n token inputs:wrapS = "repeat"\n token inputs:wrapT = "repeat"\n token inputs:sourceColorSpace = "sRGB"',
            "float3 outputs:rgb\n float outputs:g",
        )
        scene = self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture + READER))
        self.has(scene, "space=srgb_rec709_scene")
        raw = texture.replace("sRGB", "raw")
        self.has(
            self.convert(preview("float inputs:roughness.connect = </World/M/t.outputs:g>", raw + READER)),
            "specular-roughness channel { take green; of image",
            "space=data",
        )

    def test_a_picture_shows_its_colour(self) -> None:
        # sRGB 188 is 0.503. Under an even sky of 1 a matte floor shows its colour; gloss of the index 1 is none.
        self.picture(colour=(188, 188, 188))
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n token inputs:sourceColorSpace = "sRGB"\n token inputs:wrapS = "repeat"\n token inputs:wrapT = "repeat"',
            "float3 outputs:rgb",
        )
        self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>\n float inputs:ior = 1.0", texture))
        np.testing.assert_allclose(self.render(64)[4:12, 4:12].mean(axis=(0, 1)), [0.503] * 3, rtol=0.01)

    def test_scale_and_bias(self) -> None:
        self.picture(colour=(128, 128, 128))
        text = 'asset inputs:file = @map.png@\n token inputs:sourceColorSpace = "raw"\n token inputs:wrapS = "repeat"\n token inputs:wrapT = "repeat"\n float4 inputs:scale = {}\n float4 inputs:bias = {}'
        for scale, bias in ((0.5, 0), (0.5, 0.25), (0.25, 0.5)):
            texture = node("t", "UsdUVTexture", text.format((scale,) * 4, (bias,) * 4), "float3 outputs:rgb")
            self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>\n float inputs:ior = 1.0", texture))
            expected = 128 / 255 * scale + bias
            np.testing.assert_allclose(self.render(64)[4:12, 4:12].mean(axis=(0, 1)), [expected] * 3, rtol=0.01)
        texture = node("t", "UsdUVTexture", text.format((-1.0,) * 4, (1.0,) * 4), "float outputs:r")
        self.has(self.convert(preview("float inputs:roughness.connect = </World/M/t.outputs:r>", texture)), "stop 0 1 stop 1 0")

    def test_wraps_transform_and_coordinates(self) -> None:
        self.picture()
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n float2 inputs:st.connect = </World/M/x.outputs:result>\n token inputs:wrapS = "mirror"\n token inputs:wrapT = "clamp"',
            "float3 outputs:rgb",
        )
        turned = node(
            "x",
            "UsdTransform2d",
            "float2 inputs:in.connect = </World/M/st.outputs:result>\n float2 inputs:scale = (4, 2)\n float inputs:rotation = 30\n float2 inputs:translation = (0.5, 0.25)",
            "float2 outputs:result",
        )
        scene = self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture + turned + READER))
        self.has(scene, "placed { map image", "wrap mirror", "scale 4 2 rotate 30 deg offset 0.5 0.25")
        self.remark(scene, "different wrap modes")

    def test_a_transform_moves_the_picture_as_usd_says(self) -> None:
        # Left half black, right half white; st · 0.5 + (0.5, 0) shows the right half alone.
        pixels = np.zeros((8, 8, 3))
        pixels[:, 4:] = 255
        write_png(self.folder / "map.png", pixels)
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n float2 inputs:st.connect = </World/M/x.outputs:result>\n token inputs:wrapS = "clamp"\n token inputs:wrapT = "clamp"',
            "float3 outputs:rgb",
        )
        turned = node(
            "x",
            "UsdTransform2d",
            "float2 inputs:in.connect = </World/M/st.outputs:result>\n float2 inputs:scale = (0.3, 1)\n float2 inputs:translation = (0.65, 0)",
            "float2 outputs:result",
        )
        self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>\n float inputs:ior = 1.0", texture + turned + READER))
        np.testing.assert_allclose(self.render(64)[4:12, 4:12].mean(axis=(0, 1)), [1] * 3, rtol=0.01)

    def test_udim(self) -> None:
        for tile in (1001, 1002):
            self.picture(f"wood.{tile}.png")
        texture = node("t", "UsdUVTexture", "asset inputs:file = @wood.<UDIM>.png@", "float3 outputs:rgb")
        self.has(self.convert(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture)), "wood.<UDIM>.png")

    def test_normal_map(self) -> None:
        self.picture(colour=(128, 128, 255))
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n float4 inputs:scale = (2, 2, 2, 1)\n float4 inputs:bias = (-1, -1, -1, 0)\n token inputs:sourceColorSpace = "raw"\n token inputs:wrapS = "repeat"\n token inputs:wrapT = "repeat"',
            "float3 outputs:rgb",
        )
        scene = self.convert(preview("normal3f inputs:normal.connect = </World/M/t.outputs:rgb>", texture))
        self.has(scene, "normal image", "space=data")
        self.assertEqual(scene.report.remarks, [])

    def test_displacement(self) -> None:
        self.picture(colour=(255, 255, 255))
        texture = node(
            "t",
            "UsdUVTexture",
            'asset inputs:file = @map.png@\n float4 inputs:scale = (0.5, 1, 1, 1)\n float4 inputs:bias = (-0.1, 0, 0, 0)\n token inputs:sourceColorSpace = "raw"\n token inputs:wrapS = "repeat"\n token inputs:wrapT = "repeat"',
            "float outputs:r",
        )
        more = "token outputs:displacement.connect = </World/M/s.outputs:displacement>"
        scene = self.convert(preview("float inputs:displacement.connect = </World/M/t.outputs:r>\n token outputs:displacement", texture, more))
        self.assertIn("scheme bilinear", scene.scene_text)
        # 0.5 · map - 0.1 = 0.5 · (map - 0.2)
        text = " ".join(scene.scene_text.split())
        self.assertIn("displacement 0.5 m", text)
        self.assertIn("midpoint 0.2", text)

    def test_primvars(self) -> None:
        reader = node("p", "UsdPrimvarReader_float", 'string inputs:varname = "wear"', "float outputs:result")
        scene = self.convert(preview("float inputs:roughness.connect = </World/M/p.outputs:result>", reader))
        self.has(scene, 'specular-roughness attribute "wear"')
        self.assertIn('attribute "wear" 0 0.25 0.5 0.75', " ".join(scene.scene_text.split()).replace("attribute wear", 'attribute "wear"'))

    def test_faults_of_networks(self) -> None:
        loop = node("a", "UsdTransform2d", "float2 inputs:in.connect = </World/M/b.outputs:result>", "float2 outputs:result")
        loop += node("b", "UsdTransform2d", "float2 inputs:in.connect = </World/M/a.outputs:result>", "float2 outputs:result")
        texture = node("t", "UsdUVTexture", "asset inputs:file = @{}@\n float2 inputs:st.connect = </World/M/a.outputs:result>", "float3 outputs:rgb")
        self.picture()
        errors = self.errors(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture.replace("{}", "map.png") + loop))
        self.assertIn("feeds itself", errors[0].what)
        errors = self.errors(preview("color3f inputs:diffuseColor.connect = </World/M/t.outputs:rgb>", texture.replace("{}", "mop.png")))
        self.assertEqual((errors[0].code, errors[0].path), ("E0401", "/World/M/t"))
        self.assertIn("map.png", errors[0].why)
        errors = self.errors(preview("float inputs:roughness = nan"))
        self.assertIn("not finite", errors[0].what)
        scene = self.convert(preview("").replace("UsdPreviewSurface", "MyShader"))
        self.assertIn("MyShader", self.remark(scene, "grey and matte").why)


class MaterialX(MaterialTest):
    def test_open_pbr(self) -> None:
        scene = self.convert(
            mtlx(
                "open_pbr_surface",
                """
            color3f inputs:base_color = (0.5, 0.25, 0.125)
            float inputs:base_metalness = 1
            color3f inputs:specular_color = (0.9, 0.8, 0.7)
            float inputs:specular_roughness = 0.1
            float inputs:coat_weight = 1
            float inputs:coat_ior = 1.3
            float inputs:fuzz_weight = 0.3
            float inputs:thin_film_weight = 1
            float inputs:thin_film_thickness = 0.4
        """,
            )
        )
        self.has(scene, "base-color rgb 0.5 0.25 0.125", "base-metalness 1", "specular-color rgb 0.9 0.8 0.7", "specular-roughness 0.1",
                 "coat-weight 1", "coat-ior 1.3", "fuzz-weight 0.3", "thin-film-thickness 400 nm")  # fmt: skip
        self.assertEqual(scene.report.remarks, [])

    def test_lengths_are_those_of_the_stage(self) -> None:
        inputs = "float inputs:transmission_weight = 1\n color3f inputs:transmission_color = (0.5, 0.9, 0.9)\n float inputs:transmission_depth = 3"
        self.has(
            self.convert(mtlx("open_pbr_surface", inputs)), "transmission-weight 1", "transmission-depth 3 m", "transmission-color rgb 0.5 0.9 0.9"
        )
        inputs = "float inputs:subsurface_weight = 1\n float inputs:subsurface_radius = 0.01\n color3f inputs:subsurface_radius_scale = (1, 0.4, 0.2)"
        self.has(self.convert(mtlx("open_pbr_surface", inputs), strict=False), "subsurface-radius 0.01 m", "subsurface-radius-scale rgb 1 0.4 0.2")

    def test_emission_of_open_pbr_is_in_nits(self) -> None:
        text = mtlx("open_pbr_surface", "float inputs:emission_luminance = 3\n color3f inputs:emission_color = (1, 0.5, 0.25)").replace(
            'def DomeLight "sky" { }', ""
        )
        self.convert(text)
        np.testing.assert_allclose(self.render(16)[4:12, 4:12].mean(axis=(0, 1)), [3, 1.5, 0.75], rtol=0.03)

    def test_standard_surface(self) -> None:
        scene = self.convert(
            mtlx(
                "standard_surface",
                """
            float inputs:base = 0.9
            color3f inputs:base_color = (0.5, 0.25, 0.125)
            float inputs:specular_IOR = 1.6
            float inputs:coat = 0.5
            float inputs:thin_film_thickness = 300
            color3f inputs:emission_color = (1, 0.5, 0.25)
            float inputs:emission = 2
        """,
            )
        )
        self.has(scene, "base-weight 0.9", "specular-roughness 0.2", "specular-ior 1.6", "coat-weight 0.5", "coat-roughness 0.1", "coat-ior 1.5",
                 "thin-film-thickness 300 nm", "emission-luminance 2 nits", "emission-color rgb 1 0.5 0.25")  # fmt: skip

    def shown(self, nodes: str, output: str = "n.outputs:out") -> np.ndarray:
        """What a matte floor of that colour shows under a sky of 1."""
        scene = self.convert(
            mtlx("open_pbr_surface", f"float inputs:specular_weight = 0\n color3f inputs:base_color.connect = </World/M/{output}>", nodes)
        )
        self.last = scene
        return self.render(64)

    def test_arithmetic_of_constants_and_pictures(self) -> None:
        self.picture(colour=(128, 128, 128))
        image = node("i", "ND_image_color3", 'asset inputs:file = @map.png@ (colorSpace = "raw")')
        g = 128 / 255
        cases = {
            ("ND_multiply_color3", "color3f inputs:in2 = (0.5, 0.5, 0.5)"): g * 0.5,
            ("ND_multiply_color3FA", "float inputs:in2 = 0.25"): g * 0.25,
            ("ND_divide_color3FA", "float inputs:in2 = 2"): g / 2,
        }
        for (kind, second), expected in cases.items():
            seen = self.shown(image + node("n", kind, f"color3f inputs:in1.connect = </World/M/i.outputs:out>\n{second}"))
            np.testing.assert_allclose(seen[4:12, 4:12].mean(axis=(0, 1)), [expected] * 3, rtol=0.01, err_msg=kind)
        constants = node("n", "ND_add_color3", "color3f inputs:in1 = (0.25, 0.25, 0.25)\n color3f inputs:in2 = (0.5, 0.5, 0.5)")
        np.testing.assert_allclose(self.shown(constants)[4:12, 4:12].mean(axis=(0, 1)), [0.75] * 3, rtol=0.01)
        mixed = node(
            "n", "ND_mix_color3", "color3f inputs:fg.connect = </World/M/i.outputs:out>\n color3f inputs:bg = (1, 1, 1)\n float inputs:mix = 0.25"
        )
        np.testing.assert_allclose(self.shown(image + mixed)[4:12, 4:12].mean(axis=(0, 1)), [0.75 + 0.25 * g] * 3, rtol=0.01)

    def test_numbers_of_pictures(self) -> None:
        self.picture(colour=(128, 64, 32))
        image = node("i", "ND_image_color3", 'asset inputs:file = @map.png@ (colorSpace = "raw")')
        green = node("e", "ND_extract_color3", "color3f inputs:in.connect = </World/M/i.outputs:out>\n int inputs:index = 1", "float outputs:out")
        for kind, inputs, expected in (
            ("ND_add_float", "float inputs:in2 = 0.25", 64 / 255 + 0.25),
            ("ND_subtract_float", "float inputs:in2 = 0.125", 64 / 255 - 0.125),
            ("ND_invert_float", "", 1 - 64 / 255),
            ("ND_power_float", "float inputs:in2 = 2", (64 / 255) ** 2),
            ("ND_remap_float", "float inputs:outlow = 0.5\n float inputs:outhigh = 1", 0.5 + 32 / 255),
            ("ND_clamp_float", "float inputs:low = 0.5", 0.5),
        ):
            first = "in" if kind in ("ND_invert_float", "ND_remap_float", "ND_clamp_float") else "in1"
            n = node("n", kind, f"float inputs:{first}.connect = </World/M/e.outputs:out>\n{inputs}", "float outputs:out")
            c = node("c", "ND_convert_float_color3", "float inputs:in.connect = </World/M/n.outputs:out>")
            seen = self.shown(image + green + n + c, "c.outputs:out")[4:12, 4:12].mean()
            self.assertAlmostEqual(float(seen), expected, delta=0.012, msg=kind)

    def test_tiled_image_and_place2d(self) -> None:
        self.picture()
        tiled = node(
            "n", "ND_tiledimage_color3", "asset inputs:file = @map.png@\n float2 inputs:uvtiling = (4, 3)\n float2 inputs:uvoffset = (0.5, 0)"
        )
        self.shown(tiled)
        self.assertIn("scale 4 3", self.last.scene_text)
        self.assertIn("offset -0.5 0", self.last.scene_text)
        place = node(
            "p",
            "ND_place2d_vector2",
            "float2 inputs:texcoord.connect = </World/M/t.outputs:out>\n float2 inputs:scale = (0.5, 0.25)\n float inputs:rotate = 30\n float2 inputs:offset = (0.1, 0.2)",
            "float2 outputs:out",
        )
        coords = node("t", "ND_texcoord_vector2", "", "float2 outputs:out")
        image = node("n", "ND_image_color3", "asset inputs:file = @map.png@\n float2 inputs:texcoord.connect = </World/M/p.outputs:out>")
        self.shown(image + place + coords)
        for part in ("scale 2 4", "rotate -30 deg", "offset -0.1 -0.2"):
            self.assertIn(part, self.last.scene_text)

    def test_ramps(self) -> None:
        ramp = node("n", "ND_ramplr_color3", "color3f inputs:valuel = (0, 0, 0)\n color3f inputs:valuer = (1, 1, 1)")
        seen = self.shown(ramp)[:, :, 1]
        # u grows from left to right: 16 pixels over 2 units.
        np.testing.assert_allclose(seen[4:12, 3].mean(), 3.5 / 16, atol=0.01)
        np.testing.assert_allclose(seen[4:12, 12].mean(), 12.5 / 16, atol=0.01)
        ramp = node("n", "ND_ramptb_color3", "color3f inputs:valuet = (1, 1, 1)\n color3f inputs:valueb = (0, 0, 0)")
        seen = self.shown(ramp)[:, :, 1]
        np.testing.assert_allclose(seen[3, 4:12].mean(), 1 - 3.5 / 16, atol=0.01)
        corners = node(
            "n",
            "ND_ramp4_color3",
            "color3f inputs:valuetl = (0, 0, 0)\n color3f inputs:valuetr = (1, 1, 1)\n color3f inputs:valuebl = (0, 0, 0)\n color3f inputs:valuebr = (0, 0, 0)",
        )
        self.assertAlmostEqual(float(self.shown(corners)[3, 12, 1]), (12.5 / 16) ** 2, delta=0.02)
        split = node(
            "n",
            "ND_splitlr_color3",
            "color3f inputs:valuel = (0.25, 0.25, 0.25)\n color3f inputs:valuer = (0.75, 0.75, 0.75)\n float inputs:center = 0.5",
        )
        seen = self.shown(split)[:, :, 1]
        np.testing.assert_allclose([seen[8, 3], seen[8, 12]], [0.25, 0.75], atol=0.01)

    def test_noise_and_normal_map(self) -> None:
        noise = node(
            "n", "ND_fractal3d_float", "float inputs:amplitude = 0.5\n int inputs:octaves = 5\n float inputs:lacunarity = 2.5", "float outputs:out"
        )
        scene = self.convert(mtlx("open_pbr_surface", "float inputs:specular_roughness.connect = </World/M/n.outputs:out>", noise))
        self.has(scene, "noise { scale 1.0 m; octaves 5; lacunarity 2.5")
        self.remark(scene, "another noise")
        self.picture(colour=(128, 128, 255))
        image = node("i", "ND_image_vector3", 'asset inputs:file = @map.png@ (colorSpace = "raw")', "float3 outputs:out")
        normal = node(
            "n", "ND_normalmap_float", "float3 inputs:in.connect = </World/M/i.outputs:out>\n float inputs:scale = 0.5", "float3 outputs:out"
        )
        scene = self.convert(mtlx("open_pbr_surface", "float3 inputs:geometry_normal.connect = </World/M/n.outputs:out>", image + normal))
        self.has(scene, "space=data strength=0.5")

    def test_unknown_nodes_are_named(self) -> None:
        other = node("n", "ND_sandstorm_color3", "color3f inputs:in = (0.25, 0.5, 0.75)")
        scene = self.convert(mtlx("open_pbr_surface", "color3f inputs:base_color.connect = </World/M/n.outputs:out>", other))
        remark = self.remark(scene, "ND_sandstorm_color3")
        self.assertEqual((remark.code, remark.path), ("W0801", "/World/M/n"))
        self.has(scene, "base-color rgb 0.25 0.5 0.75")

    def test_what_a_solid_cannot_be(self) -> None:
        scene = self.convert(mtlx("open_pbr_surface", "float inputs:transmission_weight = 0.5\n float inputs:subsurface_weight = 0.5"))
        self.remark(scene, "E0700")
