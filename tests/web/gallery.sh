#!/usr/bin/env bash
# tools/make_gallery.mjs from pictures and studies that are there: gallery.sh STUDY_PAGE_OF
set -euo pipefail
here=$(cd "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
study_page_of=$(realpath -- "$1")
for need in node "${CHROMIUM:-chromium}"; do
    command -v "$need" >/dev/null || { echo "$need is missing: packaging/apt-test.txt lists what the tests need"; exit 1; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
node "$here/gallery.mjs" "$study_page_of"
