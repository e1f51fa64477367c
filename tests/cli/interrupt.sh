#!/usr/bin/env bash
# The first signal saves the image so far; the second one leaves at once and leaves what was there.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

start int.exr "$scenes/room.scene" --size 256x256
kill -INT "$job"
ended_with 130
expect 0 info int.exr
says out "abbe.partial = 1"
says out "256×256"
says events '"partial":true'
"$json_lines" <events >/dev/null || fault "events are no JSON lines"
[[ -z $(find . -name '*.tmp') ]] || fault "temporary files are left"

start term.exr "$scenes/room.scene" --size 256x256
kill -TERM "$job"
ended_with 143
expect 0 info term.exr
says out "abbe.partial = 1"

# A broken contract of the program itself ends with its own code.
start abort.exr "$scenes/room.scene" --size 256x256
kill -ABRT "$job"
ended_with 70
[[ ! -e abort.exr ]] || fault "an image in spite of a bug"

# An older image survives a render that is left at once. While the program is stopped both signals gather, so neither
# can be late; the order in which they are delivered does not matter.
expect 0 "$scenes/room.scene" --quiet -o old.exr
before=$(pixels old.exr)
start old.exr "$scenes/room.scene" --size 256x256
kill -STOP "$job"
kill -INT "$job"
kill -TERM "$job"
kill -CONT "$job"
wait "$job"
code=$?
[[ $code -eq 130 || $code -eq 143 ]] || fault "two signals ended with $code"
[[ $(pixels old.exr) == "$before" ]] || fault "the older image was lost"

finish
