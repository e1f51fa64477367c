#!/usr/bin/env bash
# The first signal saves the image so far; the second one leaves at once and leaves what was there.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

start int.exr "$scenes/room.scene" --size 256x256
kill -INT "$job"
ended_with 130
expect 0 info int.exr
says out "abbe.partial = 1"
says out "256×256"
says events '"partial":true'
"$json_lines" <events >/dev/null || fault "events are no JSON lines"
[[ -z $(find . -name '*.tmp') ]] || fault "temporary files are left"

start term.exr "$scenes/room.scene" --size 256x256
kill -TERM "$job"
ended_with 143
expect 0 info term.exr
says out "abbe.partial = 1"

# The job is sent a signal, and ends with that code within a second and a half.
ends_soon() { # SIGNAL CODE
    local began=$EPOCHREALTIME
    kill "-$1" "$job"
    ended_with "$2"
    awk -v a="$began" -v b="$EPOCHREALTIME" 'BEGIN { exit !(b - a < 1.5) }' || fault "$1 took from $began to $EPOCHREALTIME"
}

# Ended before its first sample, while it looks at the frame, it leaves what is there: image, checkpoint and part.
room=$scenes/../../../scenes/check/hard/white-room.scene
expect 0 "$scenes/room.scene" --size 24x24 -q -o kept.exr --checkpoint keep
expect 0 "$scenes/room.scene" --size 24x24 -q -o kept.exr --part 1/2
sum() { cat kept.exr kept.exr.json kept.exr.ckpt kept.part1.abbe | cksum; }
kept=$(sum)
for part in "" "--part 1/2"; do
    : >events # not those of the last one: a job that has not begun must not be taken for one that renders
    # shellcheck disable=SC2086 # two words or none
    "$program" "$room" --size 640x480 --samples 4000000 -o kept.exr --checkpoint 50ms --json $part >events 2>err &
    job=$!
    for _ in {1..100}; do grep -q '"event":"start"' events && break || sleep 0.1; done
    sleep 0.15 # three times as long as a checkpoint waits, and less than a third of what the look takes
    ends_soon INT 130
    says events '"code":"W0648"'
    for file in kept.exr kept.part1.abbe; do says_not events '"event":"image","path":"'$file'"'; done
    says_not events W0641
    [[ $(sum) == "$kept" ]] || fault "a render without a sample changed files: $part"
done

# While it is built, too, though a shell has its jobs in the background ignore Ctrl-C.
awk 'BEGIN { n = 400
    for (i = 0; i < n * n; ++i) printf "v %g %g %g\n", i % n / n - 0.5, i * 7 % 17 * 0.001, int(i / n) / n - 0.5
    for (i = 1; i < n * (n - 1); ++i) if (i % n) printf "f %d %d %d\nf %d %d %d\n", i, i + 1, i + n, i + 1, i + n + 1, i + n }' >big.obj
printf 'scene 1\ncamera { from 0 2 0.1; look-at 0 0 0 }\nshape mesh { file "big.obj"; emission 10 }\n' >big.scene
: >events
"$program" big.scene --samples 4000000 -o kept.exr --json >events 2>err &
job=$!
for _ in {1..500}; do grep -q '"name":"reading"' events && break || sleep 0.01; done
ends_soon INT 130
[[ $(sum) == "$kept" ]] || fault "a render that was not built changed files"

# Within the samples of a tile, too: one of them takes longer than that here.
: >events
"$program" "$room" --size 16x16 --samples 4000000 --pilot 0 --json -o slow.exr >events 2>err &
job=$!
for _ in {1..600}; do grep -q '"event":"progress"' events && break || sleep 0.1; done
ends_soon TERM 143
says events '"partial":true'

# Along a ray, too, that looks up a density at every picometre.
for optics in "extinction 1e12 per-m; albedo 0.9" "scattering rgb 1e12 1e3 1 per-m"; do
    printf 'scene 1\ncamera { from 0 1 4; look-at 0 0 0 }\nlight sky\nlight sphere { center 0 3 0; radius 0.1; power 10 W }\n%s\n' \
        "volume noise { $optics }" >dense.scene
    : >events
    "$program" dense.scene --size 64x64 --samples 4000000 --json -o dense.exr >events 2>err &
    job=$!
    for _ in {1..100}; do grep -q '"event":"start"' events && break || sleep 0.1; done
    sleep 0.3
    ends_soon TERM 143
done

# So is the time limit; a time that is too short for anything says so.
expect 0 "$room" --size 16x16 --samples 1 --time 2 --json -o timed.exr
seconds=$(sed -n 's/.*"render_seconds":\([0-9.e+-]*\).*/\1/p' out)
awk -v s="$seconds" 'BEGIN { exit !(s < 2.6) }' || fault "--time 2 took $seconds s"
expect 4 "$scenes/room.scene" --time 1e-9 -o never.exr
says err E0669
[[ ! -e never.exr ]] || fault "a picture of nothing"

# A broken contract of the program itself ends with its own code.
start abort.exr "$scenes/room.scene" --size 256x256
kill -ABRT "$job"
ended_with 70
[[ ! -e abort.exr ]] || fault "an image in spite of a bug"

# An older image survives a render that is left at once. While the program is stopped both signals gather, so neither
# can be late; the order in which they are delivered does not matter.
expect 0 "$scenes/room.scene" --quiet -o old.exr
before=$(pixels old.exr)
start old.exr "$scenes/room.scene" --size 256x256
kill -STOP "$job"
kill -INT "$job"
kill -TERM "$job"
kill -CONT "$job"
wait "$job"
code=$?
[[ $code -eq 130 || $code -eq 143 ]] || fault "two signals ended with $code"
[[ $(pixels old.exr) == "$before" ]] || fault "the older image was lost"

finish
