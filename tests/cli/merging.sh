#!/usr/bin/env bash
# Merged light is under the same contracts as all other: the same bits for any threads, crops, parts and interruptions;
# its bias is told.
#   merging.sh PROGRAM JSON_LINES
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/merging.scene
sed 's/samples 32/samples 32; merging off/' "$scene" >off.scene
sed 's/samples 32/samples 32; merging always/' "$scene" >always.scene

same_for_threads_and_kernels "$scene" whole.exr
expect 0 off.scene -q -o off.exr
[[ $(pixels whole.exr) != $(pixels off.exr) ]] || fault "merging brings nothing"

# Parts of the samples and of the picture.
for part in 3 1 2; do expect 0 "$scene" -q -o split.exr --part $part/3; done
expect 0 merge split.part{2,3,1}.abbe -o merged.exr
same_pixels whole.exr merged.exr
same_certificate whole.exr merged.exr
expect 0 info merged.exr
says out "abbe.estimator = consistent"
expect 0 "$scene" -q -o left.exr --part 1/1 --crop 0,0,21,36
for part in 1 2; do expect 0 "$scene" -q -o right.exr --part $part/2 --crop 21,0,48,36; done
expect 0 merge left.part1.abbe right.part{1,2}.abbe -o crops.exr
same_pixels whole.exr crops.exr
expect 0 off.scene -q -o choice.exr --part 2/2 --crop 21,0,48,36
expect 1 merge left.part1.abbe right.part1.abbe choice.part2.abbe -o no.exr
says err E0663

# A render that is killed goes on to the same bits.
survives_kills 3 "$scene" --samples 160
expect 0 "$scene" --samples 16 -q -o more.exr --checkpoint keep
expect 0 "$scene" -q -o more.exr --checkpoint keep --resume
same_pixels whole.exr more.exr

# One pixel is that of the picture.
expect 0 "$scene" --pixel 20,14
cp out pixel
expect 0 "$scene" --pixel 20,14 -t 1
cmp -s pixel out || fault "--pixel differs"

# Told: that it is biased, by how much, and what would be missing without it.
expect 0 "$scene" -o told.exr
tells err merging biased
grep -q "merged light [0-9.]* % .* [0-9]* rounds.*unbiased" err ||
    fault "no line for merged light: $(cat err)"
expect 0 info told.exr
says out "abbe.estimator = consistent"
says out "abbe.mergedBiasOfTiles = "
says out "bias         merged light"
grep -q '"estimator": "consistent"' told.exr.json || fault "no estimator in the certificate"
expect 0 "$scene" -o told.exr --json
says out '"rounds":'
"$json_lines" <out >/dev/null || fault "events are no JSON lines"
expect 0 explain "$scene"
tells out "camera paths" lamp
cp out first
expect 0 explain "$scene"
cmp -s first out || fault "explain says something else the second time"
expect 0 explain "$scene" --json
says out '"never_found":'
expect 0 off.scene -o told.exr
says_not err "merged light"
expect 0 info told.exr
says_not out "abbe.estimator"

# Light that a medium scatters behind the mirror is merged, too.
haze='shape haze box { min -1 0.1 -0.7; max 1 1.8 0.9; material boundary; interior homogeneous { extinction 0.1 per-m; albedo 0.9 } }'
sed "\$ a $haze" always.scene >haze.scene
sed "\$ a $haze" off.scene >unmerged.scene
expect 0 haze.scene -q -o haze.exr -t 1 --samples 8
expect 0 haze.scene -q -o threads.exr -t 2 --samples 8
same_pixels haze.exr threads.exr
same_certificate haze.exr threads.exr
expect 0 unmerged.scene -q -o off.exr --samples 8
[[ $(pixels haze.exr) != $(pixels off.exr) ]] || fault "merging in haze brings nothing"

# The cost report with light paths.
expect 0 "$scene" --json --samples 192 -o cost.exr -t 1
grep '"event":"done"' out | grep -o '"accounted":[0-9.]*' | awk -F: '{ exit !($2 > 0.95 && $2 < 1.05) }' ||
    fault "the rows do not add up"

finish
