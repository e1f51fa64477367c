#!/usr/bin/env bash
# abbe lsp: conversations as editors have them, and the files for editors that the program makes.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

tests=$(dirname -- "$scenes")
root=$(cd "$tests/../.." && pwd)
export XDG_CACHE_HOME=$folder/xdg
mkdir conversation
(cd conversation && nodejs "$tests/lsp.mjs" "$program" "$root/scenes" "$bad") || fault "a conversation went wrong"

# Files of editors are what the program says today.
expect 0 reference textmate
cmp -s out "$root/tools/editors/vscode/syntaxes/abbe-scene.tmLanguage.json" ||
    fault "run \`abbe reference textmate >tools/editors/vscode/syntaxes/abbe-scene.tmLanguage.json\`"
expect 0 reference json
nodejs "$tests/lsp_editors.mjs" "$root/tools/editors" out || fault "files for editors"

# The libraries that editors are built on, where they can be had.
libraries=(vscode-jsonrpc@8 vscode-languageserver-protocol@3.17 vscode-textmate@9 vscode-oniguruma@2)
if command -v npm >/dev/null &&
    timeout 120 npm install --no-audit --no-fund --fetch-retries=0 --prefix npm "${libraries[@]}" >npm.log 2>&1; then
    nodejs "$tests/lsp_peer.mjs" "$program" "$folder/npm/node_modules" \
        "$root/tools/editors/vscode/syntaxes/abbe-scene.tmLanguage.json" || fault "the libraries of editors disagree"
else
    echo "without npm and its packages: editors' own libraries are not asked"
fi

# Nothing but messages on standard output, and an end when the editor is gone.
"$program" lsp </dev/null >out 2>err
[[ $? -eq 1 ]] || fault "the end of input is no good end"
is_empty out
expect 2 lsp room.scene
finish
