# shellcheck shell=bash
# Shared by tests of textures that do not fit into their cache: a picture for each of `count` textures, and a mosaic that
# shows a few texels out of the middle of another tile of another picture in each of its pieces, so that all tiles are
# looked at in their finest level, in no order. Nothing of real scenes is as hard on a cache.
# Requires: count, the number of pictures; size, their pixels across.
# shellcheck disable=SC2154

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

# Pictures, meshes and set.scene, in the present folder, with a cache of its own.
make_set() {
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
}
