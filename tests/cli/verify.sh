#!/usr/bin/env bash
# Two estimators of a small scene agree, say how well they know it, and say so in numbers; what stops a verification is
# told.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/room.scene

expect 0 verify "$scene" --size 24x16 --resolution 1
says out "the estimators agree"
says out "would have been seen"
says out "scattering"
says out " nee "
expect 0 verify "$scene" --size 24x16 --samples 256 --seed 3 --json
"$json_lines" <out >/dev/null || fault "no JSON lines"
says out '"verdict":"agree"'
says out '"samples":256'

# the same numbers for any number of threads
grep '"event":"verify"' out | sed 's/"seconds":[^,]*//' >first
expect 0 verify "$scene" --size 24x16 --samples 256 --seed 3 --json -t 3
grep '"event":"verify"' out | sed 's/"seconds":[^,]*//' | cmp -s - first || fault "threads change what is found"
expect 0 verify "$scene" --size 24x16 --samples 256 --seed 4 --json
grep '"event":"verify"' out | sed 's/"seconds":[^,]*//' | cmp -s - first && fault "the seed changes nothing"

# too little time is told
expect 0 verify "$scene" --size 24x16 --resolution 0.0001 --time 1
says err W0735
expect 4 verify "$scene" --size 24x16 --resolution 0.0001 --time 1 --strict

expect 0 verify "$scenes/black.scene" --size 24x16 --samples 32
says out "the estimators agree"
expect 1 verify "$scenes/cyclic_instances.scene"
expect 2 verify "$scene" --resolution much
says err "per cent"
expect 2 verify "$scene" --samples 8
expect 2 verify

finish
