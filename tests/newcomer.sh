#!/usr/bin/env bash
# The first hour of somebody who has nothing but the README, in an empty folder:  newcomer.sh [PROGRAM]
# Builds with the launcher, as the README says, or takes the program that is given; renders the README's scene; then thirteen
# scenes as beginners write them (tests/first_scenes), each with what is expected of it in comments:
#   expect: picture        renders, and its PNG is neither black nor white nor empty, or a warning says so
#   expect: warning TEXT   a warning has that text
#   expect: error TEXT     an error has that text; there are three errors at most, and not one crash
#   expect: time           rendered with --time it ends when it should, and something is there to look at soon
# Pictures are tiny, so that all of it takes seconds.
set -uo pipefail
export ABBE_USD=/nowhere/abbe-usd # as on a machine of somebody who has just cloned
root=$(cd "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
program=$(realpath -- "${1:-$root/abbe}")
command -v node >/dev/null || { echo "node is missing: packaging/apt-test.txt lists what the tests need"; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
unset OCIO DISPLAY WAYLAND_DISPLAY
small=(--size 64x48 --samples 16)
most_errors=3
limit=1800 # seconds for a render; the first one may have to build
faults=0
pictures=0

fault() {
    printf 'FAULT: %s\n' "$*"
    faults=$((faults + 1))
}

says() { # FILE TEXT WHAT
    grep -qF -e "$2" "$1" && return
    fault "$3: no \`$2\` in:"
    sed 's/^/    /' "$1"
}

milliseconds() { echo $((${EPOCHREALTIME/[.,]/} / 1000)); }

# A picture that shows nothing needs a warning that says why.
look_at() { # PNG WHAT
    local seen
    [[ -s $1 ]] || { fault "$2: there is no $1 to look at"; return; }
    seen=$(node "$root/tests/support/histogram.mjs" "$1")
    printf '%-34s %s\n' "$2" "$seen"
    pictures=$((pictures + 1))
    [[ $seen == picture* ]] || grep -q '^warning\[W064[14]\]' err || {
        fault "$2: $seen, without a warning:"
        sed 's/^/    /' err
    }
}

render() { # SCENE ARGUMENT…
    local scene=$1 code
    shift
    timeout $limit "$program" render "$scene" "$@" >out 2>err
    code=$?
    [[ $code -eq 0 ]] || { fault "render $scene $* ended with $code"; sed 's/^/    /' err; }
}

# The code block of the README that begins with the line `scene 1`.
readme_scene() { awk '/^```/ { inside = 0 } inside || /^scene 1$/ { inside = 1; print }' "$root/README.md"; }

# What the README tells to type, with tiny pictures.
readme() {
    readme_scene >mine.scene
    [[ $(wc -l <mine.scene) -ge 4 ]] || fault "the README has no scene"
    render mine.scene "${small[@]}"
    limit=120
    look_at mine.png "README: its scene"
    local line scene
    while read -r line; do
        scene=${line#./abbe render }
        [[ -e $root/$scene ]] || { fault "README: there is no $scene"; continue; }
        render "$root/$scene" "${small[@]}" -o readme.exr
        look_at readme.png "README: $scene"
    done < <(grep -oE '\./abbe render scenes/[a-z/-]+\.scene' "$root/README.md")
}

# One mistake, one message: what comes of it may not bury it.
faulty() { # SCENE NAME WANTED…
    local scene=$1 name=$2 code errors text
    shift 2
    timeout 60 "$program" check --format short "$scene" >out 2>err
    code=$?
    [[ $code -eq 1 || $code -eq 3 ]] || fault "$name: check ended with $code" # 3: a file that cannot be read as a scene
    cat out >>err
    errors=$(grep -c 'error\[E' err)
    printf '%-34s %d errors\n' "$name" "$errors"
    ((errors >= 1 && errors <= most_errors)) || { fault "$name: $errors errors:"; head -n 12 err | sed 's/^/    /'; }
    "$program" check "$scene" >err 2>&1 # in full, with help
    for text in "$@"; do says err "$text" "$name"; done
}

# `--time` counts from the first look at the frame; reading and building come on top. Beside other programs a machine is slow,
# so what is allowed is twice what is promised.
timed() { # SCENE NAME
    local begin seen="" seconds="" line
    begin=$(milliseconds)
    while read -r line; do
        [[ $line == *'"event":"start"'* ]] && begin=$(milliseconds)
        [[ -z $seen && ($line == *'"event":"image"'* || $line == *'"event":"progress"'*) ]] && seen=$(milliseconds)
        [[ $line =~ '"event":"done"'.*'"render_seconds":'([0-9.]+) ]] && seconds=${BASH_REMATCH[1]}
    done < <(timeout 60 "$program" render "$1" --size 320x240 --samples 4000000 --time 2 --json -o timed.exr 2>err)
    [[ -n $seen ]] || { fault "$2: nothing was shown"; return; }
    printf '%-34s %s s of 2, first shown after %d ms\n' "$2" "${seconds:-?}" $((seen - begin))
    awk -v s="${seconds:-99}" 'BEGIN { exit !(s >= 1.5 && s <= 3) }' || fault "$2: --time 2 rendered for ${seconds:-?} s"
    ((seen - begin <= 1000)) || fault "$2: nothing to look at for $((seen - begin)) ms"
}

first_scene() { # FILE
    local file=$1 name kind text errors=() warnings=()
    name=$(basename -- "$file")
    cp "$file" "$name"
    while read -r kind text; do
        case $kind in
            picture | time) ;;
            warning) warnings+=("$text") ;;
            error) errors+=("$text") ;;
            *) fault "$name expects \`$kind\`" ;;
        esac
    done < <(sed -n 's/^\(\/\/\|#\) expect: //p' "$file")
    if ((${#errors[@]} > 0)); then
        faulty "$name" "$name" "${errors[@]}"
        return
    fi
    render "$name" "${small[@]}"
    look_at "${name%.*}.png" "$name"
    for text in "${warnings[@]+"${warnings[@]}"}"; do says err "$text" "$name"; done
    ((${#warnings[@]} > 0)) || ! grep -q '^warning' err || { fault "$name warns:"; sed 's/^/    /' err; }
    if grep -q '^// expect: time' "$file"; then timed "$name" "$name"; fi
}

readme
for file in "$root"/tests/first_scenes/*; do first_scene "$file"; done
printf '%d pictures, %d faults\n' $pictures $faults
((pictures >= 8)) || fault "only $pictures pictures"
exit $((faults > 0))
