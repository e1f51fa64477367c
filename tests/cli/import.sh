#!/usr/bin/env bash
# abbe import, and scenes of other programs given in place of a scene.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$folder/xdg

mkdir -p peer/parts
cat >peer/parts/hill.obj <<'O'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 2 3
f 1 3 4
O
cat >peer/room.xml <<'S'
<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="4"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="8"/></sampler></sensor>
  <emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
  <shape type="obj" id="hill"><string name="filename" value="parts/hill.obj"/><bsdf type="roughconductor"/></shape>
</scene>
S

# A scene file beside what it needs, which is checked and says what to do next.
expect 0 import peer/room.xml
tells out "room.scene" "abbe render room.scene"
tells err W0802
says err "peer/room.xml:8:"
says room.scene "// Imported from room.xml"
says room.scene "// Approximated: distribution"
[[ -e room-files/hill.ply ]] || fault "no mesh beside the scene"
expect 0 render room.scene --quiet -o written.exr

# Nothing is replaced unless that is asked for.
expect 2 import peer/room.xml
says err "--force"
expect 0 import peer/room.xml --force --json
says out "\"format\": \"mitsuba\""

expect 0 import peer/room.xml -o new/place.scene
[[ -e new/place-files/hill.ply ]] || fault "no mesh beside the scene"

# Used as it is: the same bits, an image named after it, and nothing left behind.
expect 0 render peer/room.xml --quiet
[[ -e room.exr ]] || fault "no image named after the scene"
same_pixels room.exr written.exr
[[ -z $(ls "$XDG_CACHE_HOME/abbe/imports") ]] || fault "the import was left in the cache"
expect 0 check peer/room.xml
expect 0 info peer/room.xml
expect 0 explain peer/room.xml --effects
expect 2 check peer/room.xml --fix
says err "abbe import"

# Parts of it fit together, wherever each was imported to, and it can be packed.
for part in 1 2; do expect 0 render peer/room.xml --quiet -o split.exr --part $part/2; done
expect 0 merge split.part1.abbe split.part2.abbe -o merged.exr
same_pixels merged.exr written.exr
expect 0 pack peer/room.xml -o room.abz
expect 0 render room.abz --quiet -o packed.exr
same_pixels packed.exr written.exr

# What is wrong is said with its place, and nothing is written.
sed 's/hill.obj/hil.obj/; s/"path"/"$none"/' peer/room.xml >peer/wrong.xml
expect 1 import peer/wrong.xml
says err "E0401"
says err "did you mean \`hill.obj\`?"
says err "peer/wrong.xml:8:"
[[ ! -e wrong.scene ]] || fault "a wrong scene was written"
expect 1 render peer/wrong.xml
expect 2 import room.scene
expect 3 import none.xml
# A model with its materials, in a camera and lights that show it; what is missing is said, and grey.
mkdir -p model
{
    printf 'mtllib chair.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n'
    printf 'usemtl wood\nf 1 2 3 4\nusemtl steel\nf 1 5 2\nusemtl stell\nf 1 4 5\n'
} >model/chair.obj
printf 'newmtl wood\nKd 0.4 0.2 0.1\nmap_Kd oak.png\nnewmtl steel\nKd 0 0 0\nKs 0.8 0.8 0.8\nNs 500\nillum 3\n' >model/chair.mtl
expect 0 import model/chair.obj
says err "model/chair.mtl:3:8"
says err "model/chair.obj:11:8"
says err "did you mean \`steel\`?"
says chair.scene "shape steel mesh"
expect 0 render model/chair.obj --quiet --size 48x36 --samples 4
[[ -e chair.exr ]] || fault "no image named after the model"
# Neither black nor white, and the model is in it.
expect 0 info chair.exr
rm model/chair.mtl
expect 0 render model/chair.obj --quiet --size 24x18 --samples 4 -o grey.exr
says err W0801

finish
