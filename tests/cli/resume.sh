#!/usr/bin/env bash
# A render that is interrupted, killed or split has, once continued or put together, the bits of one that was not.
#   resume.sh PROGRAM JSON_LINES [KILLS]       three kills, 20 with ABBE_NIGHTLY set
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
kills=${3:-${ABBE_NIGHTLY:+20}}
kills=${kills:-3}
scene=$scenes/layers.scene
small=(--size 40x24 --samples 120)

expect 0 "$scene" "${small[@]}" --quiet -o whole.exr
[[ ! -e whole.exr.ckpt ]] || fault "a finished render leaves its checkpoint"

# Killed at any moment, as often as need be.
survives_kills "$kills" "$scene" --size 40x24 --samples $((270 * kills))
survives_kills "$kills" "$scenes/uneven.scene" --samples $((90 * kills))

# Four parts of the samples, in any order.
for part in 3 1 4 2; do expect 0 "$scene" "${small[@]}" --quiet -o split.exr --part $part/4; done
expect 0 merge split.part4.abbe split.part1.abbe split.part3.abbe split.part2.abbe -o merged.exr
same_pixels whole.exr merged.exr
same_pixels whole.deep.exr merged.deep.exr
same_certificate whole.exr merged.exr
expect 0 info merged.exr
says out "abbe.parts = 4"
says out "abbe.samples = 120"
says out "abbe.partial = 0"
expect 1 merge split.part1.abbe split.part2.abbe split.part4.abbe -o no.exr
says err E0664
tells err E0664 30 45 60
expect 1 merge split.part{1,2,3,4,2}.abbe -o no.exr
tells err E0664 split.part2.abbe
expect 0 "$scene" "${small[@]}" --quiet -o other.exr --part 4/4 --seed 3
expect 1 merge split.part{1,2,3}.abbe other.part4.abbe -o no.exr
says err E0663
tells err seed: "\`3\`" part

# Crops, and crops split by samples.
expect 0 "$scene" "${small[@]}" --quiet -o left.exr --part 1/1 --crop 0,0,21,24
expect 0 "$scene" "${small[@]}" --quiet -o right.exr --part 1/2 --crop 21,0,40,24
expect 0 "$scene" "${small[@]}" --quiet -o right.exr --part 2/2 --crop 21,0,40,24
expect 0 merge left.part1.abbe right.part{1,2}.abbe -o crops.exr
same_pixels whole.exr crops.exr
same_pixels whole.deep.exr crops.deep.exr
same_certificate whole.exr crops.exr
expect 1 merge left.part1.abbe right.part1.abbe -o no.exr
says err "at pixel 21,0"

# A finished render is continued by more samples; asked again for no more than it has, it is done.
expect 0 "$scene" --size 40x24 --samples 50 --quiet -o more.exr --checkpoint keep
[[ -s more.exr.ckpt ]] || fault "--checkpoint keep"
expect 0 "$scene" "${small[@]}" --quiet -o more.exr --checkpoint keep --resume
same_pixels whole.exr more.exr
rm more.exr
expect 0 "$scene" --size 40x24 --samples 50 --quiet -o more.exr --checkpoint keep --resume
same_pixels whole.exr more.exr

# Samples spread by a plan: parts and crops have the plan of the whole.
adaptive=("$scenes/uneven.scene" --samples 46 --quiet)
expect 0 "${adaptive[@]}" -o planned.exr
expect 0 info planned.exr
says out "abbe.adaptive = frozen plan (unbiased)"
least=$(sed -n 's/^abbe.samplesFewest = //p' out)
most=$(sed -n 's/^abbe.samplesMost = //p' out)
((${least%.*} < ${most%.*})) || fault "the plan is even: $least to $most"
for part in 3 1 4 2; do expect 0 "${adaptive[@]}" -o plan.exr --part $part/4; done
expect 0 merge plan.part4.abbe plan.part1.abbe plan.part3.abbe plan.part2.abbe -o merged.exr
same_pixels planned.exr merged.exr
expect 0 info merged.exr
says out "abbe.samplesMost = $most"
expect 0 "${adaptive[@]}" -o left.exr --part 1/1 --crop 0,0,29,48
for part in 1 2; do expect 0 "${adaptive[@]}" -o right.exr --part $part/2 --crop 29,0,72,48; done
expect 0 merge left.part1.abbe right.part{1,2}.abbe -o crops.exr
same_pixels planned.exr crops.exr
expect 0 "${adaptive[@]}" -o off.exr --part 4/4 --adaptive off
expect 1 merge plan.part{1,2,3}.abbe off.part4.abbe -o no.exr
tells err adaptive: "\`off\` in the part" "\`on\`"
expect 1 "$scene" "${small[@]}" --quiet -o more.exr --resume --adaptive on
tells err adaptive: "\`off\` in the checkpoint" "\`on\`"

