#!/usr/bin/env bash
# A hash of the pixels of every shipped scene, all channels, small and with few samples. A refactoring changes none:
#   tests/pixel_hashes.sh PROGRAM >before; (change, build); tests/pixel_hashes.sh PROGRAM | diff before -
#   tests/pixel_hashes.sh PROGRAM NAME…    only scenes whose path contains one of the names
# Prints "HASH SCENE" a line, HASH being the exit code where the program ends otherwise; a quarter of an hour of two threads for all.
set -uo pipefail
root=$(cd "$(dirname -- "$0")/.." && pwd)
program=$(realpath -- "$1")
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

wanted() { # SCENE NAME…
    local scene=$1 name
    shift
    (($#)) || return 0
    for name in "$@"; do [[ $scene == *"$name"* ]] && return 0; done
    return 1
}

cd "$root" || exit 3
while IFS= read -r scene; do
    wanted "$scene" "$@" || continue
    rm -f "$scratch"/image.*
    # Pilots see light paths, photons and glints at this size and number of samples where they pay in the picture as shipped.
    "$program" render "$scene" --quiet --size 64x48 --samples 32 --checkpoint off -o "$scratch/image.exr" >/dev/null 2>"$scratch/err"
    result=$?
    hash=$("$program" info "$scratch/image.exr" 2>/dev/null | sed -n 's/^pixels *//p')
    printf '%s %s\n' "${hash:-exit $result: $(head -n 1 "$scratch/err")}" "$scene"
done < <(find scenes -name '*.scene' | LC_ALL=C sort)
