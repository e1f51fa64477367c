"""Small scenes of Mitsuba's, one construct each, for mitsuba_compare.py.

A case is a scene and how closely both programs must agree on it: statistically, but for a relative difference that they
may rightly have, with the reason.
"""
import struct
import zlib
from dataclasses import dataclass, field

SIZE = 64


@dataclass
class Case:
    name: str
    xml: str
    variant: str = "scalar_rgb"
    spp: int = 16  # of each of several independent renders
    tolerance: float = 0.004  # relative difference that they may have besides noise
    reason: str = ""  # why, where it is more than rounding
    nightly: bool = False
    size: tuple = (SIZE, SIZE)
    floor: float = 0.0  # absolute difference, in units of the picture's mean


CASES = []


def sensor(extra="", kind="perspective", origin="0, 0, 5", target="0, 0, 0", up="0, 1, 0", film="", fov=40, spp=16,
           filter_="box"):
    fov_text = f'<float name="fov" value="{fov}"/>' if kind in ("perspective", "thinlens") and fov else ""
    return f"""<sensor type="{kind}">{fov_text}
  <transform name="to_world"><lookat origin="{origin}" target="{target}" up="{up}"/></transform>{extra}
  <film type="hdrfilm"><integer name="width" value="{SIZE}"/><integer name="height" value="{SIZE}"/>{film}
    <rfilter type="{filter_}"/></film>
  <sampler type="independent"><integer name="sample_count" value="{spp}"/></sampler></sensor>"""


SKY = '<emitter type="constant"><rgb name="radiance" value="0.6"/></emitter>'
# A lamp from the side, so that pictures are not symmetric.
LAMP = """<shape type="sphere"><point name="center" x="3" y="4" z="4"/><float name="radius" value="1"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
  <emitter type="area"><rgb name="radiance" value="12"/></emitter></shape>"""
FLOOR = """<shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/>
  <translate y="-1"/></transform><bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.4"/></bsdf></bsdf></shape>"""
BALL = '<shape type="sphere"><float name="radius" value="1"/>%s</shape>'


def scene(body, lens=None, integrator="path", depth=5, options="", version="3.0.0"):
    return f"""<scene version="{version}">
<integrator type="{integrator}"><integer name="max_depth" value="{depth}"/>{options}</integrator>
{lens or sensor()}
{body}
</scene>
"""


def case(name, body, lens=None, integrator="path", depth=5, options="", version="3.0.0", **settings):
    CASES.append(Case(name, scene(body, lens, integrator, depth, options, version), **settings))


def lit_ball(bsdf):
    return SKY + LAMP + FLOOR + BALL % bsdf


def bsdf(name, text, **settings):
    case("bsdf-" + name, lit_ball(text), **settings)


# ---- shapes and cameras
case("sphere", lit_ball('<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>'))
case("sphere-center", SKY + LAMP + '<shape type="sphere"><point name="center" value="0.5, 0.3, -1"/><float name="radius" value="0.8"/>'
     '<transform name="to_world"><scale value="1.2"/><rotate y="1" angle="20"/><translate x="-0.4"/></transform></shape>')
