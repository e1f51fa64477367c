#!/usr/bin/env bash
# What ends a render that had a lot done: too much memory, a texture that goes away, a full disk. Each says what was
# saved, and what is continued from that has the bits of a render that nothing happened to.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
size=1024 count=16
# shellcheck source=tests/cli/mosaic.sh
source "$scenes/../mosaic.sh"

# Before the first sample: with what takes how much.
room=$scenes/room.scene
expect 5 "$room" --memory 16MiB -o no.exr
says err E0675
tells err scene "16 MiB"
expect 5 "$room" --size 8000x8000 --memory 1GiB -o no.exr
says err E0650
tells err E0650 "8000×8000"
expect 2 "$room" --memory lots -o no.exr
tells err --memory "\`lots\`"
[[ ! -e no.exr ]] || fault "an image in spite of too little memory"
expect 0 "$room" --samples 2 --memory 100GiB --quiet -o yes.exr

# Before more pilots of path guiding are sent.
sed 's/^render .*/render { samples 64; guiding always }/' "$scenes/../../../scenes/door-ajar/door-ajar.scene" >guided.scene
allowed=200MiB
! sanitized || allowed=450MiB # the program itself is larger
expect 5 guided.scene --size 256x256 --pilot 30 --memory "$allowed" --quiet -o guided.exr
says err E0665
says err "pilots of path guiding"

make_set
# Long enough for several looks at the memory; one thread, so that machines with many do not make it short.
long=(set.scene -t 1 --samples "${ABBE_MEMORY_SAMPLES:-48}" --checkpoint 200ms)
memory_of() { sed -n 's/.*"event":"done".*"memory_bytes":\([0-9]*\).*/\1/p' out; }
expect 0 "${long[@]}" --texture-cache 1000000MiB --json -o whole.exr
all=$(($(memory_of) >> 20))
expect 0 set.scene --size 8x8 --samples 1 --texture-cache 16MiB --json -o none.exr
none=$(($(memory_of) >> 20))
((all > none + 24)) || fault "tiles take only $((all - none)) MiB"

# Tiles of textures take more than is allowed: the render ends, and goes on with more.
expect 5 "${long[@]}" --texture-cache 1000000MiB --memory $(((none + all) / 2))MiB -o budget.exr
says err E0665
says err "\`budget.exr\`"
says err "\`budget.exr.ckpt\`"
expect 0 info budget.exr
says out "abbe.partial = 1"
expect 0 "${long[@]}" --texture-cache 1000000MiB --resume --quiet -o budget.exr
same_pixels whole.exr budget.exr

# The files of the textures go away: the pictures themselves, and what was made of them for rendering.
start lost.exr set.scene -t 1 --texture-cache 16MiB --checkpoint 200ms
for _ in {1..100}; do
    [[ -e lost.exr.ckpt ]] && break
    sleep 0.1
done
mkdir away
mv noise*.ppm away
find cache/abbe/textures -type f -exec truncate -s 100 {} +
ended_with 1
says events '"code":"E0666"'
tells events E0666 "\`lost.exr\`"
says events "go on with \`--resume\`"
expect 0 info lost.exr
says out "abbe.partial = 1"
[[ -s lost.exr.ckpt ]] || fault "no checkpoint from before the textures were lost"
expect 1 "${long[@]}" --texture-cache 16MiB --resume -o lost.exr # they are still away
mv away/noise*.ppm .
expect 0 "${long[@]}" --texture-cache 16MiB --resume --quiet -o lost.exr
same_pixels whole.exr lost.exr

# The system gives no more, just when the image is to be written: by the least memory with which a render begins.
if [[ $(uname -m) == x86_64 ]] && ! sanitized; then # sanitizers reserve terabytes
    large=("$room" --size 1000x1000 --samples 2 -t 1 --checkpoint 1h --pilot 0) # pilots of guiding take more than the image
    for ((kib = 200000; kib < 1000000; kib += 6000)); do
        (ulimit -v $kib && timeout 120 "$program" "${large[@]}" -o short.exr >out 2>err)
        code=$?
        [[ $code -eq 5 ]] || fault "$kib KiB of memory ended with $code: $(cat err)"
        [[ $code -ne 5 || -e short.exr.ckpt ]] && break
    done
    says err E0665
    tells err memory "\`short.exr.ckpt\`"
    [[ ! -e short.exr ]] || fault "an image without the memory for it"
    expect 0 "${large[@]}" --resume --quiet -o short.exr
    expect 0 "${large[@]}" --quiet -o enough.exr
    same_pixels enough.exr short.exr
fi

# No file may be larger than this: a full disk. The image does not fit anywhere; the message says so.
(
    ulimit -f 16 # KiB
    expect 3 "$room" --size 200x200 --samples 2 --quiet -o full.exr
    says err "full.exr"
    says err elsewhere
    exit "$faults"
) || faults=$((faults + 1))
[[ ! -e full.exr ]] || fault "half an image"
[[ -z $(find . -name '*.tmp') ]] || fault "temporary files are left"

finish
