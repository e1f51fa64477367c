#!/usr/bin/env bash
# The pages of `abbe compare --html` and of a study in a headless Chromium:  pages.sh PROGRAM STUDY_PAGE_OF
set -euo pipefail
here=$(cd "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
program=$(realpath -- "$1")
study_page_of=$(realpath -- "$2")
for need in node "${CHROMIUM:-chromium}"; do
    command -v "$need" >/dev/null || { echo "$need is missing: packaging/apt-test.txt lists what the tests need"; exit 1; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
for seed in 0 1 2; do
    "$program" render "$here/../cli/scenes/room.scene" --seed "$seed" --quiet -o "$seed.exr"
done
"$program" compare 0.exr 1.exr --ref 2.exr --html compare.html >/dev/null 2>&1
node "$here/pages.mjs" "$study_page_of" compare.html
