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
Texture "t" "spectrum" "ptex" "string filename" "none.ptx"
Material "diffuse" "texture reflectance" "t"
Shape "trianglemesh" "point3 P" [-9 -9 2  9 -9 2  9 9 2  -9 9 2] "integer indices" [0 2 1 0 3 2]
PBRT
expect 0 import wall.pbrt
tells err W0801 "Ptex files are not read"
says err "wall.pbrt:7:1"
says out "wall.scene: 1 remark"
expect 2 import wall.pbrt # it is there already
expect 0 render wall.scene --quiet
expect 0 info wall.exr
says out "8×8"
expect 0 render wall.pbrt --quiet -o again.exr
[[ $(pixels wall.exr) == $(pixels again.exr) ]] || fault "the scene and what it was made of differ"

# Compressed files, of the scene and of a mesh.
cat >ball.ply <<'PLY'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
-9 -9 2
9 -9 2
9 9 2
-9 9 2
4 0 3 2 1
PLY
gzip ball.ply
sed -e '/^Material/d' -e '/^Texture/d' -e 's/^Shape .*/Shape "plymesh" "string filename" "ball.ply.gz"/' wall.pbrt | gzip >packed.pbrt.gz
expect 0 import packed.pbrt.gz -o packed.scene
is_empty err
says packed.scene "faces { - 0 3 2 1 }" # a tiny mesh stands in the scene
expect 0 render packed.scene --quiet -o packed.exr
head -c 40 packed.pbrt.gz >short.pbrt.gz
expect 1 import short.pbrt.gz
tells err E0802 "no intact gzip file"

# A picture that shines is an area light with that texture.
cat >lamp.pbrt <<'PBRT'
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
WorldBegin
AreaLightSource "diffuse" "string filename" "again.exr" "float scale" 3
Shape "bilinearmesh" "point3 P" [-1 -1 2 1 -1 2 -1 1 2 1 1 2]
PBRT
expect 0 import lamp.pbrt
expect 0 render lamp.scene --quiet -o lamp.exr

printf 'Film "image"\nWorldBegin\nWorldEnd\n' >old.pbrt
expect 1 import old.pbrt
tells err E0801 pbrt-v3
says err "pbrt --upgrade"
finish
