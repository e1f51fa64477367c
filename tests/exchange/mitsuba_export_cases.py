"""Small scenes of Abbe's, one construct each, for `mitsuba_compare.py --export`.

Every scene is rendered by Abbe, exported, and rendered by Mitsuba's spectral variant.
"""
from mitsuba_cases import SIZE, Case

CASES = []

VIEW = "camera { from 0 0 5; look-at 0 0 0; fov 40 deg }"
FILM = f'film {{ size {SIZE} {SIZE}; filter box 0.5; output "x.exr" space=rec709 }}'
RENDER = "render { max-depth 5 }"
SKY = "light around sky { radiance rgb 0.6 0.6 0.6 }"
# A lamp from the side, so that pictures are not symmetric.
LAMP = "light lamp sphere { center 3 4 4; radius 1; radiance rgb 12 12 12 }"
FLOOR = "shape floor quad { size 8 8; transform { rotate x -90 deg; translate 0 -1 0 }; material diffuse { reflectance 0.4 } }"
BALL = "shape ball sphere { radius 1; material %s }"
GREY = FLOOR + "\n" + BALL % "diffuse { reflectance 0.5 }"


def case(name, body, camera=VIEW, film=FILM, render=RENDER, spp=12, **settings):
    text = "\n".join(["scene 1", film, camera, render, body]) + "\n"
    CASES.append(Case("export-" + name, text, variant="scalar_spectral", spp=spp, **settings))


def ball(name, material, **settings):
    case(name, "\n".join([SKY, LAMP, FLOOR, BALL % material]), **settings)


LOSS = "Mitsuba loses the light that is scattered more than once between facets"
SMOOTH = dict(tolerance=0.02, floor=0.02, reason="images are interpolated smoothly")

# ---- shapes
ball("sphere", "diffuse { reflectance rgb 0.7 0.4 0.2 }")
case("quad", "\n".join([SKY, LAMP, "shape quad { points -1 -1 0  1 -0.6 0.3  1 1 0.3  -1 0.6 0; material diffuse { reflectance 0.6 } }"]))
case("quad-behind", "\n".join([SKY, LAMP, "shape quad { size 2 1; transform { rotate y 150 deg } }"]))
case("box", "\n".join([SKY, LAMP, "shape box { size 1 1.5 0.7; center 0.2 0 0; transform { rotate y 35 deg } }"]))
case("disk", "\n".join([SKY, LAMP, "shape disk { normal 0.3 0.5 1; radius 1.2; center 0.1 0 0 }"]))
case("cylinder", "\n".join([SKY, LAMP, "shape cylinder { axis 0.4 1 0.3; radius 0.5; height 1.5 }"]))
case("cone", "\n".join([SKY, LAMP, "shape cone { radius 0.8; height 1.6 }"]), tolerance=0.01, floor=0.01, reason="polygons")
case("mirrored", "\n".join([SKY, LAMP, "group { transform { scale -1 1 1 }; shape sphere { center 0.7 0 0; radius 0.5 }; shape box { size 0.8 0.8 0.8; center -0.6 0 0; material two-sided { front diffuse { reflectance 0.8 }; back diffuse { reflectance 0 } } } }"]))
case("mesh", "\n".join([SKY, LAMP, 'shape mesh "hill.ply" { transform { rotate y 20 deg } }']))
case("mesh-inline", "\n".join([SKY, LAMP, "shape mesh { points { - -1 -1 0; - 1 -1 0; - 1 1 0.5; - -1 1 0; - 0 0 1 }; faces { - 0 1 4; - 1 2 4; - 2 3 4; - 3 0 4 } }"]))
case("instance", "\n".join([SKY, LAMP, "object pair { shape sphere { radius 0.4 }; shape box { size 0.4 0.4 0.4; center 0 0.6 0 } }",
                            "instance pair { transform { translate -0.8 0 0 } }", "instance pair { transform { rotate z 40 deg; scale 1.3; translate 0.8 0 0 } }"]))

