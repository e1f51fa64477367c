#!/usr/bin/env bash
# Files of other people and of other renders: nothing that is planted in a folder is followed or replaced, modes are
# kept, and of two renders to one image one wins whole.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
pairs=${ABBE_NIGHTLY:+100}
pairs=${pairs:-12}
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

# Files of somebody else under names that follow from that of the image: none is replaced.
mkdir mine
for name in o.exr.json o.exr.ckpt o.part1.abbe o.png; do echo "my $name" >"mine/$name"; done
expect 1 "${small[@]}" -o mine/o.exr
says err E0661
says err "\`mine/o.exr.ckpt\` is there already"
[[ ! -e mine/o.exr ]] || fault "refused, and rendered all the same"
expect 1 "${small[@]}" -o mine/o.exr --part 1/1
says err "\`mine/o.part1.abbe\` is there already"
expect 0 "$scene" --size 16x16 --samples 4 -o mine/o.exr --checkpoint off
says err W0667
says err "\`mine/o.exr.json\` is there already"
says err W0646
[[ -s mine/o.exr ]] || fault "there is no image"
for name in o.exr.json o.exr.ckpt o.part1.abbe o.png; do
    [[ $(cat "mine/$name") == "my $name" ]] || fault "mine/$name was replaced"
done
# Where a view is asked for: an error before rendering. So it is for a deep image, which cannot be left out.
expect 1 "${small[@]}" -o mine/o.exr --checkpoint off --exposure 1
says err E0430
says err "\`mine/o.png\` is there already"
sed 's/^film *{/film { layers { deep }; /' "$scene" >deep.scene
grep -q "layers { deep }" deep.scene || fault "no film in $scene"
cp mine/o.exr mine/before.exr
for other in "echo my deep" "cat mine/o.exr"; do
    $other >mine/o.deep.exr
    cp mine/o.deep.exr mine/kept
    expect 1 deep.scene --size 16x16 --samples 4 -q -o mine/o.exr --checkpoint off --png off
    says err E0430
    says err "\`mine/o.deep.exr\` is there already"
    cmp -s mine/o.deep.exr mine/kept || fault "mine/o.deep.exr was replaced"
    cmp -s mine/o.exr mine/before.exr || fault "refused, and the image was replaced"
done
[[ $(cat mine/o.png) == "my o.png" ]] || fault "mine/o.png was replaced"
rm mine/*
for run in 1 2; do # its own is replaced
    expect 0 deep.scene --size 16x16 --samples 4 --seed $run -q -o mine/o.exr
    [[ -s mine/o.deep.exr ]] || fault "there is no deep image"
done
rm mine/*
for run in 1 2; do # its own are
    expect 0 "$scene" --size 16x16 --samples 4 --seed $run -o mine/o.exr --checkpoint keep
    says_not err W0667
    grep -q "\"seed\": $run," mine/o.exr.json || fault "the certificate of an earlier render stays"
    expect 0 "${small[@]}" --part 1/1 -o mine/o.exr
done

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
    whose=0
    for seed in 1 2; do [[ $(pixels both.exr) == "$(pixels seed$seed.exr)" ]] && whose=$seed; done
    ((whose > 0)) || fault "two renders left an image of neither"
    cmp -s both.png seed$whose.png || fault "the PNG beside the image of seed $whose is not of it"
    grep -q "\"seed\": $whose," both.exr.json || fault "the certificate beside the image of seed $whose is not of it"
    [[ ! -e both.exr.ckpt ]] || fault "a checkpoint of finished renders is left"
    rm -f both.*
done
[[ -z $(find . -name '*.abbe-*') ]] || fault "temporary files are left: $(find . -name '*.abbe-*')"

# Two images with one PNG: it is that of one of them, whole.
for ((pair = 0; pair < pairs / 3; ++pair)); do
    for seed in 1 2; do
        "$program" "${small[@]}" -o "own$seed.exr" --seed $seed --png=shared.png 2>"err$seed" &
        jobs[seed]=$!
    done
    for seed in 1 2; do wait "${jobs[seed]}" || fault "seed $seed with the PNG of another ended with $?: $(cat "err$seed")"; done
    cmp -s shared.png seed1.png || cmp -s shared.png seed2.png || fault "the PNG of two renders is of neither"
done
[[ -z $(find . -name '*.abbe-*') ]] || fault "temporary files are left: $(find . -name '*.abbe-*')"

# While another one writes, none of its files is written; then all are, and the lock is gone.
flock wait.exr.abbe-lock sleep 3 &
holder=$!
sleep 0.5
"$program" "${small[@]}" -o wait.exr &
job=$!
sleep 1.5
[[ ! -e wait.exr && ! -e wait.exr.json && ! -e wait.png ]] || fault "files were written while another render wrote its own"
ended_with 0
kill -0 $holder 2>/dev/null && fault "written before the other render was done"
[[ -s wait.exr && -s wait.exr.json && -s wait.png ]] || fault "files are missing after the other render was done"
[[ ! -e wait.exr.abbe-lock ]] || fault "the lock stays"

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
