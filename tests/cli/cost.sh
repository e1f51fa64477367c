#!/usr/bin/env bash
# The cost report of a render adds up to the time on the wall, has nothing for what a scene has not, and its counts are whole
# numbers of the samples alone: the same for any threads, for parts put together and for a render that was continued.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# Of the last event of a render.
report() { grep '"event":"done"' out | grep -o '"cost":{.*}]}'; }
member() { report | grep -o "^\"cost\":{[^[]*" | grep -o "\"$1\":[^,]*" | cut -d: -f2; } # NAME
row() { report | grep -o "{\"id\":\"$1\"[^}]*}"; }                                         # ID
figure() { row "$1" | grep -o "\"$2\":[^,}]*" | cut -d: -f2; }                           # ID MEMBER
event() { grep '"event":"done"' out | grep -o "\"$1\":[^,}]*" | head -n 1 | cut -d: -f2; }

within() { # WHAT A B PERCENT
    awk -v a="$2" -v b="$3" -v most="$4" \
        'BEGIN { exit !(a > 0 && b > 0 && (a > b ? a - b : b - a) <= most / 100 * b) }' ||
        fault "$1: $2 and $3 are more than $4 % apart"
}

sum_of_rows() { report | grep -o '"seconds":[^,]*,"uncertainty' | grep -o '[0-9.e-]*' | awk '{ s += $1 } END { print s }'; }

# Counts alone: what threads, parts and interruptions must not change. Looking ahead is done by each run.
counts() {
    report | grep -o '{"id":[^}]*}' | grep -v -e '"look-ahead"' -e '"merging"' |
        grep -o -e '"id":"[^"]*"' -e '"rays":[0-9]*' -e '"count":[0-9]*' -e '"first":[0-9]*'
    member untouched
}

adds_up() { # SCENE OPTION…
    expect 0 "$@" --json --checkpoint off -o sum.exr
    within "$1: rows and their sum as told" "$(sum_of_rows)" "$(member seconds)" 5
    # Two clocks of one process. A row that is forgotten or counted twice is more than what a busy machine makes of them.
    within "$1: the cost report and the phases of the program" "$(member seconds)" "$(event seconds)" 25
    local rendering
    rendering=$(awk -v a="$(member rendering)" -v b="$(figure look-ahead seconds)" -v c="$(figure waiting seconds)" \
        'BEGIN { print a + b + c }')
    within "$1: rows of rendering and its clock" "$rendering" "$(event render_seconds)" 25
}
adds_up "$scenes/room.scene" --samples 3000
adds_up "$scenes/rows.scene" --samples 1000
adds_up "$scenes/glass.scene" --samples 1500

# What the scene has, and nothing else.
expect 0 "$scenes/rows.scene" --json --checkpoint off -o rows.exr -t 1
counts >one
for id in camera embree surface lights textures 'subsurface milk' 'volume homogeneous-1' motion dispersion film; do
    [[ -n $(row "$id") ]] || fault "no row \`$id\`"
    n=$(($(figure "$id" rays) + $(figure "$id" count || echo 0)))
    ((n > 0)) || fault "nothing is counted for \`$id\`"
done
expect 0 "$scenes/room.scene" --json --checkpoint off -o room.exr
for id in textures volume subsurface motion dispersion; do
    for name in rays count seconds elsewhere; do
        n=$(figure "$id" $name)
        [[ -z $n && $name == count || $n =~ ^0(\.0)?$ ]] || fault "room: $id has $name $n"
    done
done
(($(figure camera rays) == 48 * 32 * 16)) || fault "$(figure camera rays) rays of the camera"
(($(figure embree rays) == $(figure camera rays) + $(figure surface rays) + $(figure lights rays))) ||
    fault "rays do not add up"

# The same for any threads, in parts, and when continued.
expect 0 "$scenes/rows.scene" --json --checkpoint off -o rows.exr -t 8
counts >eight
cmp one eight || fault "threads change counts"
expect 0 "$scenes/rows.scene" --json --checkpoint off -o rows.exr --kernel all
counts >all
cmp one all || fault "the largest kernel counts otherwise"
parts=0
for k in 2 1 3; do
    expect 0 "$scenes/rows.scene" --json -o rows.exr --part $k/3
    parts=$(awk -v a="$parts" -v b="$(member seconds)" 'BEGIN { print a + b }')
done
expect 0 merge rows.part{1,2,3}.abbe -o merged.exr --json
counts >merged
cmp one merged || fault "parts put together have other counts"
awk -v a="$parts" -v b="$(member seconds)" 'BEGIN { exit !(b > 0.5 * a) }' || fault "the time of the parts is lost"
within "merged: rows" "$(sum_of_rows)" "$(member seconds)" 5
expect 0 "$scenes/rows.scene" --json --samples 8 --checkpoint keep -o go.exr
before=$(member seconds)
expect 0 "$scenes/rows.scene" --json --resume -o go.exr
counts >resumed
cmp one resumed || fault "a render that was continued has other counts"
awk -v a="$before" -v b="$(member seconds)" 'BEGIN { exit !(b > 0.5 * a) }' || fault "the time before is lost"
within "continued: rows" "$(sum_of_rows)" "$(member seconds)" 5

# On paper.
expect 0 "$scenes/rows.scene" -q --cost --checkpoint off -o rows.exr
says out "Embree"
says out "inside solids: milk"
says out "in other rows"
expect 0 "$scenes/room.scene" -q --bill --checkpoint off -o room.exr
says out "cost: "
says_not out "dispersion"
expect 0 "$scenes/room.scene" -q --checkpoint off -o room.exr
is_empty out
expect 0 info room.exr
says out "light sampling"
says_not out "abbe.cost"
expect 0 info room.exr --json
says out '"uncertainty"'

finish
