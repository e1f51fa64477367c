#!/usr/bin/env bash
# A set of textures renders within a cache that it does not fit into: the same bits as with room for all of it, in
# memory that the cache bounds.  texture_cache.sh PROGRAM JSON_LINES [MiB OF SET] [MiB OF CACHE]
# The picture is a mosaic: each piece shows a few texels out of the middle of another tile of another picture, so that
# all tiles are looked at in their finest level, in no order. Nothing of real scenes is as hard on a cache.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
set_mib=${3:-24} cache_mib=${4:-16}
size=1024 mib=3 # of a picture: 8 bits, three channels
((set_mib >= 256)) && size=4096 mib=48
count=$(((set_mib + mib - 1) / mib))

# The tiles of all pictures, dealt to the cells of a square of 1 m; a mesh for each picture.
mosaic() {
    awk -v count="$count" -v tiles=$((size / 64)) -v size=$size 'BEGIN {
        srand(1)
        n = count * tiles * tiles
        side = int(sqrt(n)); while (side * side < n) ++side
        for (i = 0; i < n; ++i) cell[i] = i
        for (i = n - 1; i > 0; --i) { j = int(rand() * (i + 1)); t = cell[i]; cell[i] = cell[j]; cell[j] = t }
        for (p = 0; p < count; ++p) {
            file = "mosaic" p ".ply"; quads = tiles * tiles
            print "ply\nformat ascii 1.0\nelement vertex " 4 * quads > file
            print "property float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v" > file
            print "element face " quads "\nproperty list uchar int vertex_indices\nend_header" > file
            for (q = 0; q < quads; ++q) {
                c = cell[p * quads + q]; x = c % side; y = int(c / side)
                u = (q % tiles + 0.5) * 64; v = (int(q / tiles) + 0.5) * 64
                for (k = 0; k < 4; ++k) {
                    dx = k == 1 || k == 2; dy = k >= 2
                    printf "%.7g %.7g 0 %.9g %.9g\n", (x + dx) / side, (y + dy) / side,
                           (u + 3 * dx) / size, (v + 3 * dy) / size > file
                }
            }
            for (q = 0; q < quads; ++q) print 4, 4 * q, 4 * q + 1, 4 * q + 2, 4 * q + 3 > file
            close(file)
        }
        print 3 * side # pixels across: one for each texel
    }'
}

scene() { # PIXELS
    printf 'scene 1\nfilm { size %d %d }\nrender { samples 4; max-depth 3 }\n' "$1" "$1"
    printf 'camera orthographic { from 0.5 0.5 2; look-at 0.5 0.5 0; up 0 1 0; width 1 }\nlight sky { luminance 1000 nits }\n'
    for ((p = 0; p < count; ++p)); do
        printf 'texture t%d image "noise%d.ppm"\n' $p $p
        printf 'shape mesh "mosaic%d.ply" { material diffuse { reflectance t%d } }\n' $p $p
    done
}

for ((p = 0; p < count; ++p)); do
    { printf 'P6\n%d %d\n255\n' $size $size && head -c $((size * size * 3)) /dev/urandom; } >noise$p.ppm
done
scene "$(mosaic)" >set.scene
# The tables of colours take seconds to make, where there are some.
mkdir -p cache/abbe
cp "${XDG_CACHE_HOME:-$HOME/.cache}"/abbe/upsampling-* cache/abbe/ 2>/dev/null
export XDG_CACHE_HOME=$PWD/cache
# The address sanitizer would keep the tiles that were dropped.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}quarantine_size_mb=1

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
