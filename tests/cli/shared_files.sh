#!/usr/bin/env bash
# Files of other people and of other renders: nothing that is planted in a folder is followed or replaced, modes are
# kept, and of two renders to one image one wins whole.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
pairs=${ABBE_NIGHTLY:+100}
pairs=${pairs:-6}
scene=$scenes/room.scene
small=("$scene" --size 16x16 --samples 4 -q)

# Links under names that can be foreseen.
echo precious >precious
mkdir planted
for name in o.exr o.exr.ckpt o.exr.json o.png o.preview.png o.part1.abbe; do ln -s "$PWD/precious" "planted/$name.tmp"; done
expect 0 "${small[@]}" -o planted/o.exr --checkpoint keep
expect 0 "${small[@]}" -o planted/o.exr --part 1/1
expect 0 convert planted/o.exr planted/o.png
[[ $(cat precious) == precious ]] || fault "a file that a planted link points to was written"
for name in o.exr o.exr.ckpt o.exr.json o.png o.part1.abbe; do
    [[ -f planted/$name && ! -L planted/$name ]] || fault "$name became a link"
    [[ -L planted/$name.tmp ]] || fault "the link $name.tmp was replaced"
done

# Modes: a new file's by the umask, an older file's as it was.
mode() { stat -c %a "$1"; }
rm -rf planted/o.* && mkdir modes
(umask 027 && "$program" "${small[@]}" -o modes/o.exr --checkpoint keep)
for name in o.exr o.exr.ckpt o.exr.json o.png; do
    [[ $(mode modes/$name) == 640 ]] || fault "the mode of a new $name is $(mode modes/$name)"
done
chmod 604 modes/o.exr
chmod 600 modes/o.png
expect 0 "${small[@]}" -o modes/o.exr
[[ $(mode modes/o.exr) == 604 && $(mode modes/o.png) == 600 ]] || fault "modes: $(mode modes/o.exr) $(mode modes/o.png)"
cp "$bad/nine_mistakes.scene" fixed.scene
chmod 640 fixed.scene
expect 1 check --fix fixed.scene
[[ $(mode fixed.scene) == 640 ]] || fault "--fix gave a scene the mode $(mode fixed.scene)"

# A picture that somebody calls like the preview.
cp "$program" modes/slow.preview.png
expect 0 "$scene" --size 128x128 --samples 64 -q -o modes/slow.exr
cmp -s "$program" modes/slow.preview.png || fault "the preview replaced or removed a file"

# Two at once.
for seed in 1 2; do expect 0 "${small[@]}" -o "seed$seed.exr" --seed $seed; done
for ((pair = 0; pair < pairs; ++pair)); do
    for seed in 1 2; do
        "$program" "${small[@]}" -o both.exr --seed $seed --checkpoint 1ms >"out$seed" 2>"err$seed" &
        jobs[seed]=$!
    done
    for seed in 1 2; do wait "${jobs[seed]}" || fault "seed $seed beside another ended with $?: $(cat "err$seed")"; done
    [[ $(pixels both.exr) == "$(pixels seed1.exr)" || $(pixels both.exr) == "$(pixels seed2.exr)" ]] ||
        fault "two renders left an image of neither"
    [[ ! -e both.exr.ckpt ]] || fault "a checkpoint of finished renders is left"
    rm -f both.*
done
[[ -z $(find . -name '*.abbe-*') ]] || fault "temporary files are left: $(find . -name '*.abbe-*')"

# One that is done first leaves the other its checkpoint.
start both.exr "$scene" --size 32x32 --seed 1 --checkpoint 100ms
for _ in {1..100}; do [[ -e both.exr.ckpt ]] && break; sleep 0.1; done
kill -STOP "$job"
before=$(cksum <both.exr.ckpt)
expect 0 "${small[@]}" -o both.exr --seed 2 --checkpoint 10min
[[ $(cksum <both.exr.ckpt) == "$before" ]] || fault "a render removed the checkpoint of another one"
kill -CONT "$job"
kill -INT "$job"
ended_with 130

# One that goes on from a checkpoint, is ended again and was told to write none leaves the one that it had.
expect 0 "$scene" --size 32x32 --samples 4 -q -o off.exr --checkpoint keep
start off.exr "$scene" --size 32x32 --resume --checkpoint off
kill -INT "$job"
ended_with 130
[[ -s off.exr.ckpt ]] || fault "an unfinished render removed the checkpoint that it went on from"

finish
