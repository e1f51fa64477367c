#!/usr/bin/env bash
# Dropped samples are counted, located and repeated; any sample can be, and those of a pixel add up to it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# A lamp so bright that what meets it is beyond all sums.
sed 's/^light lamp/light flare sphere { center 0.6 1.2 0; radius 1.5 cm; luminance 1e20 nits }\n&/' "$scenes/room.scene" >flare.scene
grep -q flare flare.scene || fault "no lamp in flare.scene"
expect 0 flare.scene --size 48x32 --samples 16 -o flare.exr
says err W0640
tells err "light \`flare\`" radiance
says err "abbe replay flare.scene --size 48x32 --pixel "
says err "flare.scene:" # where the lamp is declared
command=$(sed -n 's/.*`abbe \(replay [^`]*\)`.*/\1/p' err | head -n 1)
expect 0 info flare.exr
says out "abbe.droppedSamples = "

# Pixels that have lost all of theirs are not those of a render whose time ended.
sed 's/radius 1.5 cm; luminance 1e20/radius 30 cm; luminance 1e20/' flare.scene >glare.scene
expect 0 glare.scene --size 48x32 --samples 2 -o glare.exr
says err W0668
says err "all samples of some pixels were dropped"
says_not err "the time"

# The image tells what to repeat, and the command of the warning repeats the first of them.
expect 0 replay flare.exr
says out "hits the light \`flare\`"
says out "dropped: vertex 1, object \`flare\`"
cp out all
# shellcheck disable=SC2086
expect 0 $command
says out "dropped: vertex 1, object \`flare\`"
head -n "$(wc -l <out)" all | cmp -s - out || fault "the image and the command tell two stories"
expect 0 replay flare.exr --json
says out '"cause": "infinite"'
says out '"light": "flare"'

# --json of the render has the same.
expect 0 flare.scene --size 48x32 --samples 16 -o flare.exr --json
says out '"dropped_samples":[{"x":'
"$json_lines" <out >/dev/null || fault "events are no JSON lines"

# The samples of a pixel, each by itself, add up to its value: 2 replicates of 8.
expect 0 "$scenes/room.scene" --size 48x32 --samples 16 --pixel 20,11
wanted=$(sed -n 's/^XYZ //p' out)
for replicate in 0 1; do
    for index in {0..7}; do
        expect 0 replay "$scenes/room.scene" --size 48x32 --pixel 20,11 --sample $replicate:$index
        sed -n 's/^XYZ //p' out
    done
done >values
[[ $(wc -l <values) -eq 16 ]] || fault "$(wc -l <values) values instead of 16"
awk -v wanted="$wanted" '{ for (i = 1; i <= 3; ++i) sum[i] += $i / 16 }
    END { split(wanted, w); for (i = 1; i <= 3; ++i) { d = sum[i] - w[i]; if (d * d > 1e-14 * w[i] * w[i]) exit 1 } }' values ||
    fault "the mean of the samples is not the pixel, $wanted"
# Another seed, another sample; the same once more, the same.
expect 0 replay "$scenes/room.scene" --size 48x32 --pixel 20,11 --sample 1:7
cp out once
expect 0 replay "$scenes/room.scene" --size 48x32 --pixel 20,11 --sample 1:7 -t 1
cmp -s once out || fault "one thread tells another story"
expect 0 replay "$scenes/room.scene" --size 48x32 --pixel 20,11 --sample 1:7 --seed 9
cmp -s once out && fault "the seed makes no difference"

# What cannot be repeated.
expect 2 replay "$scenes/room.scene" --pixel 20,11 --sample 2:0
says err E0673
expect 2 replay "$scenes/room.scene" --pixel 2000,11 --sample 0:0
says err E0673
expect 2 replay "$scenes/room.scene" --pixel 20,11
says err E0674
expect 2 replay "$scenes/room.scene" --pixel 20,11 --sample 3
tells err --sample "\`3\`"
expect 3 replay missing.exr
expect 0 "$scenes/room.scene" --size 8x8 --samples 2 --quiet -o sound.exr
expect 0 replay sound.exr
tells err sound.exr dropped
is_empty out
sed -i 's/1e20/2e20/' flare.scene
expect 0 replay flare.exr
says err W0673

finish
