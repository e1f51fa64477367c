#!/usr/bin/env bash
# Whatever a path leads to, a pipe that nobody writes to, a device without an end, a picture of a few hundred bytes that
# promises millions of pixels: every command that reads it ends at once, with a message that names it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$PWD/cache

# refuses CODE ARGUMENT…: the program ends with that code within seconds and within little memory.
refuses() {
    local wanted=$1 code
    shift
    timeout 10 "$program" "$@" >out 2>err </dev/null
    code=$?
    [[ $code -eq $wanted ]] && return 0
    fault "abbe $* ended with $code instead of $wanted"
    sed 's/^/    /' out err
}

mkfifo fifo fifo.exr fifo.vdb fifo.ckpt
export ABBE_PATH=/dev # what is tested is what becomes of these, not that scenes may not name them
ln -s /dev/zero zero
ln -s /dev/zero zero.exr
ln -s /dev/zero zero.vdb
scene() { # LINE…
    printf 'scene 1\ncamera\nlight sky\n' >bounds.scene
    printf '%s\n' "$@" >>bounds.scene
}
for file in fifo zero; do
    scene "shape mesh \"$file\" { material diffuse { } }" "light ies \"$file\"" "light environment \"$file\"" \
        "texture t image \"$file\"" "camera gltf \"$file\"" \
        "volume v vdb \"$file\" { extinction 1 per-m; albedo 0.9 }" \
        "shape sphere { material diffuse { reflectance table \"$file\" } }"
    refuses 1 check --format=short bounds.scene
    [[ $(grep -c "\`$file\` is not a regular file" err) -ge 6 ]] || fault "not all uses of $file are told: $(cat err)"
    refuses 3 check "$file"
    says err "regular file"
    refuses 3 render "$file" -o no.exr
    refuses 3 info $file.exr
    tells err "$file.exr" "regular file"
    refuses 3 convert $file.exr no.png
    tells err "$file.exr" "regular file"
    refuses 3 compare $file.exr $file.exr
    refuses 3 denoise $file.exr -o no.exr
    refuses 3 volume info $file.vdb
    refuses 3 merge -o no.exr $file
    says err "regular file"
done
(timeout 10 "$program" check - </dev/zero >out 2>err)
[[ $? -eq 3 ]] || fault "zeros without an end as a scene: $(cat err)"
mv fifo.ckpt no.exr.ckpt
refuses 3 render "$scenes/room.scene" --samples 1 --resume -o no.exr
tells err no.exr.ckpt "regular file"
[[ ! -e no.exr ]] || fault "an image of nothing"

# le32 NUMBER…: least byte first.
le32() {
    local n
    for n; do
        printf "\\x$(printf %02x $((n & 255)))\\x$(printf %02x $((n >> 8 & 255)))\\x$(printf %02x $((n >> 16 & 255)))"
        printf "\\x$(printf %02x $((n >> 24 & 255)))"
    done
}
attribute() { # NAME TYPE SIZE
    printf '%s\0%s\0' "$1" "$2"
    le32 "$3"
}
# promise SIDE: an OpenEXR file that says that it has SIDE by SIDE pixels of three channels, compressed by dwab.
promise() {
    le32 20000630 2
    attribute channels chlist 55
    for channel in B G R; do
        printf '%s\0' $channel
        le32 1 0 1 1
    done
    printf '\0'
    attribute compression compression 1
    printf '\x09'
    for window in dataWindow displayWindow; do
        attribute $window box2i 16
        le32 0 0 $(($1 - 1)) $(($1 - 1))
    done
    attribute lineOrder lineOrder 1
    printf '\0'
    attribute pixelAspectRatio float 4
    printf '\0\0\x80\x3f'
    attribute screenWindowCenter v2f 8
    printf '\0\0\0\0\0\0\0\0'
    attribute screenWindowWidth float 4
    printf '\0\0\x80\x3f\0'
    head -c 300 /dev/zero
}
promise 16384 >tiny.exr
(
    at_most 4000000
    for words in "info tiny.exr" "convert tiny.exr no.png" "denoise tiny.exr -o no.exr" "compare tiny.exr tiny.exr"; do
        # shellcheck disable=SC2086 # words of the command
        refuses 3 $words
        tells err tiny.exr damaged
    done
    scene "light environment \"tiny.exr\"" "shape sphere { material diffuse { reflectance image \"tiny.exr\" } }"
    refuses 1 check --textures --format=short bounds.scene
    [[ $(grep -c "cannot be in" err) -eq 2 ]] || fault "two uses of tiny.exr: $(cat err)"
    exit "$faults"
) || faults=$((faults + 1))

# Pictures of 268 million pixels in three megabytes: refused before anything is decoded where they have to be in memory
# at once; else read in pieces, within what is allowed, and left at once when that is wanted.
nodejs "$scenes/../bombs.mjs" . || fault "no bombs"
(($(stat -c %s bomb.exr) < 4000000 && $(stat -c %s bomb.png) < 1000000)) || fault "the bombs are no small files"
sanitized || (
    at_most 1500000
    for words in "convert bomb.exr no.png" "denoise bomb.exr -o no.exr" "compare bomb.exr bomb.exr"; do
        # shellcheck disable=SC2086 # words of the command
        refuses 3 $words
        says err "cannot read \`bomb.exr\`: it takes 3.00 GiB of memory"
    done
    exit "$faults"
) || faults=$((faults + 1))
scene "light environment \"bomb.exr\""
refuses 1 render bounds.scene --memory 512MiB -o no.exr
says err "bounds.scene:4:"
says err "E0402"
says err "of memory"
# left_at_once ARGUMENT…: has taken little memory when a second has passed, and ends within another one when told to.
left_at_once() {
    local began peak
    "$program" "$@" >out 2>err &
    job=$!
    sleep 1
    peak=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\) kB/\1/p' /proc/$job/status)
    began=$EPOCHREALTIME
    kill -TERM "$job" || fault "abbe $* has ended by itself: $(cat err)"
    ended_with 143
    awk -v a="$began" -v b="$EPOCHREALTIME" 'BEGIN { exit !(b - a < 1.5) }' || fault "abbe $*: left from $began to $EPOCHREALTIME"
    sanitized || ((${peak:-0} > 0 && peak < most)) || fault "abbe $*: ${peak:-no} kB of memory"
    printf "%s: %s kB\n" "$*" "$peak"
}
most=524288 # kB
for kind in exr png; do
    scene "shape sphere { material diffuse { reflectance image \"bomb.$kind\" } }"
    left_at_once render bounds.scene --memory 512MiB -o no.exr
done
# Nothing of it is decoded for a fingerprint; all else is told.
(
    at_most 1000000
    expect 0 info bomb.exr
    says out "size         16384×16384"
    says out "pixels       not read"
    expect 0 info bomb.exr --json
    says out '"pixels": null'
    exit "$faults"
) || faults=$((faults + 1))
[[ ! -e no.exr && ! -e no.png ]] || fault "a picture of a bomb"

finish
