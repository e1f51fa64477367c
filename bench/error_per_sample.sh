#!/usr/bin/env bash
# What a sample is worth and what a path costs, in ten scenes, beside figures that were kept:
#   bench/error_per_sample.sh BUILD [--keep]
# BUILD: a release build with `abbe` and `efficiency`. Fails where a scene has more than 1.1 times the error per sample, 1.03 times the
# vertices of a path, or 1.05 times its instructions. None of these depends on what else the machine does. `--keep` makes today's figures the
# ones that are kept: with the reason for each that grew in the message of the commit. Instructions are counted by callgrind, of the
# difference between two numbers of samples, so that neither loading nor pilots count; without valgrind they are left out, and it says so.
set -euo pipefail
build=$(realpath -- "$1")
root=$(cd "$(dirname -- "$0")/.." && pwd)
kept=$root/bench/error_per_sample.tsv
now=$(mktemp) scratch=$(mktemp -d)
trap 'rm -rf "$now" "$scratch"' EXIT
scenes=(cornell-box color-bleeding many-lights displaced-stones veach-mis subdivision-still-life shader-ball hair-ball
    milk-and-juice cumulus)

instructions() { # SCENE SAMPLES
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$build/abbe" render "$1" --size 32x32 --samples "$2" --pilot 1 \
        --checkpoint off --png off -t 1 -q -o "$scratch/a.exr" 2>&1 | sed -n 's/.*Collected : *\([0-9]*\).*/\1/p'
}

for name in "${scenes[@]}"; do
    scene=$root/scenes/$name/$name.scene
    read -r vertices error < <("$build/bench/efficiency" "$scene" --size 96 --depth 0 --samples 64 --reference 128 |
        awk '$1 == 64 { printf "%s %.4g\n", $4, $5 * $6 / $7 }') # without the worst 0.1 % of the pixels, which are chance
    count=-
    if command -v valgrind >/dev/null; then
        few=$(instructions "$scene" 4)
        many=$(instructions "$scene" 12)
        count=$(((many - few) / (32 * 32 * 8)))
    fi
    printf '%s\t%s\t%s\t%s\n' "$name" "$error" "$vertices" "$count" | tee -a "$now"
done
command -v valgrind >/dev/null || echo "instructions were not counted: valgrind is not here"

if [[ ${2:-} == --keep ]]; then
    { printf '# relMSE × samples (without the worst 0.1 %% of the pixels), vertices and instructions of a path: bench/error_per_sample.sh BUILD --keep\n' && cat "$now"; } >"$kept"
    exit
fi
awk -F '\t' '
    FNR == NR { if ($0 !~ /^#/) { error[$1] = $2; vertices[$1] = $3; count[$1] = $4 } next }
    function check(what, value, before, most) {
        if (value == "-" || before == "-" || value <= most * before) return
        printf "%s: %s %s, %.2f times the %s that was kept\n", $1, value, what, value / before, before
        faults++
    }
    !($1 in error) { print $1 ": nothing was kept"; faults++; next }
    { check("of error per sample", $2, error[$1], 1.1); check("vertices of a path", $3, vertices[$1], 1.03)
      check("instructions of a path", $4, count[$1], 1.05) }
    END { exit faults > 0 }' "$kept" "$now"
