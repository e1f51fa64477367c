#!/usr/bin/env bash
# What effects cost scenes that do not ask for them: the program is built a second time with all effects of the path loop
# left out (CMake option ABBE_WITHOUT), and must then take at least 98 % of the instructions for the same pixels.
#   tests/compiled_out.sh PROGRAM BUILD_FOLDER     PROGRAM: a release build; BUILD_FOLDER: kept, for the second build
# Instructions, counted by callgrind, do not depend on what else the machine does. Those of one sample: of a render of 48
# samples less those of one with 16, so that reading and building the scene is not in them.
set -euo pipefail
root=$(cd "$(dirname -- "$0")/.." && pwd)
program=$(realpath -- "$1")
folder=$2
scene=$root/scenes/cornell-box/cornell-box.scene

cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release -DABBE_TESTS=OFF \
    '-DABBE_WITHOUT=absorption;dispersion;media;textures;interfaces' >/dev/null
cmake --build "$folder" --target abbe
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

count() { # PROGRAM SAMPLES: instructions
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$1" render "$scene" --quiet -t 1 --size 32x32 --samples "$2" \
        --checkpoint off -o "$scratch/a.exr" 2>&1 | sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}
with=$(($(count "$program" 48) - $(count "$program" 16)))
without=$(($(count "$folder/abbe" 48) - $(count "$folder/abbe" 16)))
"$program" render "$scene" --quiet --size 32x32 --samples 16 --checkpoint off -o "$scratch/with.exr"
"$folder/abbe" render "$scene" --quiet --size 32x32 --samples 16 --checkpoint off -o "$scratch/without.exr"
"$program" compare "$scratch/with.exr" "$scratch/without.exr" --threshold 0 >/dev/null ||
    { echo "the pixels differ"; exit 1; }
awk -v a="$with" -v b="$without" 'BEGIN {
    printf "instructions of a sample: %.1f with all effects built in, %.1f without: %+.2f %%\n", a / 32768, b / 32768, 100 * (a / b - 1)
    exit a > 1.02 * b
}'
if "$folder/abbe" check "$root/scenes/prism/prism.scene" >"$scratch/check" 2>&1 || ! grep -q E0685 "$scratch/check"; then
    echo "a scene that needs what the build lacks was taken"
    exit 1
fi
