#!/usr/bin/env bash
# Renders every material of the library on the shader ball and puts the pictures together on one sheet.
#   tools/contact_sheet.sh [-b BUILD] [-o SHEET.png] [-s PIXELS] [-n SAMPLES] [-t THREADS] [-w WORK] [NAME …]
# BUILD holds `abbe` and `contact_sheet` (build/dev); without names all presets are shown. Pictures that WORK already
# holds are kept: remove it to render anew.
set -euo pipefail
root=$(cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.." && pwd)
build=$root/build/dev sheet=$root/docs/images/materials.png size=128 samples=64 threads=0 work=
while getopts b:o:s:n:t:w: option; do
    case $option in
    b) build=$OPTARG ;;
    o) sheet=$OPTARG ;;
    s) size=$OPTARG ;;
    n) samples=$OPTARG ;;
    t) threads=$OPTARG ;;
    w) work=$OPTARG ;;
    *) exit 2 ;;
    esac
done
shift $((OPTIND - 1))
for program in "$build/abbe" "$build/contact_sheet"; do
    [[ -x $program ]] || { echo "no $program: ninja -C $build abbe contact_sheet" >&2; exit 1; }
done
if [[ -z $work ]]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" "$(dirname -- "$sheet")"

# "  gold  material  Gold, polished.": two columns are enough.
list=$("$build/abbe" explain presets)
mapfile -t names < <(awk '/^  / && $2 == "material" { print $1 }' <<<"$list")
hair=$(awk '/^[^ ]/ { group = $0 } /^  / && group == "Hair" { print $1 }' <<<"$list")
[[ $# -eq 0 ]] || names=("$@")

pictures=()
for name in "${names[@]}"; do
    scene=$work/$name.scene picture=$work/$name.exr
    pictures+=("$picture")
    [[ ! -e $picture ]] || continue
    edits=(-e "s/^material ball .*/material ball preset $name/")
    if grep -qxF -- "$name" <<<"$hair"; then
        # A ball of fur in the place of the ball; the ring shows nothing of hair.
        fur="shape ball curves \"$root/scenes/hair-ball/hair.ply\" { material ball; transform { scale 3.09e-4; translate 0 6.3 0 } }"
        skull="shape skull sphere { center 0 6.3 0; radius 3.55; material diffuse { reflectance 0.1 } }"
        edits+=(-e "s|^shape ball .*|$fur\n$skull|" -e '/^shape ring /d')
    fi
    sed "${edits[@]}" "$root/scenes/shader-ball/shader-ball.scene" >"$scene"
    "$build/abbe" render "$scene" --size "${size}x$size" --samples "$samples" -t "$threads" --quiet -o "$picture"
done
"$build/contact_sheet" "$sheet" "${pictures[@]}"
echo "$sheet: ${#pictures[@]} materials"
