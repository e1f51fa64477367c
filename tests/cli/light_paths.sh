#!/usr/bin/env bash
# Paths of light are under the same contracts as those of the camera: the same bits for any threads, crops, parts and
# interruptions; the same picture as without them; reported, with their cost, and explained.
#   light_paths.sh PROGRAM JSON_LINES
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/caustic.scene

# with CHOICE >FILE: the scene with another choice of light paths, and more words for its render.
with() { sed "s/samples 64/samples 64; light-paths $1/" "$scene"; }
for choice in off always alone; do with $choice >$choice.scene; done

# Threads and kernels.
same_for_threads_and_kernels "$scene" whole.exr
expect 0 info whole.exr
says out "abbe.lightPaths = "
expect 0 "$scene" -q -o seed.exr --seed 1
[[ $(pixels whole.exr) != $(pixels seed.exr) ]] || fault "the seed changes nothing"

# Parts of the samples and of the picture.
for part in 3 1 2; do expect 0 "$scene" -q -o split.exr --part $part/3; done
expect 0 merge split.part{2,3,1}.abbe -o merged.exr
same_pixels whole.exr merged.exr
same_certificate whole.exr merged.exr
expect 0 "$scene" -q -o left.exr --part 1/1 --crop 0,0,21,32
for part in 1 2; do expect 0 "$scene" -q -o right.exr --part $part/2 --crop 21,0,48,32; done
expect 0 merge left.part1.abbe right.part{1,2}.abbe -o crops.exr
same_pixels whole.exr crops.exr
same_certificate whole.exr crops.exr
expect 0 always.scene -q -o choice.exr --part 2/2 --crop 21,0,48,32
expect 1 merge left.part1.abbe right.part1.abbe choice.part2.abbe -o no.exr
says err E0663
says err "always"

# A render that is killed goes on to the same bits; so does one that gets more samples.
survives_kills 3 "$scene" --samples 640
expect 0 "$scene" --samples 32 -q -o more.exr --checkpoint keep
expect 0 "$scene" -q -o more.exr --checkpoint keep --resume
same_pixels whole.exr more.exr
expect 1 off.scene -q -o more.exr --resume
says err E0663

# One pixel is that of the picture, of any threads; a sample of it is a camera path, told the same again.
expect 0 "$scene" --pixel 20,22
cp out pixel
expect 0 "$scene" --pixel 20,22 -t 1
cmp -s pixel out || fault "--pixel differs"
expect 0 off.scene --pixel 20,22
cmp -s pixel out && fault "light paths bring nothing to the pixel"
expect 0 replay "$scene" --pixel 20,22 --sample 1:7
cp out once
expect 0 replay "$scene" --pixel 20,22 --sample 1:7 -t 1
cmp -s once out || fault "one thread tells another story"

# The same picture as camera paths alone find, in other bits. They can find the caustic of a large lamp.
large() { sed "s/samples 64/samples 1024; replicates 16; light-paths $1/; s/radius 3 cm/radius 30 cm/" "$scene"; }
seed=1
for choice in off always alone; do
    large $choice >large.scene
    expect 0 large.scene -q --seed $seed -o $choice.exr
    seed=$((seed + 1))
done
for choice in always alone; do
    expect 0 compare $choice.exr off.exr --threshold agreement=0.001
    [[ $(pixels off.exr) != $(pixels $choice.exr) ]] || fault "$choice changes nothing"
done
sed 's/^light lamp .*/light lamp sphere { center 1.5 3 0.5; radius 30 cm; power 1000 lm }/' large.scene >brighter.scene
expect 0 brighter.scene -q --seed 9 -o brighter.exr
expect 4 compare brighter.exr off.exr --threshold agreement=0.001 # the test can see a quarter

# Told: in the summary, in JSON, in the header, in the certificate, by explain.
line="light paths [0-9.]* per camera path: forecast .* as efficient (.*lamp → .* [0-9]* %"
expect 0 "$scene" -o told.exr
grep -q "$line" err || fault "no line for light paths: $(cat err)"
expect 0 "$scene" -o told.exr --json
says out '"light_path_plan":{"verdict":"used"'
"$json_lines" <out >/dev/null || fault "events are no JSON lines"
expect 0 info told.exr
grep -q "^abbe.lightPathPlan = $line" out || fault "no plan in the header"
says out "abbe.lightPathTechnique = automatic"
says out "abbe.lightPathGain = "
grep -q '"verdict": "used"' told.exr.json || fault "no plan in the certificate"
expect 0 explain "$scene"
says out "Light paths: "
says out "lamp → ball"
says out "lamp → bead"
says out "sky"
says out "with both"
cp out first
expect 0 explain "$scene"
cmp -s first out || fault "explain says something else the second time"
expect 0 explain "$scene" --json
says out '"verdict": "used"'
says out '"target": "bead"'

# A plan is one camera's, size's and seed's: explained as rendered.
gain() { tr -d ' \n' <out | grep -o '"gain":[0-9.e+-]*' | head -n 1; }
sed 's/^camera {/camera front {/
    /^film/i camera side { from 4 2 0; look-at 0 0.4 0; fov 30 deg }' "$scene" >cameras.scene
expect 0 explain cameras.scene --json
front=$(gain)
for frame in "--camera side" "--seed 3" "--size 40x40 --camera side --seed 3"; do
    # shellcheck disable=SC2086 # flags and their values
    expect 0 explain cameras.scene $frame --json
    [[ $(gain) != "$front" ]] || fault "$frame changes no plan"
    explained=$(gain)
    # shellcheck disable=SC2086
    expect 0 cameras.scene $frame --samples 8 -o frame.exr --json
    [[ -n $explained && $(gain) == "$explained" ]] || fault "$frame: $explained explained, $(gain) rendered"
done
expect 1 explain cameras.scene --camera rear
tells err E0601 "\`rear\`"
expect 2 explain camera.lens --camera side
expect 0 explain off.scene
tells out "Light paths: none" "\`light-paths off\`"
expect 0 explain "$scenes/room.scene"
tells out "Light paths: none" focuses
expect 0 "$scenes/room.scene" -o room.exr
says_not err "light paths"

# The cost report: a row of its own, no time without a row, the same counts for any threads.
row() { grep '"event":"done"' out | grep -o '{"id":"light-paths"[^}]*}'; }
counts() { row | grep -o -e '"rays":[0-9]*' -e '"count":[0-9]*'; }
expect 0 "$scene" --json --samples 1024 -o cost.exr -t 1
grep '"event":"done"' out | grep -o '"accounted":[0-9.]*' | awk -F: '{ exit !($2 > 0.95 && $2 < 1.05) }' ||
    fault "the rows do not add up"
row | grep -o '"share":[0-9.e-]*' | awk -F: '{ exit !($2 > 0.02 && $2 < 0.95) }' || fault "light paths have $(row)"
grep '"event":"done"' out | grep -o '{"id":"waiting"[^}]*}' | grep -o '"share":[0-9.e-]*' |
    awk -F: '{ exit !($2 < 0.1) }' || fault "time of light paths counts as waiting"
counts >one
expect 0 "$scene" --json --samples 1024 -o cost.exr -t 2
counts >two
cmp -s one two || fault "threads change counts: $(cat one two)"
for part in 1 2; do expect 0 "$scene" --json --samples 1024 -o part.exr --part $part/2; done
expect 0 merge part.part{1,2}.abbe -o merged.exr --json
counts >merged
cmp -s one merged || fault "parts put together have other counts"
expect 0 off.scene --json -o cost.exr
[[ $(row) == *'"rays":0'* ]] || fault "light paths have $(row) without any"

finish
