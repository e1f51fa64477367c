#!/usr/bin/env bash
# abbe import and abbe render with a glTF scene: from its JSON to a picture.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# A file with textures, layers of materials, a light, a camera and an animation.
cp "$bad/../../fuzz/corpus/gltf_import/scene.gltf" .
expect 0 import scene.gltf
tells err W0802 KHR_materials_sheen
tells err W0801 KHR_materials_variants
says err "scene.gltf:"
says scene.scene "// Variant \`red\`"
expect 0 render scene.scene --size 24x16 --samples 4 --quiet -o scene.exr
expect 0 render scene.gltf --size 24x16 --samples 4 --quiet -o again.exr
same_pixels scene.exr again.exr
expect 0 render scene.gltf --size 24x16 --samples 4 --quiet --frames 0,24 -o moving.####.exr
[[ $(pixels moving.0000.exr) != $(pixels moving.0024.exr) ]] || fault "nothing moves"

# What the file has beside what is shown.
expect 0 info scene.gltf
says out "animation  animations[0]  0 … 1 s"
says out "variant    red"
says out "camera     cameras[0]"
expect 0 info scene.gltf --json
says out '"last_s": 1'
says out '"morphs": []'

# A model alone is framed and lit; whatever its name is.
cat >square.json <<'JSON'
{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
 "bufferViews":[{"buffer":0,"byteLength":36}],
 "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}
JSON
expect 0 render square.json --size 24x16 --samples 4 --quiet -o square.exr
sed 's/"asset"/"images":[{"uri":"paint.png"}],"textures":[{"source":0}],"materials":[{"normalTexture":{"index":0}}],"asset"/
     s/"POSITION":0}/&,"material":0/' square.json >painted.gltf
expect 1 import painted.gltf
tells err E0401 paint.png
sed 's/"count":3/"count":30/' square.json >short.gltf
expect 1 render short.gltf -o short.exr
tells err E0802 "accessors[0]"
finish