case("rectangle", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="30"/><scale x="1.5" y="0.8"/></transform></shape>')
case("rectangle-behind", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="150"/></transform></shape>')
case("cube", SKY + LAMP + '<shape type="cube"><transform name="to_world"><rotate x="1" y="1" angle="35"/><scale value="0.8"/></transform></shape>')
case("disk", SKY + LAMP + '<shape type="disk"><transform name="to_world"><rotate y="1" angle="-30"/><scale value="1.4"/></transform></shape>')
case("cylinder", SKY + LAMP + '<shape type="cylinder"><point name="p0" value="-1, -1, 0"/><point name="p1" value="1, 0.8, 0.4"/><float name="radius" value="0.5"/>'
     '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>')
case("cylinder-inside", SKY + LAMP + '<shape type="cylinder"><point name="p0" value="-0.5, 0, -1"/><point name="p1" value="0, 0, 1"/><float name="radius" value="1"/></shape>')
for axis in ("x", "y", "diagonal", "smaller", "larger"):
    case("fov-" + axis, lit_ball(""), sensor(f'<string name="fov_axis" value="{axis}"/>').replace(
        f'<integer name="height" value="{SIZE}"/>', '<integer name="height" value="32"/>'), size=(64, 32))
case("focal-length", lit_ball(""), sensor('<string name="focal_length" value="35mm"/>', fov=0))
case("camera-roll", lit_ball(""), sensor(origin="2, 3, 4", target="0.2, 0, 0", up="0.3, 1, 0.1"))
case("camera-matrix", lit_ball(""), sensor().replace('<lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/>',
     '<rotate y="1" angle="180"/><translate z="5"/>'))
case("camera-mirrored", lit_ball(""), sensor().replace('<lookat', '<scale x="-1"/><lookat'))
case("crop", lit_ball(""), sensor(film='<integer name="crop_offset_x" value="10"/><integer name="crop_offset_y" value="20"/>'
     '<integer name="crop_width" value="32"/><integer name="crop_height" value="24"/>'), size=(32, 24))
case("principal-point", lit_ball(""), sensor('<float name="principal_point_offset_x" value="0.15"/><float name="principal_point_offset_y" value="0.1"/>'))
case("thinlens", lit_ball(""), sensor('<float name="aperture_radius" value="0.3"/><float name="focus_distance" value="3.5"/>', "thinlens"))
case("orthographic", lit_ball(""), sensor(kind="orthographic").replace("<lookat", '<scale x="2" y="2"/><lookat'))
case("filter-gaussian", SKY + LAMP + FLOOR, sensor(filter_="gaussian"), tolerance=0.01, reason="tails beyond 3 sigma")
case("filter-tent", SKY + LAMP + FLOOR, sensor(filter_="tent"), tolerance=0.01, reason="pixels share samples in Mitsuba")

# ---- emitters
GREY = FLOOR + BALL % ""
case("constant", SKY + GREY)
case("area-sphere", LAMP + GREY)
case("area-rectangle", '<shape type="rectangle"><transform name="to_world"><scale value="0.7"/><rotate x="1" angle="90"/><translate x="0.4" y="2" z="0.6"/></transform>'
     '<emitter type="area"><rgb name="radiance" value="6"/></emitter></shape>' + GREY)
case("area-seen", '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="30"/></transform><emitter type="area"><rgb name="radiance" value="1, 0.5, 0.25"/></emitter></shape>')
case("area-behind", '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="150"/></transform><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>' + SKY)
case("area-disk", '<shape type="disk"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="90"/><translate x="-0.5" y="2"/></transform>'
     '<emitter type="area"><rgb name="radiance" value="8"/></emitter></shape>' + GREY)
case("area-cube", '<shape type="cube"><transform name="to_world"><scale value="0.3"/><translate x="1.4" y="1.6" z="0.5"/></transform><emitter type="area"><rgb name="radiance" value="8"/></emitter></shape>' + GREY)
case("area-cylinder", '<shape type="cylinder"><point name="p0" value="-1.5, 1.5, 0"/><point name="p1" value="1.5, 1.8, 0"/><float name="radius" value="0.2"/>'
     '<emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>' + GREY)
case("point", '<emitter type="point"><point name="position" value="2, 3, 2"/><rgb name="intensity" value="20"/></emitter>' + GREY)
case("point-transform", '<emitter type="point"><transform name="to_world"><translate x="-2" y="3" z="2"/></transform><rgb name="intensity" value="20, 10, 5"/></emitter>' + GREY, tolerance=0.01, reason="the red light of RGB meets grey alone, but is a spectrum here")
case("spot", '<emitter type="spot"><transform name="to_world"><lookat origin="1, 3, 3" target="0, 0, 0" up="0, 1, 0"/></transform><rgb name="intensity" value="30"/>'
     '<float name="cutoff_angle" value="15"/><float name="beam_width" value="14.999"/></emitter>' + GREY)
case("spot-soft", '<emitter type="spot"><transform name="to_world"><lookat origin="1, 3, 3" target="0, 0, 0" up="0, 1, 0"/></transform><rgb name="intensity" value="30"/>'
     '<float name="cutoff_angle" value="20"/></emitter>' + GREY, tolerance=0.25, floor=0.3, reason="another falloff at the edge")
case("directional", '<emitter type="directional"><vector name="direction" value="-1, -2, -1"/><rgb name="irradiance" value="2"/></emitter>' + GREY)
case("directional-transform", '<emitter type="directional"><transform name="to_world"><lookat origin="2, 3, 1" target="0, 0, 0" up="0, 1, 0"/></transform><rgb name="irradiance" value="2"/></emitter>' + GREY)
case("envmap", '<emitter type="envmap"><string name="filename" value="env.exr"/></emitter>' + BALL % '<bsdf type="conductor"/>' + FLOOR, tolerance=0.01, floor=0.01, reason="images are interpolated smoothly")
case("envmap-turned", '<emitter type="envmap"><string name="filename" value="env.exr"/><float name="scale" value="1.7"/><transform name="to_world"><rotate x="1" angle="30"/><rotate y="1" angle="70"/></transform></emitter>' + BALL % "", tolerance=0.01, floor=0.01, reason="images are interpolated smoothly")
case("hide-emitters", SKY + '<shape type="sphere"><point name="center" x="1.3" y="0.9" z="1"/><float name="radius" value="0.3"/><emitter type="area"><rgb name="radiance" value="9"/></emitter></shape>' + GREY,
     options='<boolean name="hide_emitters" value="true"/>')
case("area-texture", '<shape type="rectangle"><emitter type="area"><texture type="bitmap" name="radiance"><string name="filename" value="picture.exr"/><boolean name="raw" value="false"/></texture></emitter></shape>',
     tolerance=0.02, floor=0.02, reason="images are interpolated smoothly")

# ---- BSDFs
bsdf("diffuse", '<bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf>')
bsdf("mirror", '<bsdf type="conductor"/>')
bsdf("conductor-eta", '<bsdf type="conductor"><rgb name="eta" value="0.5"/><rgb name="k" value="2.5"/></bsdf>')
bsdf("conductor-tint", '<bsdf type="conductor"><rgb name="specular_reflectance" value="0.6"/></bsdf>')
ROUGH = '<string name="distribution" value="ggx"/><float name="alpha" value="%s"/>'
LOSS = "Mitsuba loses the light that is scattered more than once between facets"
bsdf("roughconductor", f'<bsdf type="roughconductor">{ROUGH % 0.1}</bsdf>', tolerance=0.03, reason=LOSS)
bsdf("roughconductor-wide", f'<bsdf type="roughconductor">{ROUGH % 0.3}</bsdf>', tolerance=0.17, reason=LOSS)
bsdf("roughconductor-beckmann", '<bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>', tolerance=0.25, reason="another distribution")
STRETCHED = '<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="%s"/><float name="alpha_v" value="%s"/></bsdf>'
TUBE = '<shape type="cylinder"><point name="p0" value="-1, -0.4, 0"/><point name="p1" value="1, 0.4, 0.2"/><float name="radius" value="0.7"/>%s</shape>'
case("roughconductor-stretched", SKY + LAMP + FLOOR + TUBE % (STRETCHED % (0.2, 0.05)), tolerance=0.08, reason=LOSS)
case("roughconductor-stretched-rectangle", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><rotate z="1" angle="30"/><rotate x="1" angle="-50"/></transform>%s</shape>' % (STRETCHED % (0.2, 0.05)), tolerance=0.08, reason=LOSS)
bsdf("conductor-gold", '<bsdf type="conductor"><string name="material" value="Au"/></bsdf>', variant="scalar_spectral", tolerance=0.06, floor=0.03, reason="another measurement of gold")
bsdf("dielectric", '<bsdf type="dielectric"/>', depth=12)
bsdf("dielectric-water", '<bsdf type="dielectric"><string name="int_ior" value="water"/><string name="ext_ior" value="air"/></bsdf>', depth=12)
bsdf("dielectric-diamond", '<bsdf type="dielectric"><float name="int_ior" value="2.4"/></bsdf>', depth=16, spp=32)
bsdf("dielectric-below", '<bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1.33"/></bsdf>', depth=12)
bsdf("thindielectric", '<bsdf type="thindielectric"/>', depth=12)
bsdf("roughdielectric", f'<bsdf type="roughdielectric">{ROUGH % 0.1}</bsdf>', depth=12, tolerance=0.04, reason=LOSS, spp=32)
bsdf("plastic", '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.5"/></bsdf>', tolerance=0.09, reason="the base does not depend on the direction of light")
bsdf("plastic-nonlinear", '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.5"/><boolean name="nonlinear" value="true"/></bsdf>', tolerance=0.09, reason="the base does not depend on the direction of light")
bsdf("roughplastic", f'<bsdf type="roughplastic">{ROUGH % 0.1}<rgb name="diffuse_reflectance" value="0.5"/></bsdf>', tolerance=0.09, reason="the base does not depend on the direction of light")
case("plastic-furnace", SKY + BALL % '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.5"/></bsdf>')
case("plastic-nonlinear-furnace", SKY + BALL % '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.5"/><boolean name="nonlinear" value="true"/></bsdf>')
bsdf("twosided", '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf></bsdf>')
case("twosided-two", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="150"/></transform><bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf><bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf></bsdf></shape>')
bsdf("blend", '<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf><bsdf type="conductor"/></bsdf>')
bsdf("mask", '<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf></bsdf></bsdf>', depth=9)
case("mask-one-sided", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="150"/></transform><bsdf type="mask"><float name="opacity" value="0.6"/><bsdf type="diffuse"/></bsdf></shape>', depth=9)
bsdf("null", '<bsdf type="null"/>', integrator="volpath")
bsdf("principled", '<bsdf type="principled"><rgb name="base_color" value="0.5"/><float name="roughness" value="0.5"/></bsdf>', tolerance=0.25, reason="OpenPBR in place of the principled BSDF")
bsdf("principled-metal", '<bsdf type="principled"><rgb name="base_color" value="0.8"/><float name="roughness" value="0.3"/><float name="metallic" value="1"/></bsdf>', tolerance=0.1, reason="OpenPBR in place of the principled BSDF")
bsdf("principled-glass", '<bsdf type="principled"><rgb name="base_color" value="1"/><float name="roughness" value="0.3"/><float name="spec_trans" value="1"/><float name="eta" value="1.5"/></bsdf>', depth=12, tolerance=0.25, reason="OpenPBR in place of the principled BSDF", nightly=True)
STRANDS = '<shape type="bsplinecurve"><string name="filename" value="strands.txt"/>%s</shape>'
HAIR = '<bsdf type="hair">%s</bsdf>'
ABSORBING = '<rgb name="sigma_a" value="%s"/>'
for measured_file in ("even", "brushed"):
    case(f"measured-{measured_file}", SKY + LAMP + FLOOR + BALL % f'<bsdf type="measured"><string name="filename" value="{measured_file}.bsdf"/></bsdf>', variant="scalar_spectral", spp=64)
case("hair-sigma", SKY + LAMP + STRANDS % (HAIR % (ABSORBING % 0.4)), depth=20, spp=64)
case("hair-rough", SKY + LAMP + STRANDS % (HAIR % (ABSORBING % 0.2 + '<float name="longitudinal_roughness" value="0.15"/><float name="azimuthal_roughness" value="0.5"/><float name="scale_tilt" value="4"/><float name="scale" value="2"/>')), depth=20, spp=64, tolerance=0.01, reason="round ends of strands")
case("hair-pigments", SKY + LAMP + STRANDS % (HAIR % '<float name="eumelanin" value="0.5"/><float name="pheomelanin" value="0.1"/>'), depth=20, tolerance=0.02, reason="other constants for pigments")
case("hair-brown", SKY + LAMP + STRANDS % (HAIR % ""), depth=20, tolerance=0.02, reason="other constants for pigments")
THIN = '<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="%s"/></transform><bsdf type="principledthin"><rgb name="base_color" value="0.6"/>%s</bsdf></shape>'
case("principledthin", SKY + LAMP + THIN % (30, ""), tolerance=0.03, reason="matte sheets send more light back at grazing angles there")
case("principledthin-passes", SKY + LAMP + THIN % (30, '<float name="diff_trans" value="1.4"/>'), tolerance=0.03, reason="matte sheets send more light back at grazing angles there")
case("principledthin-behind", SKY + LAMP + THIN % (150, '<float name="diff_trans" value="0.6"/><float name="roughness" value="0.8"/>'), tolerance=0.04, reason="matte sheets send more light back at grazing angles there")
case("principledthin-glass", SKY + LAMP + FLOOR + THIN % (30, '<float name="spec_trans" value="1"/><float name="roughness" value="0.3"/>'), depth=12, tolerance=0.06, reason="OpenPBR in place of the principled BSDF")
for filter_name in ("polarizer", "retarder", "circular"):
    case(filter_name, LAMP + SKY + '<shape type="rectangle"><bsdf type="%s"/></shape>' % filter_name)
bsdf("pplastic", '<bsdf type="pplastic"><rgb name="diffuse_reflectance" value="0.5"/><string name="distribution" value="ggx"/></bsdf>', tolerance=0.11, reason="the base does not depend on the direction of light")
SUNNY = '<emitter type="sunsky"><vector name="sun_direction" value="%s"/><float name="turbidity" value="%s"/>%s<transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>'
GROUND = '<shape type="rectangle"><transform name="to_world"><scale value="1000"/><rotate x="1" angle="-90"/><translate y="-1"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.3"/></bsdf></shape>'
DAY = dict(variant="scalar_spectral", spp=32)
AIR_MODEL = dict(tolerance=0.5, reason="another model of the air, darker at the horizon", **DAY)
case("sunsky-sky", SUNNY % ("0.3, 0.7, 0.4", 3, '<float name="sun_scale" value="0"/>') + GROUND + BALL % "", depth=3, **AIR_MODEL)
case("sunsky-hazy", SUNNY % ("0.3, 0.7, 0.4", 6, '<float name="sun_scale" value="0"/>') + GROUND + BALL % "", depth=3, **AIR_MODEL)
case("sunsky-sun", SUNNY % ("0.3, 0.7, 0.4", 3, '<float name="sky_scale" value="0"/>') + GROUND + BALL % "", depth=3, tolerance=0.07, reason="a black body through air in place of a table", **DAY)
case("sunsky", SUNNY % ("0.3, 0.7, 0.4", 3, "") + GROUND + BALL % "", depth=3, **AIR_MODEL)
PROJECTOR = '<emitter type="projector"><float name="fov" value="40"/><transform name="to_world"><lookat origin="1, 2, 4" target="0, 0, 0" up="0, 1, 0"/></transform>%s</emitter>'
case("projector", PROJECTOR % '<texture type="bitmap" name="irradiance"><string name="filename" value="picture.exr"/></texture><float name="scale" value="5"/>' + FLOOR + BALL % "", floor=0.03, tolerance=0.02, reason="steps of half a degree")
case("projector-even", PROJECTOR % '<rgb name="irradiance" value="4"/>' + FLOOR + BALL % "", floor=0.03, tolerance=0.02, reason="steps of half a degree")
bsdf("volume-texture", '<bsdf type="diffuse"><texture type="volume" name="reflectance"><volume type="constvolume" name="volume"><rgb name="value" value="0.3"/></volume></texture></bsdf>')
bsdf("reference", '<ref id="later"/>')
CASES[-1].xml = CASES[-1].xml.replace("</scene>", '<bsdf type="diffuse" id="later"><rgb name="reflectance" value="0.15"/></bsdf></scene>')

# ---- textures
PICTURE = '<texture type="bitmap" name="%s"><string name="filename" value="picture.exr"/><string name="filter_type" value="bilinear"/>%s</texture>'
SMOOTH = dict(tolerance=0.02, floor=0.03, reason="images are interpolated smoothly")
TEXTURED = '<bsdf type="twosided"><bsdf type="diffuse">%s</bsdf></bsdf>' % (PICTURE % ("reflectance", ""))
case("bitmap-rectangle", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform>%s</shape>' % TEXTURED, **SMOOTH)
case("bitmap-sphere", SKY + LAMP + BALL % TEXTURED, **SMOOTH)
case("bitmap-cube", SKY + LAMP + '<shape type="cube"><transform name="to_world"><rotate x="1" y="1" angle="35"/></transform>%s</shape>' % TEXTURED, **SMOOTH)
case("bitmap-disk", SKY + LAMP + '<shape type="disk"><transform name="to_world"><scale value="1.5"/></transform>%s</shape>' % TEXTURED, **SMOOTH)
case("bitmap-cylinder", SKY + LAMP + '<shape type="cylinder"><point name="p0" value="0, -1, 0"/><point name="p1" value="0, 1, 0"/><float name="radius" value="1"/>%s</shape>' % TEXTURED, **SMOOTH)
case("bitmap-cylinder-slanted", SKY + LAMP + '<shape type="cylinder"><point name="p0" value="-1, -1, 0.3"/><point name="p1" value="1, 0.5, 0"/><float name="radius" value="0.8"/>%s</shape>' % TEXTURED, **SMOOTH)
case("to-uv", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform><bsdf type="diffuse">%s</bsdf></shape>' % (PICTURE % ("reflectance", '<transform name="to_uv"><scale x="2" y="3"/><translate x="0.25" y="0.1"/></transform>')), tolerance=0.03, floor=0.06, reason="images are interpolated smoothly")
case("checker", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.8"/><rgb name="color1" value="0.1"/></texture></bsdf></shape>', floor=0.03, tolerance=0.02, reason="edges between squares are filtered")
case("checker-to-uv", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.8"/><rgb name="color1" value="0.1"/><transform name="to_uv"><scale x="3" y="2"/></transform></texture></bsdf></shape>', floor=0.03, tolerance=0.02, reason="edges between squares are filtered")
case("mask-texture", SKY + LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.2"/></transform><bsdf type="mask"><texture type="checkerboard" name="opacity"><float name="color0" value="1"/><float name="color1" value="0"/></texture><bsdf type="diffuse"/></bsdf></shape>', depth=9, floor=0.03, tolerance=0.02, reason="edges between squares are filtered")
case("blend-texture", SKY + LAMP + '<shape type="rectangle"><bsdf type="blendbsdf"><texture type="checkerboard" name="weight"><float name="color0" value="1"/><float name="color1" value="0"/></texture><bsdf type="diffuse"><rgb name="reflectance" value="0.9"/></bsdf><bsdf type="diffuse"><rgb name="reflectance" value="0.1"/></bsdf></bsdf></shape>', floor=0.03, tolerance=0.02, reason="edges between squares are filtered")
case("bumpmap", LAMP + '<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform><bsdf type="bumpmap"><texture type="bitmap" name="arbitrary"><boolean name="raw" value="true"/><string name="filename" value="bumps.exr"/></texture><float name="scale" value="0.3"/><bsdf type="diffuse"/></bsdf></shape>', tolerance=0.05, floor=0.05, reason="slopes of another interpolation")
case("normalmap", SKY + LAMP + '<shape type="sphere"><bsdf type="normalmap"><texture type="bitmap" name="normalmap"><boolean name="raw" value="true"/><string name="filename" value="normals.exr"/></texture><bsdf type="diffuse"/></bsdf></shape>', tolerance=0.03, floor=0.03, reason="images are interpolated smoothly")
case("mesh-attribute", SKY + LAMP + '<shape type="ply"><string name="filename" value="colors.ply"/><bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance"><string name="name" value="vertex_color"/></texture></bsdf></shape>', tolerance=0.02, reason="colours become spectra")

# ---- meshes
case("ply", SKY + LAMP + '<shape type="ply"><string name="filename" value="hill.ply"/></shape>', floor=0.005)
case("ply-face-normals", SKY + LAMP + '<shape type="ply"><string name="filename" value="hill.ply"/><boolean name="face_normals" value="true"/></shape>')
case("ply-flipped", SKY + LAMP + '<shape type="ply"><string name="filename" value="hill.ply"/><boolean name="flip_normals" value="true"/></shape>')
case("ply-texture", SKY + LAMP + '<shape type="ply"><string name="filename" value="hill.ply"/><bsdf type="diffuse">%s</bsdf></shape>' % (PICTURE % ("reflectance", "")), **SMOOTH)
case("obj", SKY + LAMP + '<shape type="obj"><string name="filename" value="hill.obj"/><transform name="to_world"><rotate z="1" angle="20"/></transform></shape>', floor=0.005)
case("obj-texture", SKY + LAMP + '<shape type="obj"><string name="filename" value="hill.obj"/><bsdf type="diffuse">%s</bsdf></shape>' % (PICTURE % ("reflectance", "")), **SMOOTH)
case("serialized", SKY + LAMP + '<shape type="serialized"><string name="filename" value="hill.serialized"/><integer name="shape_index" value="0"/></shape>', floor=0.005)
case("mesh-light", '<shape type="ply"><string name="filename" value="hill.ply"/><transform name="to_world"><scale value="0.4"/><translate x="1.2" y="0.4" z="-1.5"/></transform><emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>' + GREY)
case("instances", SKY + LAMP + '<shape type="shapegroup" id="g"><shape type="sphere"><float name="radius" value="0.4"/></shape><shape type="cube"><transform name="to_world"><scale value="0.2"/><translate y="0.6"/></transform></shape></shape>'
     + "".join(f'<shape type="instance"><ref id="g"/><transform name="to_world"><rotate z="1" angle="{30 * i}"/><translate x="{i - 1}"/></transform></shape>' for i in range(3)))
case("bsplinecurve", SKY + LAMP + '<shape type="bsplinecurve"><string name="filename" value="strands.txt"/><bsdf type="diffuse"/></shape>', floor=0.02, tolerance=0.02, reason="open ends, one-sidedness")
case("linearcurve", SKY + LAMP + '<shape type="linearcurve"><string name="filename" value="strands.txt"/><bsdf type="diffuse"/></shape>', floor=0.05, tolerance=0.03, reason="round ends")

# ---- media
MEDIUM = '<shape type="cube"><transform name="to_world"><scale value="0.9"/><rotate y="1" angle="30"/></transform><bsdf type="null"/><medium type="homogeneous" name="interior">%s</medium></shape>'


def medium(name, text, **settings):
    case("medium-" + name, SKY + LAMP + FLOOR + MEDIUM % text, integrator="volpath", depth=settings.pop("depth", 40), spp=12, **settings)


medium("absorbing", '<rgb name="sigma_t" value="1"/><rgb name="albedo" value="0"/>')
medium("isotropic", '<rgb name="sigma_t" value="1"/><rgb name="albedo" value="0.8"/>')
medium("scale", '<rgb name="sigma_t" value="0.5"/><float name="scale" value="4"/><rgb name="albedo" value="0.9"/>')
medium("hg", '<float name="sigma_t" value="1.5"/><rgb name="albedo" value="0.9"/><phase type="hg"><float name="g" value="0.7"/></phase>')
medium("rayleigh", '<float name="sigma_t" value="1.5"/><rgb name="albedo" value="0.9"/><phase type="rayleigh"/>')
medium("tabphase", '<float name="sigma_t" value="1.5"/><rgb name="albedo" value="0.9"/><phase type="tabphase"><string name="values" value="0.1, 0.2, 0.5, 1, 3"/></phase>')
medium("blendphase", '<float name="sigma_t" value="1.5"/><rgb name="albedo" value="0.9"/><phase type="blendphase"><float name="weight" value="0.3"/><phase type="hg"><float name="g" value="0.7"/></phase><phase type="isotropic"/></phase>')
case("medium-glass", SKY + LAMP + FLOOR + BALL % '<bsdf type="dielectric"/><medium type="homogeneous" name="interior"><rgb name="sigma_t" value="0.7"/><rgb name="albedo" value="0.5"/></medium>', integrator="volpath", depth=40)
case("medium-constvolume", SKY + LAMP + BALL % '<bsdf type="null"/><medium type="heterogeneous" name="interior"><volume type="constvolume" name="sigma_t"><float name="value" value="1"/><transform name="to_world"><scale value="2"/><translate x="-1" y="-1" z="-1"/></transform></volume><volume type="constvolume" name="albedo"><rgb name="value" value="0.8"/></volume></medium>', integrator="volpath", depth=40)

AIR = '<medium type="homogeneous" id="air"><rgb name="sigma_t" value="0.08"/><rgb name="albedo" value="0.8"/></medium>'
case("medium-air", LAMP + FLOOR + BALL % '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf><ref name="exterior" id="air"/>', lens=sensor(AIR), integrator="volpath", depth=40, spp=32)

# The camera stands in a box of fog, with a ball in it, and a surface that has the fog on both sides.
FOG = '<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.1, 0.15, 0.2"/><rgb name="albedo" value="0.7"/></medium>'
ROOM = '<shape type="cube"><transform name="to_world"><scale value="6"/></transform><bsdf type="null"/><ref name="interior" id="fog"/></shape>'
WITHIN = '<shape type="sphere"><point name="center" x="-0.5" y="0.5" z="2"/><float name="radius" value="0.6"/><bsdf type="null"/><ref name="interior" id="fog"/><ref name="exterior" id="fog"/></shape>'
MATTE = BALL % '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf><ref name="exterior" id="fog"/>'
case("medium-around-camera", FOG + SKY + LAMP + FLOOR + ROOM + MATTE + WITHIN, lens=sensor('<ref id="fog"/>'), integrator="volpath", depth=40, spp=24)

GRID = '<medium type="heterogeneous" name="interior"><volume type="gridvolume" name="sigma_t"><string name="filename" value="puff.vol"/>%s</volume><rgb name="albedo" value="0.8"/><float name="scale" value="3"/></medium>'
case("medium-grid", SKY + LAMP + FLOOR + '<shape type="cube"><transform name="to_world"><scale value="0.9"/></transform><bsdf type="null"/>%s</shape>' % (GRID % '<transform name="to_world"><scale value="1.8"/><translate x="-0.9" y="-0.9" z="-0.9"/></transform>'),
     integrator="volpath", depth=40, spp=8, tolerance=0.01, reason="voxels end half a voxel later")

# ---- spectra
SPECTRAL = dict(variant="scalar_spectral", spp=24)
case("spectrum-uniform", '<emitter type="constant"><spectrum name="radiance" value="0.7"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-d65", '<emitter type="constant"><spectrum type="d65" name="radiance"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-blackbody", '<emitter type="constant"><spectrum type="blackbody" name="radiance"><float name="temperature" value="3200"/></spectrum></emitter>' + GREY, **SPECTRAL)
case("spectrum-rgb-light", '<emitter type="constant"><rgb name="radiance" value="0.9, 0.5, 0.2"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-inline", '<emitter type="constant"><spectrum name="radiance" value="400:0.2, 500:1, 600:0.6, 700:0.1"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-irregular", '<emitter type="constant"><spectrum type="irregular" name="radiance"><string name="wavelengths" value="420, 470, 580, 700"/><string name="values" value="0.2, 0.9, 0.7, 0.4"/></spectrum></emitter>' + GREY, **SPECTRAL)
case("spectrum-regular", '<emitter type="constant"><spectrum type="regular" name="radiance"><float name="wavelength_min" value="400"/><float name="wavelength_max" value="700"/><string name="values" value="0.2, 0.9, 0.7, 0.4"/></spectrum></emitter>' + GREY, **SPECTRAL)
case("spectrum-file", '<emitter type="constant"><spectrum name="radiance" filename="light.spd"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-point", '<emitter type="point"><point name="position" value="2, 3, 2"/><spectrum name="intensity" value="400:5, 500:20, 600:30, 700:10"/></emitter>' + GREY, **SPECTRAL)
case("spectrum-directional", '<emitter type="directional"><vector name="direction" value="-1, -2, -1"/><spectrum type="blackbody" name="irradiance"><float name="temperature" value="1500"/></spectrum></emitter>' + GREY, **SPECTRAL)
case("spectrum-reflectance", SKY + BALL % '<bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 500:0.2, 600:0.8, 700:0.7"/></bsdf>', **SPECTRAL)
case("spectrum-rgb-reflectance", SKY + BALL % '<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.4, 0.1"/></bsdf>', **SPECTRAL)
case("float-radiance", '<emitter type="constant"><float name="radiance" value="0.7"/></emitter>' + GREY, **SPECTRAL)

# ---- the language of the files
case("defaults", '<default name="grey" value="0.3"/>' + lit_ball('<bsdf type="diffuse"><rgb name="reflectance" value="$grey"/></bsdf>'))
case("include", SKY + LAMP + FLOOR + '<include filename="part.xml"/>')
case("alias", '<bsdf type="diffuse" id="first"><rgb name="reflectance" value="0.1"/></bsdf><alias id="first" as="second"/>' + lit_ball('<ref id="second"/>'))
case("version-0.6", '<shape type="sphere"><transform name="toWorld"><translate x="0.5" y="0.2" z="0"/></transform><bsdf type="dielectric"><float name="intIOR" value="1.3"/></bsdf></shape>' + SKY + LAMP + FLOOR, depth=12,
     lens=sensor().replace("to_world", "toWorld").replace("sample_count", "sampleCount"), version="0.6.0", options="")
CASES[-1].xml = CASES[-1].xml.replace("max_depth", "maxDepth").replace("to_world", "toWorld")
for depth in (2, 3, 7):
    case(f"depth-{depth}", lit_ball('<bsdf type="diffuse"><rgb name="reflectance" value="0.9"/></bsdf>'), depth=depth)
CASES.append(Case("direct", scene(lit_ball(""), integrator="direct").replace('<integer name="max_depth" value="5"/>', "")))


# ---- files that scenes read

def write_files(mi, np, folder):
    n = 64
    x, y = np.meshgrid((np.arange(2 * n) + 0.5) / (2 * n), (np.arange(n) + 0.5) / n)
    turn = 2 * np.pi * x
    base = 0.6 + 0.35 * np.cos(turn) * np.sin(np.pi * y) + 0.2 * np.sin(2 * turn) * np.sin(np.pi * y) + 0.3 * (y < 2) * np.cos(np.pi * y)
    save(mi, np, folder / "env.exr", np.repeat(np.clip(base, 0.02, None)[:, :, None], 3, 2))
    x, y = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    # Periodic and smooth, and not alike when turned over.
    picture = 0.45 + 0.2 * np.cos(2 * np.pi * x) + 0.2 * np.sin(2 * np.pi * y) * np.cos(2 * np.pi * x + 0.7)
    save(mi, np, folder / "picture.exr", np.repeat(picture[:, :, None], 3, 2))
    bumps = 0.5 + 0.2 * np.sin(2 * np.pi * x) + 0.15 * np.cos(2 * np.pi * y)
    save(mi, np, folder / "bumps.exr", np.repeat(bumps[:, :, None], 3, 2))
    nx, ny = 0.4 * np.sin(2 * np.pi * x), 0.3 * np.cos(2 * np.pi * y)
    normals = np.stack([nx, ny, np.sqrt(1 - nx * nx - ny * ny)], 2) * 0.5 + 0.5
    save(mi, np, folder / "normals.exr", normals)
    write_meshes(np, folder)
    write_grid(np, folder)
    write_measured(np, folder / "even.bsdf", np.zeros(1))
    write_measured(np, folder / "brushed.bsdf", np.linspace(-np.pi, 0, 5))
    (folder / "light.spd").write_text("# nm value\n" + "".join(f"{w} {0.2 + 0.001 * (w - 400)}\n" for w in range(400, 701, 20)))
    strands = ""
    for i in range(5):
        strands += "".join(f"{-1.5 + 0.7 * i + 0.3 * np.sin(j)} {-1.2 + 0.6 * j} {0.2 * i} {0.12 - 0.01 * j}\n" for j in range(5)) + "\n"
    (folder / "strands.txt").write_text(strands)
    (folder / "part.xml").write_text('<scene version="3.0.0"><shape type="sphere"><float name="radius" value="0.7"/><bsdf type="diffuse"><rgb name="reflectance" value="0.75"/></bsdf></shape></scene>')


def save(mi, np, path, values):
    mi.Bitmap(np.ascontiguousarray(values.astype(np.float32))).write(str(path))


def write_grid(np, folder):
    """Zero at its ends, and unlike along its three axes."""
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (10, 12, 16)), indexing="ij")
    puff = np.sin(np.pi * x) * np.sin(np.pi * y) ** 2 * np.sin(np.pi * z) * (0.5 + x + 0.5 * y)
    puff[0], puff[-1], puff[:, 0], puff[:, -1], puff[:, :, 0], puff[:, :, -1] = 0, 0, 0, 0, 0, 0
    head = b"VOL\3" + struct.pack("<5i6f", 1, 16, 12, 10, 1, 0, 0, 0, 1, 1, 1)
    (folder / "puff.vol").write_bytes(head + puff.astype("<f4").tobytes())


def write_measured(np, path, phis):
    """A made-up .bsdf file, with spectra, of the parametrisation of Dupuy and Jakob 2018; uneven in all that it depends on."""
    thetas, wavelengths, n = np.linspace(0, 1.55, 7), np.linspace(380, 780, 6), 16
    u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))  # along rows theta, from row to row phi
    theta, phi = u * u * np.pi / 2, (2 * v - 1) * np.pi
    m = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])

    def facets(stretch):
        x, y, z = m
        return 1 / (np.pi * 0.2 * ((x * x * stretch + y * y) / 0.2 + z * z) ** 2)

    uneven = len(phis) > 1
    d = facets(2.0 if uneven else 1.0)
    vndf = np.zeros((len(phis), len(thetas), n, n))
    luminance, spectra = np.zeros_like(vndf), np.zeros((len(phis), len(thetas), len(wavelengths), n, n))
    for i, p in enumerate(phis):
        for j, t in enumerate(thetas):
            seen = np.sin(t) * np.cos(p) * m[0] + np.sin(t) * np.sin(p) * m[1] + np.cos(t) * m[2]
            vndf[i, j] = d * np.clip(seen, 0, None) * u * np.sin(theta)
            luminance[i, j] = 1.2 + np.cos(3 * u + 0.5 * t) * np.sin(2 * np.pi * v + p)
            for k in range(len(wavelengths)):
                spectra[i, j, k] = (0.5 + 0.08 * k) * luminance[i, j] * (1 - 0.3 * u) * np.cos(t)
    sigma = np.repeat(0.25 + 0.75 * np.cos(np.linspace(0, 1, n) ** 2 * np.pi / 2)[None], n, 0)
    fields = {"theta_i": thetas, "phi_i": phis, "wavelengths": wavelengths, "ndf": d, "sigma": sigma, "vndf": vndf,
              "luminance": luminance, "spectra": spectra}
    arrays = {name: np.ascontiguousarray(a, "<f4") for name, a in fields.items()}
    arrays["description"] = np.frombuffer(b"made up", np.uint8)
    arrays["jacobian"] = np.ones(1, np.uint8)
    head_size = 18 + sum(13 + len(name) + 8 * a.ndim for name, a in arrays.items())
    head, body = b"tensor_file\0" + struct.pack("<BBI", 1, 0, len(arrays)), b""
    for name, a in arrays.items():
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", a.ndim, 10 if a.itemsize == 4 else 1, head_size + len(body))
        head += struct.pack(f"<{a.ndim}Q", *a.shape)
        body += a.tobytes()
    path.write_bytes(head + body)


def hill(np):
    n = 9
    points, uvs, faces = [], [], []
    for j in range(n):
        for i in range(n):
            u, v = i / (n - 1), j / (n - 1)
            points.append((3 * u - 1.5, 2.6 * v - 1.3, 0.5 * np.sin(5 * u) * np.cos(3 * v)))
            uvs.append((u, v))
    for j in range(n - 1):
        for i in range(n - 1):
            a = j * n + i
            faces += [(a, a + 1, a + n + 1), (a, a + n + 1, a + n)]
    return points, uvs, faces


def write_meshes(np, folder):
    points, uvs, faces = hill(np)
    rows = "".join(f"{p[0]} {p[1]} {p[2]} {t[0]} {t[1]}\n" for p, t in zip(points, uvs))
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
    tail = f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    face_rows = "".join(f"3 {f[0]} {f[1]} {f[2]}\n" for f in faces)
    (folder / "hill.ply").write_text(head + "property float u\nproperty float v\n" + tail + rows + face_rows)
    colors = "".join(f"{p[0]} {p[1]} {p[2]} {c} {c} {c}\n" for p, c in zip(points, [0.1 + 0.8 * t[0] * t[1] for t in uvs]))
    (folder / "colors.ply").write_text(head + "property float r\nproperty float g\nproperty float b\n" + tail + colors + face_rows)
    obj = "".join(f"v {p[0]} {p[1]} {p[2]}\n" for p in points) + "".join(f"vt {t[0]} {t[1]}\n" for t in uvs)
    (folder / "hill.obj").write_text(obj + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in f) + "\n" for f in faces))
    # Version 4 of the serialized format, with texture coordinates and single precision.
    body = struct.pack("<I", 0x1002) + b"hill\0" + struct.pack("<QQ", len(points), len(faces))
    body += b"".join(struct.pack("<3f", *p) for p in points) + b"".join(struct.pack("<2f", *t) for t in uvs)
    body += b"".join(struct.pack("<3I", *f) for f in faces)
    packed = struct.pack("<HH", 0x041C, 4) + zlib.compress(body)
    (folder / "hill.serialized").write_bytes(packed + struct.pack("<QI", 0, 1))