# ---- materials
ball("mirror", "conductor { index { n 0; k 1 } }")
ball("gold", "conductor { index metal Au }", tolerance=0.07, floor=0.02, reason="another measurement of the metal")
ball("brass", "conductor { index metal brass }")
ball("rough-conductor", "conductor { index { n 0.5; k 2.5 }; roughness 0.316228 }", tolerance=0.03, reason=LOSS)
ball("measured", 'measured "even.bsdf"', spp=48)
ball("glass", "dielectric { ior 1.5 }", render="render { max-depth 12 }", spp=24)
ball("rough-glass", "dielectric { ior 1.5; roughness 0.3 }", render="render { max-depth 12 }", tolerance=0.03, reason=LOSS)
ball("thin", "thin-dielectric { ior 1.5 }")
ball("mix", "mix { first diffuse { reflectance 0.8 }; second conductor { index { n 0; k 1 } }; amount 0.3 }")
ball("opacity", "diffuse { reflectance 0.5; opacity 0.6 }")
DIRECTION = "the base's share of the light depends on its direction"
ball("plastic", "layered { base diffuse { reflectance rgb 0.3 0.5 0.1 }; darkening 0 }", tolerance=0.1, reason=DIRECTION)
ball("plastic-darkened", "layered { base diffuse { reflectance rgb 0.3 0.5 0.1 } }", tolerance=0.2, reason=DIRECTION + ", and its darkening is an estimate here")
case("two-sided", "\n".join([SKY, LAMP, "shape quad { size 2 2; transform { rotate y 160 deg }; material two-sided { front diffuse { reflectance 0.8 }; back diffuse { reflectance 0.2 } } }"]))
case("image", "\n".join([SKY, LAMP, 'shape quad { size 2 2; material diffuse { reflectance image "picture.exr" } }']), **SMOOTH)
case("image-sphere", "\n".join([SKY, LAMP, 'shape sphere { radius 1; transform { rotate y 40 deg }; material diffuse { reflectance image "picture.exr" } }']), **SMOOTH)
case("checker", "\n".join([SKY, LAMP, "shape quad { size 2 2; material diffuse { reflectance checker { even 0.8; odd rgb 0.1 0.2 0.4; scale 3 } } }"]), tolerance=0.02, floor=0.03, reason="edges between squares are filtered")

# ---- lights
case("area", "\n".join([GREY, "light quad { size 1 1; power 2000000 lm; color blackbody 3000 K; transform { rotate x 90 deg; translate 0.4 2 0.6 } }"]))
case("area-luminance", "\n".join([GREY, "light disk { radius 0.5; center -0.5 2 0; normal 0 -1 0; luminance 500000 nits; color rgb 1 0.7 0.4 }"]))
case("point", "\n".join([GREY, "light point { position 2 3 2; intensity 1000000 cd; color rgb 1 0.6 0.3 }"]))
case("point-power", "\n".join([GREY, "light point { position 2 3 2; power 10000 W }"]))
case("spot", "\n".join([GREY, "light spot { position 1 3 3; look-at 0 0 0; angle 30 deg; inner-angle 30 deg; intensity 2000000 cd }"]))
case("sun", "\n".join([GREY, "light sun { elevation 50 deg; azimuth 120 deg; angular-diameter 0 deg; irradiance 100 klx }"]))
case("sky", "\n".join(["light sky { color illuminant A }", GREY]))
case("environment", "\n".join(['light environment "env.exr" { exposure 1 stops; transform { rotate x 30 deg; rotate y 70 deg } }',
                               BALL % "conductor { index { n 0; k 1 } }", FLOOR]), tolerance=0.01, floor=0.01, reason="images are interpolated smoothly")
case("exposure", "\n".join([GREY, "light point { position 2 3 2; intensity 1000 cd }"]), camera="camera { from 0 0 5; look-at 0 0 0; fov 40 deg; exposure 10 stops }")
case("spectra", "\n".join(["light sky { radiance table 400 0.2 500 1 600 0.6 700 0.1 }", BALL % "diffuse { reflectance measured cornell-red }"]))

# ---- cameras and media
case("lens", "\n".join([SKY, LAMP, GREY]), camera="camera { from 0 1 5; look-at 0 0 0; lens 50 mm; aperture 0.4 m; focus 3.5 m }")
case("shift", "\n".join([SKY, LAMP, GREY]), camera="camera { from 1 1 5; look-at 0 0 0; up 0.2 1 0; lens 50 mm; shift 4 -3 mm }",
     film=f'film {{ size {SIZE} 32; filter box 0.5; output "x.exr" space=rec709 }}', size=(SIZE, 32))
case("orthographic", "\n".join([SKY, LAMP, GREY]), camera="camera orthographic { from 1 2 5; look-at 0 0 0; width 4 m }")
case("crop", "\n".join([SKY, LAMP, GREY]), film=f'film {{ size {SIZE} {SIZE}; crop 8 16 48 48; filter box 0.5; output "x.exr" space=rec709 }}', size=(40, 32))
case("medium", "\n".join([SKY, LAMP, FLOOR, "shape box { size 1.8 1.8 1.8; material boundary; interior homogeneous { extinction 1.5; albedo 0.9; phase henyey-greenstein 0.7 } }"]),
     render="render { max-depth 30 }")
case("absorption", "\n".join([SKY, LAMP, FLOOR, BALL % "dielectric { ior 1.3; absorption rgb 0.2 0.5 1 per-m }"]), render="render { max-depth 12 }", tolerance=0.01, floor=0.01, reason="colours become spectra")
