#!/usr/bin/env bash
# How many samples a denoised picture stands for, scene by scene (docs/performance.md, "Denoising"):
#   bench/denoising.sh ABBE BENCH_DENOISING FOLDER [SCENE…]
# Renders go to FOLDER and are kept: a second run measures another denoiser on the same pictures. SIZE and REFERENCE set
# the longer side in pixels and the samples of the reference. With METHODS=1 the denoisers are compared on every number
# of SAMPLES, as rows of a table (docs/performance.md, "Three denoisers"); $ABBE_OIDN says where Open Image Denoise is.
set -euo pipefail
abbe=$1 bench=$2 folder=$3
shift 3
size=${SIZE:-256} reference=${REFERENCE:-2048}
root=$(cd "$(dirname "$0")/.." && pwd)
scenes=("$@")
[ $# -gt 0 ] || scenes=(cornell-box textures veach-mis shader-ball color-bleeding glass-caustic hair-ball
    subdivision-still-life jade-dragon many-lights)
mkdir -p "$folder"

# The scene with the layers, beside the files that it names.
layered() {
    sed -E '0,/^film *\{/s//film { layers { denoise };/' "$root/scenes/$1/$1.scene"
}

# Width and height of the scene's film, the longer one being $size.
dimensions() {
    grep -m1 -oE '^film *\{ *size +[0-9]+ +[0-9]+' "$root/scenes/$1/$1.scene" |
        awk -v s="$size" '{ w = $(NF - 1); h = $NF; k = s / (w > h ? w : h); printf "%dx%d", w * k + 0.5, h * k + 0.5 }'
}

render() { # scene, samples, seed, file
    [ -e "$4" ] && return
    "$abbe" render "$scene_file" --size "$(dimensions "$1")" --samples "$2" --seed "$3" --checkpoint off -q -o "$4"
}

for scene in "${scenes[@]}"; do
    scene_file=$root/scenes/$scene/.denoising-$$.scene
    trap 'rm -f "$scene_file"' EXIT
    layered "$scene" > "$scene_file"
    pictures=()
    for samples in ${SAMPLES:-64 128 256 512}; do
        pictures+=("$folder/$scene-$size-$samples.exr")
        render "$scene" "$samples" 1 "${pictures[-1]}"
    done
    render "$scene" "$reference" 2 "$folder/$scene-$size-reference.exr"
    rm -f "$scene_file"
    if [ -n "${METHODS:-}" ]; then
        # | scene | samples | FLIP noisy | preview | nfor | oidn | relMSE over noisy: nfor | oidn | estimate/truth: nfor | oidn |
        "$bench" --methods --picture "$folder/$scene-$size-methods.png" "$folder/$scene-$size-reference.exr" \
            "${pictures[@]}" | awk -F '\t' -v scene="$scene" '{
                printf "| %s | %d | %s | %s | %s | %s | %s | %s | %s | %s |\n",
                    scene, $1, $2, $3, $7, $11, $8, $12, $9, $13
                printf "# s/Mpx: preview %s nfor %s oidn %s\n", $6, $10, $14 > "/dev/stderr" }'
        continue
    fi
    echo "$scene"
    "$bench" --picture "$folder/$scene-$size.png" "$folder/$scene-$size-reference.exr" "${pictures[@]}"
done
