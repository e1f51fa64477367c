#!/usr/bin/env bash
# An installed program runs, and brings its man pages and the completion of three shells.
#   install.sh BUILD
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$1" --prefix "$folder" >/dev/null
faults=0
fault() {
    echo "FAULT: $*"
    faults=$((faults + 1))
}
for file in bin/abbe lib/abbe/abbe_images.so lib/abbe/abbe-vdb share/man/man1/abbe.1 share/man/man1/abbe-render.1 share/fish/vendor_completions.d/abbe.fish \
    share/bash-completion/completions/abbe share/zsh/site-functions/_abbe; do
    [[ -s $folder/$file ]] || fault "$file is not installed"
done
"$folder/bin/abbe" doctor >"$folder/doctor" || fault "the installed program is at fault: $(<"$folder/doctor")"
cmp -s <("$folder/bin/abbe" reference man) "$folder/share/man/man1/abbe.1" || fault "the man page is of another program"
cmp -s <("$folder/bin/abbe" reference man farm) "$folder/share/man/man1/abbe-farm.1" || fault "the man page of a command is of another program"
exit $((faults > 0))
