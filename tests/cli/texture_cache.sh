#!/usr/bin/env bash
# A set of textures renders within a cache that it does not fit into: the same bits as with room for all of it, in
# memory that the cache bounds.  texture_cache.sh PROGRAM JSON_LINES [MiB OF SET] [MiB OF CACHE]
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
set_mib=${3:-24} cache_mib=${4:-16}
size=1024 mib=3 # of a picture: 8 bits, three channels
((set_mib >= 256)) && size=4096 mib=48
count=$(((set_mib + mib - 1) / mib))

# shellcheck source=tests/cli/mosaic.sh
source "$scenes/../mosaic.sh"
make_set

# render NAME MIB ARGUMENT…: seconds of processors while rendering and MiB of memory at the peak, in `seconds` and
# `memory`.
render() {
    local name=$1 cache=$2
    shift 2
    timeout 3000 "$program" render set.scene --json --texture-cache "${cache}MiB" -o "$name.exr" "$@" >out 2>err || {
        fault "the render with a cache of $cache MiB failed:"
        tail -n 5 out err
    }
    seconds=$(sed -n 's/.*"event":"done".*"core_seconds":\([0-9.]*\).*/\1/p' out)
    memory=$(sed -n 's/.*"event":"done".*"memory_bytes":\([0-9]*\).*/\1/p' out)
    memory=$((${memory:-0} >> 20))
    printf '%s: cache of %d MiB, %.1f processor seconds, %d MiB of memory at the peak\n' "$name" "$cache" "$seconds" $memory
}
render converting 16 --size 8x8 # in a process of its own
render none 16                  # what all takes without tiles, within 16 MiB
none=$memory
render all 1000000
all=$memory all_seconds=$seconds
same_pixels all.exr none.exr
((all - none >= set_mib)) || fault "the set is only $((all - none)) MiB of tiles"
if ((cache_mib > 16)); then
    render bounded "$cache_mib"
    same_pixels all.exr bounded.exr
    # OpenImageIO drops tiles after it has read new ones.
    ((memory <= none + cache_mib + 32)) || fault "$memory MiB are more than $none and the cache of $cache_mib"
    awk -v a="$all_seconds" -v b="$seconds" -v n="$count" -v m=$((count * mib)) -v t=$((all - none)) \
        'BEGIN { printf "%d pictures, %d MiB, %d MiB of tiles; the cache costs a factor of %.2f\n", n, m, t, b / a }'
fi
finish
