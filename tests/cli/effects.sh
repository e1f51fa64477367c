#!/usr/bin/env bash
# abbe study --effects: each effect of the scene, with the line that asks for it, in files and on the terminal.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

expect 0 study "$scenes/rows.scene" --effects --seeds 2 --samples 16 -o found
for name in dispersion motion 'volume milk' 'volume homogeneous-1'; do says out "$name"; done
says_not out "absorption"
says_not out "displacement"
says err "found.html"
for name in dispersion motion 'volume milk'; do
    says found.csv "$name,"
    says found.json "\"name\":\"$name\""
done
says found.json '"place":"rows.scene:'
says found.json '"cost":{"seconds"'
"$json_lines" --whole <found.json || fault "found.json is no JSON"
says found.html "abbe-study/1"
lines=$(grep -vc '^#' found.csv)
((lines == 5)) || fault "$lines lines in found.csv"
# Numbers, and intervals that hold them.
awk -F, '/^#/ || $1 == "effect" { next } !($5 <= $4 && $4 <= $6 && $2 > 0 && $8 >= 0) { exit 1 }' found.csv ||
    fault "$(cat found.csv)"

expect 0 study "$scenes/room.scene" --effects --seeds 2 --samples 16 -o none
says out "nothing"
expect 0 study "$scenes/glass.scene" --effects --seeds 2 --samples 16 -o glass --json
says out '"event":"file"'
says out '"event":"done"'
says glass.csv "absorption,"
expect 1 study "$scenes/no_light.scene" --effects -o dark
[[ ! -e dark.json ]] || fault "a study of a scene with errors"

finish
