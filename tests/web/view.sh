#!/usr/bin/env bash
# The page of `abbe view` in a headless Chromium, against a made-up program and, where one is given, the real one:  view.sh [PROGRAM]
set -euo pipefail
here=$(cd "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
for need in node "${CHROMIUM:-chromium}"; do
    command -v "$need" >/dev/null || { echo "$need is missing: packaging/apt-test.txt lists what the tests need"; exit 1; }
done
arguments=()
[[ $# -gt 0 ]] && arguments=("$(realpath -- "$1")" "$here/../cli/scenes/room.scene")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
node "$here/view.mjs" "${arguments[@]}"
