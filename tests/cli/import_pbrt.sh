#!/usr/bin/env bash
# abbe import and abbe render with a scene of pbrt-v4: from its text to the pixels that pbrt would show.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# A wall of reflectance 1/2 under an even sky of 2, exposed for 1/2 s at ISO 400: 0.5 · 2 · 0.5 · 4 = 2 everywhere.
cat >wall.pbrt <<'PBRT'
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 10 "float shutterclose" 0.5
Film "rgb" "integer xresolution" 8 "integer yresolution" 8 "float iso" 400 "string filename" "wall.exr"
Sampler "zsobol" "integer pixelsamples" 64
WorldBegin
LightSource "infinite" "rgb L" [2 2 2]
Material "measured" "string filename" "none.bsdf"
Shape "trianglemesh" "point3 P" [-9 -9 2  9 -9 2  9 9 2  -9 9 2] "integer indices" [0 2 1 0 3 2]
PBRT
expect 0 import wall.pbrt
tells err W0801 "measured material"
says err "wall.pbrt:7:1"
says out "wall.scene: 1 remark"
expect 2 import wall.pbrt # it is there already
expect 0 render wall.scene --quiet
expect 0 info wall.exr
says out "8×8"
expect 0 render wall.pbrt --quiet -o again.exr
[[ $(pixels wall.exr) == $(pixels again.exr) ]] || fault "the scene and what it was made of differ"

printf 'Film "image"\nWorldBegin\nWorldEnd\n' >old.pbrt
expect 1 import old.pbrt
tells err E0801 pbrt-v3
says err "pbrt --upgrade"
finish
