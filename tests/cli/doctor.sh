#!/usr/bin/env bash
# A sound installation is found sound; a broken one is named, and ends with 4.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

expect 0 doctor
for word in version processor memory colours images volumes folders; do says out "$word"; done
says_not out FAULT
says_not out "case "

expect 0 doctor --numerics
says out "case 28"
says out "case 60"
says_not out FAULT
expect 0 doctor --numerics --json
says out '"tolerance"'
says out '"ok": true'
says_not out '"ok": false'

# A configuration of colours that is not there, a folder that cannot be written, parts that are missing.
OCIO=$PWD/none.ocio expect 4 doctor
says out "FAULT     colours"
says out none.ocio
mkdir alone
cp "$program" alone/abbe
program=$PWD/alone/abbe expect 4 doctor
says out "FAULT     images"
says out "FAULT     volumes"
expect 2 doctor --numeric
says err "did you mean \`--numerics\`?"

finish
