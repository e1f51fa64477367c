#!/usr/bin/env bash
# A picture at once, pilots in proportion, and a time limit that is kept; nothing of it a matter of luck.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/caustic.scene

figure() { grep '"event":"done"' out | grep -o "\"$1\":[^,}]*" | head -n 1 | cut -d: -f2; } # NAME
pilot() { "$program" info "$1" | sed -n 's/^abbe.pilot = //p'; }                             # IMAGE
below() { awk -v a="$2" -v b="$3" 'BEGIN { exit !(a < b) }' || fault "$1: $2, at most $3"; } # WHAT A MOST

# Against the clock: told by the render's own, which other programs hold up little.
expect 0 "$scene" --samples 4000000 --time 2 --json -o timed.exr
below "seconds of a render of 2 s" "$(figure render_seconds)" 2.6
below "all but 2 s" 1.4 "$(figure render_seconds)"
below "seconds of its pilots" "$(figure pilot_seconds)" 0.3
says out '"pilot":'
[[ -n $(pilot timed.exr) ]] || fault "the header does not tell the pilots' size"

# Shown before the first sample, and gone when the image is there.
order=$(sed -n 's/.*"event":"\([a-z]*\)".*/\1/p' out | uniq | tr '\n' ' ')
[[ $order =~ start\ image\ progress ]] || fault "no picture before the first sample: $order"
says out '"path":"timed.preview.png","partial":true,"preview":true'
[[ ! -e timed.preview.png ]] || fault "the preview stays"
expect 0 "$scene" --samples 4000000 --time 0.5 --json --preview off -o off.exr
says_not out preview
start shown.exr "$scene"
[[ -s shown.preview.png ]] || fault "there is nothing to look at"
[[ ! -e shown.exr ]] || fault "the image is there before its time"
kill -INT "$job"
ended_with 130
[[ -s shown.exr && ! -e shown.preview.png ]] || fault "no image after Ctrl-C, or a preview"

# So short that not every pixel has a sample: none is black.
expect 0 "$scene" --size 1200x800 --samples 64 --time 0.4 -o short.exr
says err W0668
expect 0 info short.exr
grep -q "^abbe.pixelsOfFirstLook = [1-9]" out || fault "pixels without samples are not counted"
expect 0 "$scene" --size 1200x800 --samples 1 -q -o long.exr
expect 0 compare short.exr long.exr
grep -qi "nan" out && fault "pixels that are none"

# The same bits from one size of the pilots, asked for or chosen by work, by a clock or by another run.
small=(--size 32x24 --samples 256 -q)
expect 0 "$scene" "${small[@]}" -o work.exr
size=$(pilot work.exr)
expect 0 "$scene" "${small[@]}" --pilot "$size" -o asked.exr -t 1
same_pixels work.exr asked.exr
expect 0 "$scene" "${small[@]}" --pilot $((size % 4 + 1)) -o other.exr
[[ $(pixels work.exr) != $(pixels other.exr) ]] || fault "the size changes nothing"
expect 0 "$scene" "${small[@]}" --time 0.3 -o stopped.exr --checkpoint keep
size=$(pilot stopped.exr)
expect 1 "$scene" "${small[@]}" --pilot $(((size + 1) % 5)) -o stopped.exr --resume
tells err pilot: "\`$size\`" checkpoint
expect 0 "$scene" "${small[@]}" -o stopped.exr --resume
expect 0 "$scene" "${small[@]}" --pilot "$size" -o whole.exr
same_pixels stopped.exr whole.exr
for part in 1 2; do expect 0 "$scene" "${small[@]}" --pilot $part -o part.exr --part $part/2; done
expect 1 merge part.part{1,2}.abbe -o no.exr
tells err pilot: 2 1 part

# Small pilots for small pictures.
expect 0 "$scene" --size 24x24 --samples 16 --json -o tiny.exr
few=$(figure pilot_rays)
expect 0 "$scene" --size 24x24 --samples 16 --json --pilot 4 -o tiny.exr
below "rays of pilots of a small picture" $((4 * few)) "$(figure pilot_rays)"
expect 0 "$scene" --size 24x24 --samples 16 --pilot 0 -o none.exr
says err "no pilot looked for caustics"
expect 2 "$scene" --pilot 5

finish
