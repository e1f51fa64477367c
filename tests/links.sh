#!/usr/bin/env bash
# What pages of Markdown link to or show is there, the gallery's index among them; all files of the gallery are in its index,
# all pages of docs/ are in the navigation of the site, and the picture of the folders is that of CMakeLists.txt.
#   links.sh [ROOT [LEAST NUMBER OF LINKS]]
set -euo pipefail
cd "${1:-$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/..}"
faults=0 links=0
# Not what is built, or of other projects.
mapfile -t pages < <(find . -name '*.md' -not -path './build*' -not -path './.git/*' -not -path './shared/*' | sort)
for page in "${pages[@]}"; do
    while IFS= read -r link; do
        links=$((links + 1))
        [[ -e $(dirname -- "$page")/$link ]] && continue
        echo "$page: there is no $link"
        faults=$((faults + 1))
    done < <(awk '/^ *```/ { inside = !inside } !inside' "$page" | sed 's/`[^`]*`//g' |
        grep -oE '\]\([^) ]+\)|src="[^"]+"' | sed -E 's/^\]\(//; s/\)$//; s/^src="//; s/"$//; s/#.*//' |
        grep -vE '^$|^[a-z]+:' || true)
done
[[ $links -ge ${2:-100} ]] || { echo "only $links links were found"; faults=$((faults + 1)); }
if [[ -e docs/gallery ]]; then
    for file in docs/gallery/*; do
        name=${file##*/}
        [[ $name == README.md ]] || grep -qF -e "\"$name\"" -e "($name)" docs/gallery/README.md || { echo "$file is not in its index"; faults=$((faults + 1)); }
    done
fi
if [[ -e docs/site/mkdocs.yml ]]; then
    # Pages, patterns and folders, which stand for all that is in them.
    mapfile -t navigation < <(grep -oE 'docs/[^ ]*(\.md|/)$' docs/site/mkdocs.yml | sed 's,/$,/*,')
    for page in "${pages[@]#./}"; do
        [[ $page == docs/* ]] || continue
        for pattern in "${navigation[@]}"; do
            # shellcheck disable=SC2053 # a pattern
            [[ $page == $pattern ]] && continue 2
        done
        echo "$page is not in docs/site/mkdocs.yml"
        faults=$((faults + 1))
    done
fi
# Whether the picture is there at all is seen above: a page shows it.
if [[ -e tools/make_folder_graph.mjs ]] && command -v node >/dev/null; then
    tools/make_folder_graph.mjs --check || faults=$((faults + 1))
fi
exit $((faults > 0))
