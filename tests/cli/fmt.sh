#!/usr/bin/env bash
# `abbe fmt`: what it writes, where, and what it leaves alone.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

untidy=$'scene 1\n\n\n  camera {from 0 1 4;fov 40 deg}  // seen\nlight sky {\nluminance 900 nits\n}'
tidy=$'scene 1\n\ncamera { from 0 1 4; fov 40 deg }  // seen\nlight sky {\n    luminance 900 nits\n}\n'
is() { # FILE TEXT
    [[ $(cat -- "$1"; echo .) == "$2." ]] || { fault "$1 is not as it should be:"; sed 's/^/    /' "$1"; }
}
made() { # FILE: written anew since the file `before`
    [[ $1 -nt before ]]
}

# In place, once.
printf %s "$untidy" >a.scene
expect 0 fmt a.scene
is a.scene "$tidy"
says err "a.scene: laid out"
touch before && sleep 0.02
expect 0 fmt a.scene
made a.scene && fault "a file was written that has its layout already"
is_empty err

# --check and --diff write nothing.
printf %s "$untidy" >b.scene
expect 4 fmt --check a.scene b.scene
is out $'b.scene\n'
is_empty err
expect 0 fmt --check a.scene
expect 0 fmt --diff b.scene
says out '-  camera {from 0 1 4;fov 40 deg}  // seen'
says out '+camera { from 0 1 4; fov 40 deg }  // seen'
says out '\ No newline at end of file'
expect 4 fmt --diff --check b.scene
is b.scene "$untidy"
expect 0 fmt --diff b.scene
patch -s b.scene <out && is b.scene "$tidy"
expect 0 fmt --diff a.scene
is_empty out

# Standard input.
printf %s "$untidy" | timeout 60 "$program" fmt --stdin >out 2>err || fault "--stdin ended with $?"
is out "$tidy"
printf %s "$untidy" | timeout 60 "$program" fmt - >out 2>err || fault "- ended with $?"
is out "$tidy"
printf 'camera {' | timeout 60 "$program" fmt --stdin --as room.scene >out 2>err
[[ $? -eq 1 ]] || fault "a syntax error in standard input is no error"
is_empty out
says err "room.scene:1:8"
printf '\xef\xbb\xbfscene 1\r\nfilm {};render {}\r\n' | timeout 60 "$program" fmt --stdin >out 2>err
is out $'\xef\xbb\xbfscene 1\r\nfilm {}\r\nrender {}\r\n'
expect 2 fmt
expect 2 fmt --stdin a.scene
expect 2 fmt --as room.scene a.scene
expect 2 fmt - -

# Files with errors stay as they are; the others are laid out.
printf 'camera {\n  lens 85mm\n' >bad.scene
printf %s "$untidy" >c.scene
expect 1 fmt bad.scene c.scene
is bad.scene $'camera {\n  lens 85mm\n'
is c.scene "$tidy"
says err "E0105"
says err "E0110"
expect 1 fmt --format=short bad.scene
says err "bad.scene:2:8: error[E0105]"
expect 3 fmt absent.scene c.scene
says err "E0410"
printf 'ply\nformat ascii 1.0\nend_header\n' >foreign.scene
expect 3 fmt foreign.scene
says err "E0413"
printf '#usda 1.0\n' >stage.scene
expect 2 fmt stage.scene
says err "abbe import stage.scene"
printf '<scene/>' >foreign.xml
expect 2 fmt foreign.xml
says err "abbe import foreign.xml"
# What is no matter of syntax is none of the layout either.
printf 'scene 1\nshape sphere {radius $absent}\n' >odd.scene
expect 0 fmt odd.scene
is odd.scene $'scene 1\nshape sphere { radius $absent }\n'

# The mode stays, a link stays one, and what may not be written stays whole.
printf %s "$untidy" >mode.scene
chmod 640 mode.scene
expect 0 fmt mode.scene
[[ $(stat -c %a mode.scene) == 640 ]] || fault "the mode changed"
mkdir -p real
printf %s "$untidy" >real/d.scene
ln -s real/d.scene link.scene
expect 0 fmt link.scene
[[ -L link.scene ]] || fault "the link was replaced"
is real/d.scene "$tidy"
if [[ $EUID -ne 0 ]]; then
    printf %s "$untidy" >kept.scene
    chmod 400 kept.scene
    expect 3 fmt kept.scene
    is kept.scene "$untidy"
fi

# Folders: all scenes in them.
mkdir -p many/deep
printf %s "$untidy" >many/b.scene
printf %s "$untidy" >many/deep/a.scene
printf %s "$untidy" >many/deep/notes.txt
expect 4 fmt --check many
is out $'many/b.scene\nmany/deep/a.scene\n'
expect 0 fmt many
is many/deep/a.scene "$tidy"
is many/deep/notes.txt "$untidy"
mkdir empty
expect 0 fmt empty
says err "no scene files"

# --upgrade states the edition, once.
printf '// A room.\ncamera { fov 40 deg }\n' >old.scene
expect 0 fmt old.scene
is old.scene $'// A room.\ncamera { fov 40 deg }\n'
expect 4 fmt --check --upgrade old.scene
expect 0 fmt --upgrade old.scene
is old.scene $'// A room.\nscene 1\n\ncamera { fov 40 deg }\n'
expect 0 fmt --check --upgrade old.scene

# Units of two spellings have one; numbers, comments and texts stay.
printf 'scene 1\n\nlight sky { luminance 0.90e3 cd-per-m2 }  // cd-per-m2\n' >units.scene
expect 4 fmt --check units.scene
expect 0 fmt units.scene
is units.scene $'scene 1\n\nlight sky { luminance 0.90e3 nits }  // cd-per-m2\n'
expect 0 fmt --check units.scene

# --tree prints the nodes as JSON and writes nothing.
printf %s "$untidy" >tree.scene
expect 0 fmt --tree tree.scene
is tree.scene "$untidy"
is out $'[{"name":"scene","values":[1]},\n{"name":"camera","children":[{"name":"from","values":[0,1,4]},{"name":"fov","values":[40,"deg"]}]},\n{"name":"light","values":["sky"],"children":[{"name":"luminance","values":[900,"nits"]}]}]\n'
printf %s "$untidy" | timeout 60 "$program" fmt --tree --stdin >out 2>err || fault "--tree --stdin ended with $?"
says out '"luminance"'
expect 1 fmt --tree bad.scene
is_empty out
expect 2 fmt --tree --check tree.scene
expect 2 fmt --tree tree.scene a.scene
expect 2 fmt --tree many

expect 0 fmt --help
says out "--check"
finish
