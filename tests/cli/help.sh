#!/usr/bin/env bash
# What a newcomer looks for: `abbe`, help, explain, man page and completion; and scenes from standard input.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# `abbe` alone says where to begin, in no more than a dozen lines.
expect 2
is_empty out
[[ $(wc -l <err) -le 12 ]] || fault "abbe alone says $(wc -l <err) lines"
says err "abbe render room.scene"
says err "abbe help"

expect 0 help
says out "volume"
says out "130"
cp out list
expect 0 --help
cmp -s out list || fault "help and --help differ"
expect 0 help render
says out "--samples N"
says out "abbe explain render"
cp out render # a file of that name is no scene that `explain render` would mean
expect 0 render --help
[[ $(head -n "$(wc -l <out)" render) == "$(<out)" ]] || fault "help render and render --help differ"
expect 0 help volume make
says out "cumulus|smoke|fire|candle"
expect 0 help camera
says out "Focal length"
expect 0 explain camera.lens
expect 1 help chekc
says err "abbe help check"

# Kinds tell what they take, and the language begins with a scene that renders.
expect 0 explain film
says out "Width and height in pixels. [1280 720]"
expect 0 explain render
says out "Samples per pixel"
says out "abbe help render"
expect 1 explain check
says err "abbe help check"
expect 0 explain
sed -n '/^scene 1$/,/^$/p' out >first.scene
expect 0 check --strict first.scene
expect 0 render first.scene --size 32x18 --samples 4 -q -o first.exr

# Standard input: its name, its folder, and what cannot be.
mkdir -p far
printf '400 0.5\n700 0.5\n' >far/paint.spd
printf 'scene 1\ncamera { from 0 0 5 }\nlight sky\nshape sphere { material diffuse { reflectance table "paint.spd" } }\n' >far/room.scene
expect 0 check --as far/room.scene - <far/room.scene
says err "far/room.scene: no errors, no warnings"
expect 0 check -q --as far/room.scene - <far/room.scene
is_empty err
expect 1 check - <far/room.scene
says err "<stdin>:4:"
expect 1 check -q --format=short - < <(printf 'scene 1\ncamera { lens 50 kg }\n')
says err "<stdin>:2:18: error[E0301]"
expect 2 check --fix - <far/room.scene
expect 2 check - - <far/room.scene
expect 2 check --as far/room.scene far/room.scene
expect 0 check -q far/room.scene
is_empty err
expect 3 check - < <(printf 'scene 1\n\xff\xfe')

# What is installed.
expect 2 reference pages
expect 2 reference man folder
expect 0 reference json
"$json_lines" <out >/dev/null || fault "reference json is no JSON"
expect 0 reference share share
man=share/man/man1
says $man/abbe-render.1 "\\-\\-texture\\-cache"
says $man/abbe-volume.1 "abbe volume convert"
says $man/abbe.1 "\\-render\\fR(1)"
for page in "$man"/*.1; do
    for request in $(grep -oE '^\.[A-Za-z"\\]+' "$page" | sort -u); do
        [[ ' .TH .SH .SS .TP .PP .B .br .nf .fi .\" ' == *" $request "* ]] || fault "$page has the request $request"
    done
    type groff >/dev/null 2>&1 || continue
    warnings=$(groff -ww -man -k -Tutf8 -Wbreak "$page" 2>&1 >/dev/null)
    [[ -z $warnings ]] || fault "groff says of $page: $warnings"
done
expect 0 reference man render
cmp -s out $man/abbe-render.1 || fault "the page of a command is not that which is installed"

compopt() { :; } # only of use while completing
# shellcheck source=/dev/null
source share/bash-completion/completions/abbe
complete_words() { # WORD…: what completing the last one gives
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    COMPREPLY=()
    _abbe abbe "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
}
completes() { # WANTED WORD…
    local wanted=$1
    shift
    complete_words "$@"
    [[ ${COMPREPLY[*]} == "$wanted" ]] || fault "\`$*\` is completed to \`${COMPREPLY[*]}\`, not \`$wanted\`"
}
completes certify abbe cert
completes --samples abbe render --samples
completes "--samples --sampler" abbe first.scene --sampl
completes "sobol stratified" abbe render --sampler s
completes stratified abbe render --sampler = st
completes human abbe check --format h
completes first.scene abbe render fir
completes first.exr abbe denoise first.e
completes "make" abbe volume m
completes cumulus abbe volume make cu
completes --clean abbe volume convert --cl
completes camera.from abbe explain camera.fr
completes "" abbe render --samples ""
# Each command and flag that `help` lists is completed.
for command in $(sed -n 's/^  \([a-z]*\)  .*/\1/p' list | grep -v abbe); do
    [[ -s $man/abbe-$command.1 ]] || fault "$command has no man page"
    complete_words abbe "$command"
    [[ " ${COMPREPLY[*]} " == *" $command "* ]] || fault "the command $command is not completed"
    [[ $command == volume || $command == farm ]] && continue
    for flag in $("$program" help "$command" | grep -oE '^  (-[A-Za-z],)?--[a-z-]+' | grep -oE -e '--[a-z-]+'); do
        complete_words abbe "$command" "$flag"
        [[ " ${COMPREPLY[*]} " == *" $flag "* ]] || fault "$command $flag is not completed"
        grep -qF -e "${flag//-/\\-}" "$man/abbe-$command.1" || fault "$flag is not in the man page of $command"
    done
done
if type zsh >/dev/null 2>&1; then zsh -n share/zsh/site-functions/_abbe || fault "zsh does not read its completion"; fi
if type fish >/dev/null 2>&1; then
    fish -n share/fish/vendor_completions.d/abbe.fish || fault "fish does not read its completion"
    found=$(HOME=$folder fish -c "source share/fish/vendor_completions.d/abbe.fish; complete -C 'abbe volume convert --cl'")
    [[ $found == --clean* ]] || fault "fish completes to $found"
fi
finish
