#!/usr/bin/env bash
# The documentation as a site with search, in build/site. It needs python3 with venv; mkdocs-material comes from PyPI
# in the version below, into build/site-venv.
#   make_site.sh [OPTION OF MKDOCS…]
set -euo pipefail
root=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/..
cd "$root"
version=9.8.2 venv=build/site-venv pages=build/site-pages
if [[ ! -e $venv/$version ]]; then
    rm -rf "$venv"
    python3 -m venv "$venv" || { echo "python3 with venv is missing: apt-get install python3-venv" >&2; exit 1; }
    "$venv/bin/pip" install --quiet "mkdocs-material==$version"
    touch "$venv/$version"
fi
rm -rf "$pages"
mkdir -p "$pages"
# Pages and what they show, in the places that they have in the repository.
find README.md CONTRIBUTING.md CHANGELOG.md docs scenes -type f \
    \( -name '*.md' -o -name '*.png' -o -name '*.jpg' -o -name '*.svg' -o -name '*.html' -o -name '*.scene' -o -name '*.bib' \) \
    -exec cp --parents -t "$pages" {} +
# Decisions have no page of their own that lists them.
decisions=docs/decisions
if [[ ! -e $decisions/README.md ]]; then
    {
        printf '# Decisions\n\n'
        for page in "$decisions"/*.md; do echo "* [$(sed -n '1s/^# //p' "$page")](${page##*/})"; done
    } >"$pages/$decisions/README.md"
fi
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict --quiet --config-file docs/site/mkdocs.yml "$@"
echo "build/site is made; to read it: python3 -m http.server --directory build/site"
