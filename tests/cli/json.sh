#!/usr/bin/env bash
# What programs read: every line is JSON, and the documented events come in their order.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

json() { "$json_lines" "$@" <out >keys || { fault "no JSON lines:"; cat out keys; }; }

expect 0 "$scenes/room.scene" --json -o room.exr --png
is_empty err
json event
order=$(uniq keys | tr '\n' ' ')
pattern='^("phase" )+"start" ("image" )?("progress" |"image" )*("phase" )?("image" )+("phase" )?"done" $'
[[ $order =~ $pattern ]] ||
    fault "events in the order $order"
for event in phase start progress image "done"; do says keys "\"$event\""; done

expect 0 "$scenes/black.scene" --json -o black.exr
json
says out '"event":"warning","code":"W0641"'

expect 1 "$bad/nine_mistakes.scene" --json
json
[[ $(grep -c '"event":"error"' out) -eq 9 ]] || fault "nine mistakes give $(grep -c '"event":"error"' out) events"
says out '"line":5'

expect 1 check --json "$bad/nine_mistakes.scene"
json --whole
expect 0 check --format=json "$scenes/room.scene"
json --whole

for file in room.exr "$scenes/room.scene"; do
    expect 0 info --json "$file"
    "$json_lines" --whole <out >/dev/null || fault "info of $file is no JSON"
done
expect 0 compare --json room.exr room.exr
json

finish
