#!/usr/bin/env bash
# abbe export: a scene for other programs, with what it needs beside it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$folder/xdg

cat >room.scene <<'S'
scene 1
film { size 24 16; filter box 0.5; output "room.exr" space=rec709 }
camera { from 0 1 5; look-at 0 0 0; fov 40 deg }
render { samples 8; max-depth 4 }
light sky { radiance rgb 0.5 0.5 0.5 }
shape floor quad { size 4 4; transform { rotate x -90 deg; translate 0 -1 0 }; material diffuse { reflectance 0.4 } }
shape ring torus { material conductor { index metal Au; roughness 0.3 } }
S

# One file of each format, what is only nearly the same with its place, and files beside it.
expect 0 export room.scene --to mitsuba
says out "room.xml: 2 remarks"
says err "room.scene:7:"
says err W0802
says room.xml "<!-- Approximated: \`torus\`"
[[ -e room-mitsuba-files/ring.ply ]] || fault "no mesh beside the scene"
expect 0 export room.scene --to pbrt -o new/room.pbrt --json
says out "\"format\": \"pbrt\""
says new/room.pbrt "# Approximated: \`torus\`"
[[ -e new/room-pbrt-files/ring.ply ]] || fault "no mesh beside the scene"
expect 0 export room.scene --to gltf
[[ $(head -c 4 room.glb) == glTF ]] || fault "no glTF file"

# The same bytes again, and nothing replaced unless that is asked for.
cp room.xml first.xml
expect 2 export room.scene --to mitsuba
says err "--force"
expect 0 export room.scene --to mitsuba --force
cmp -s room.xml first.xml || fault "another export has other bytes"

# What is written is a scene again.
expect 0 render room.xml --quiet -o mitsuba.exr
expect 0 render new/room.pbrt --quiet -o pbrt.exr
expect 0 export room.xml --to pbrt -o twice.pbrt

# Wrong scenes are not written.
sed 's/torus/tours/' room.scene >wrong.scene
expect 1 export wrong.scene --to mitsuba
[[ ! -e wrong.xml ]] || fault "a wrong scene was written"
expect 3 export none.scene --to mitsuba
expect 2 export room.scene
expect 2 export room.scene --to blend
finish
