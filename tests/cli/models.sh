#!/usr/bin/env bash
# Meshes that take the materials of their file: shape mesh "a.glb" { materials on }.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$folder/xdg

# Two squares of 2 × 2 m at x = ∓1, matte and of reflectance 0.2 and 0.8, and a third below them with a picture.
mkdir -p models/pictures
cp "$bad/../../snippets/any.png" models/pictures/paint.png
cat >models/tiles.gltf <<'JSON'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
 "nodes":[{"name":"left","mesh":0,"translation":[-1,0,0]},{"name":"right","mesh":1,"translation":[1,0,0]},
          {"name":"below","mesh":2,"translation":[0,-4,0]}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]},
           {"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":1}]},
           {"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":2}]}],
 "materials":[{"name":"dark","extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.2,0.2,1]}},
              {"name":"light","extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.8,0.8,1]}},
              {"name":"painted","extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
 "textures":[{"source":0}],"images":[{"uri":"pictures/paint.png"}],"extensionsUsed":["KHR_materials_unlit"],
 "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},
              {"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},
              {"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}],
 "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},{"buffer":0,"byteOffset":80,"byteLength":12}],
 "buffers":[{"byteLength":92,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAAAAAAgD8AAIA/AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEAAgAAAAIAAwA="}]}
JSON

# Under an even sky of radiance 1 they have the radiances 0.2 and 0.8: the same picture as of two that emit that much.
head='film { size 32 16; filter box 0.5 }
render { samples 1024 }
camera orthographic { from 0 0 5; look-at 0 0 0; height 2 }
light sky { radiance 1 }'
cat >shot.scene <<S
scene 1
param model "models/tiles.gltf" "what is placed"
$head
shape tiles mesh \$model { materials on }
S
cat >known.scene <<S
scene 1
$head
material black diffuse { reflectance 0 }
shape quad { size 2 2; material black; emission 0.2; transform { translate -1 0 0 } }
shape quad { size 2 2; material black; emission 0.8; transform { translate 1 0 0 } }
S
expect 0 render shot.scene -q -o shot.exr
expect 0 render known.scene -q -o known.exr
expect 0 compare shot.exr known.exr --threshold maximum=0.05 --threshold mean-error=0.002

# The names of the parts begin with the shape's; what is approximated is said once, at the shape, with the place in the file.
expect 0 info shot.scene
says out "tiles/left mesh"
says out "file       models/tiles.gltf"
says_not out "$XDG_CACHE_HOME"
expect 0 check shot.scene
[[ $(grep -c "warning\[W0802\]" err) -eq 3 ]] || fault "each approximation is not said once"
says err "shot.scene:7:"
says err "models/tiles.gltf:"

# Other units and axes: the file is in metres with y up, and turned with the scene it is the same picture.
sed -e 's/^scene 1$/scene 1 length=mm rgb=acescg up=z/' -e 's/from 0 0 5; look-at 0 0 0; height 2/from 0 -5000 0; look-at 0 0 0; height 2000/' \
    shot.scene >zup.scene
expect 0 render zup.scene -q -o zup.exr
expect 0 compare zup.exr known.exr --threshold maximum=0.05 --threshold mean-error=0.002

# Its transform, visibility and instances are those of any shape; a part of the file is placed as the file places it.
sed -e 's/materials on/materials on; visible-to shadows; transform { translate 0 4 0 }/' shot.scene >hidden.scene
cat >>hidden.scene <<'S'
object wall { shape mesh "models/tiles.gltf" node=right { materials on; transform { translate -1 0 0 } } }
instance wall { transform { translate -1 0 0 } }
instance wall { transform { scale 2; translate 2 0 0 } }
S
expect 0 info hidden.scene
says out "tiles-2/right"
cat >moved.scene <<S
scene 1
$head
material black diffuse { reflectance 0 }
shape quad { size 4 4; material black; emission 0.8; transform { translate 2 0 0 } }
shape quad { size 2 2; material black; emission 0.8; transform { translate -1 0 0 } }
S
expect 0 render hidden.scene -q -o hidden.exr
expect 0 render moved.scene -q -o moved.exr
expect 0 compare hidden.exr moved.exr --threshold maximum=0.08 --threshold mean-error=0.004

# A pack has the model with its pictures, and renders the same bits; so do parts of both, which are one render.
sed 's/height 2 /height 12 /' shot.scene >wide.scene
expect 0 render wide.scene -q --samples 16 -o wide.exr
expect 0 pack wide.scene -o wide.abz
expect 0 render wide.scene -q --samples 16 --part 1/2 -o half.exr
mv models gone
expect 0 render wide.abz -q --samples 16 --part 2/2 -o half.exr
expect 0 render wide.abz -q --samples 16 -o packed.exr
same_pixels wide.exr packed.exr
expect 0 merge half.part1.abbe half.part2.abbe --scene wide.abz -o merged.exr
same_pixels wide.exr merged.exr
mv gone models
sed -i 's/0.2,0.2,0.2/0.3,0.2,0.2/' models/tiles.gltf
expect 0 render wide.scene -q --samples 16 --part 2/2 -o half.exr
expect 1 merge half.part1.abbe half.part2.abbe -o mixed.exr
tells err E0663 "shape tiles"

# OBJ models with libraries: Kd is the reflectance, Ke the radiance; their unit and axes are the scene's.
cat >models/two.mtl <<'M'
newmtl dark
Kd 0.2 0.2 0.2
newmtl lamp
Kd 0 0 0
Ke 0.8 0.8 0.8
M
cat >models/two.obj <<'O'
mtllib two.mtl
v -2000 -1000 0
v 0 -1000 0
v 0 1000 0
v -2000 1000 0
v 2000 -1000 0
v 2000 1000 0
usemtl dark
f 1 2 3 4
usemtl lamp
f 2 5 6 3
O
sed -e 's/^scene 1$/scene 1 length=mm/' -e 's/from 0 0 5; look-at 0 0 0; height 2/from 0 0 5000; look-at 0 0 0; height 2000/' \
    -e 's|models/tiles.gltf|models/two.obj|' shot.scene >obj.scene
expect 0 render obj.scene -q -o obj.exr
says_not err W080
expect 0 compare obj.exr known.exr --threshold maximum=0.05 --threshold mean-error=0.002
expect 0 pack obj.scene -o obj.abz
expect 0 render obj.abz -q -o obj-packed.exr
same_pixels obj.exr obj-packed.exr
expect 0 export obj.scene --to mitsuba

# What cannot be: a material of its own, files without materials, damaged models, parts that are not there.
wrong() { # CODE WORDS OF THE SHAPE
    { sed '/^shape/d' shot.scene; echo "shape tiles mesh $2"; } >wrong.scene
    expect 1 check wrong.scene
    tells err "$1"
    says err "wrong.scene:"
}
wrong E0616 '"models/tiles.gltf" { materials on; material diffuse }'
says err "materials off"
wrong E0616 '"models/tiles.gltf" { materials on; emission 1 }'
wrong E0616 '{ materials on; at 0 s { file "models/tiles.gltf" }; at 1 s { file "models/tiles.gltf" } }'
cp "$bad/../../snippets/any.ply" models/any.ply
wrong E0616 '"models/any.ply" { materials on }'
wrong E0401 '"models/tile.gltf" { materials on }'
wrong E0308 '"models/tiles.gltf" { materials yes }'
wrong E0201 '"models/tiles.gltf" { materials on; colour 1 }'
wrong E0802 '"models/tiles.gltf" node=middle { materials on }'
wrong E0802 '"models/tiles.gltf" time=1 { materials on }'
sed 's/"count":4/"count":40/' models/tiles.gltf >models/short.gltf
wrong E0802 '"models/short.gltf" { materials on }'
[[ -z $(ls "$XDG_CACHE_HOME/abbe/imports") ]] || fault "imports were left in the cache"
finish