# Another scene, another film: what differs, with both values.
sed 's/luminance [0-9]*/luminance 4321/; s/power [0-9]*/power 4321/' "$scene" >other.scene
expect 1 other.scene "${small[@]}" --quiet -o more.exr --resume
says err E0663
says err "4321"
expect 1 "$scene" "${small[@]}" --quiet -o more.exr --resume --seed 5
tells err seed: "\`0\` in the checkpoint" "\`5\`"
expect 1 "$scene" "${small[@]}" --quiet -o more.exr --resume --crop 0,0,9,9
tells err crop: "\`0 0 40 24\`"

# Damage is found, wherever it is.
size=$(stat -c %s more.exr.ckpt)
at=$((size / 2)) # all other places: tests/unit/app/checkpoint_test.cpp
cp more.exr.ckpt bad.exr.ckpt
byte=$(od -An -tu1 -j "$at" -N1 bad.exr.ckpt)
printf "\\x$(printf %x $(((byte + 1) % 256)))" | dd of=bad.exr.ckpt bs=1 seek="$at" conv=notrunc status=none
expect 1 "$scene" "${small[@]}" --quiet -o bad.exr --resume
says err "bad.exr.ckpt"
[[ ! -e bad.exr ]] || fault "an image from a damaged checkpoint"
says err E0662
cp "$scene" bad.exr.ckpt
expect 1 "$scene" "${small[@]}" --quiet -o bad.exr --resume
says err E0661
expect 0 "$scene" --size 8x8 --samples 1 -o none.exr --resume
says err W0664

# SIGUSR1 and SIGHUP write a snapshot and the render goes on; Ctrl-C saves and says how to go on.
start signals.exr "$scene" --size 40x24
for signal in USR1 HUP; do
    rm -f signals.exr signals.exr.ckpt
    kill -$signal "$job"
    for _ in {1..100}; do
        [[ -e signals.exr && -e signals.exr.ckpt ]] && break
        sleep 0.1
    done
    [[ -e signals.exr && -e signals.exr.ckpt ]] || fault "no snapshot after SIG$signal"
    expect 0 info signals.exr
    says out "abbe.partial = 1"
    kill -0 "$job" 2>/dev/null || fault "SIG$signal ended the render"
done
kill -INT "$job"
ended_with 130
says err "to go on:  abbe "
says err "--resume"
[[ -s signals.exr.ckpt ]] || fault "no checkpoint after Ctrl-C"
expect 0 "$scene" --size 40x24 --samples 4 -o signals.exr --resume --quiet # it has many more
expect 0 info signals.exr
says out "abbe.partial = 0"
start term.exr "$scene" --size 40x24
kill -TERM "$job"
ended_with 143
expect 0 "$scene" --size 40x24 --samples 4 -o fresh.exr --quiet --checkpoint keep
mv fresh.exr.ckpt stale.exr.ckpt
expect 0 "$scene" --size 40x24 --samples 4 -o stale.exr
says err W0663

# A checkpoint that cannot be written ends nothing, and the image is there.
mkdir full.exr.ckpt
expect 0 "$scene" "${small[@]}" -o full.exr --checkpoint 1ms
says err W0662
[[ $(grep -c 'W0662\]' err) -eq 1 ]] || fault "told more than once"
same_pixels whole.exr full.exr
[[ -z $(find . -name '*.tmp') ]] || fault "temporary files are left"

finish
