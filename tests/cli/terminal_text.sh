#!/usr/bin/env bash
# What stands in scenes, paths and files reaches a terminal as text, never as a command; nothing is quoted of a file that
# is not what it is taken for; no message names a state that is gone.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# Line ends and tabs alone of all control characters, those in UTF-8 too, and nothing that turns the direction around.
harmless() {
    for file in out err; do
        ! LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|\xe2\x80[\x8e\x8f\xaa-\xae]|\xe2\x81[\xa6-\xa9]' $file ||
            fault "abbe $*: a control character in $file: $(cat -v $file)"
    done
}
run() {
    timeout 60 "$program" "$@" >out 2>err
    harmless "$@"
}

odd=$'o\e[31m\tdd\u009b5m\u202e.scene'
name='"k\u{1b}[31m\u{9b}5m\u{7f}\u{202e}\n\rerror[E0001]: forged"'
cat >"$odd" <<END
scene 1
camera { from 0 0 4; look-at 0 0 0; lens 50 mm }
film { size 16 16; layers { light-group all $name } }
render { samples 4 }
light $name sky { radiance 1 }
material $name diffuse { reflectance rgb 0.5 0.5 0.5 }
shape $name sphere { material $name }
END
sed 's/radiance 1/radiance 1; wobble 1/; s/material "k/material "l/2' "$odd" >"bad$odd"
sed "\$ a light $name sky { radiance 2 }" "$odd" >"twice$odd"
sed $'s/radiance 1/radiance 1 \e[2J/' "$odd" >"raw$odd"
for scene in "$odd" "bad$odd" "twice$odd" "raw$odd"; do
    for format in human short json; do run check --format=$format "$scene"; done
    run explain "$scene" --effects
    run info "$scene"
    run info "$scene" --json
    [[ -s out || -s err ]] || fault "nothing was said of $(cat -v <<<"$scene")"
done
picture=$'p\e]0;owned\a.exr'
run "$odd" -o "$picture"
[[ -s $picture ]] || fault "no image: $(cat -v err)"
says err 'p\u001b]0;owned\u0007.exr'
run "$odd" -o "$picture" --json
"$json_lines" <out >/dev/null || fault "events are no JSON lines"
run info "$picture"
says out 'abbe.command = abbe'
run info "$picture" --json
run compare "$picture" "$picture"
run convert "$picture" $'p\e[5m.png'
run $'no\e[31m.scene'
run render "$odd" $'--sam\e[31mples' 4
run $'chekc\e[31m'
run explain $'cam\e[31mera'
run merge "$picture" -o x.exr

# A file that is not what it is taken for may be one that not everybody may read.
secret() { # WHAT
    ! grep -qi hunter out err || fault "$1 quotes a secret: $(cat out err)"
}
for text in 'hunter2\n' '# hunter\nuser:hunter2:0 hunter2\n' '{ hunter2 }\n' '"hunter2"\n' '\xff\xfeh\0u\0n\0hunter2\n'; do
    for ending in scene obj ply gltf glb csv spd ies hdr exr png vdb ckpt abbe; do
        # shellcheck disable=SC2059
        printf "$text" >"secret.$ending"
        run check "secret.$ending"
        secret "check secret.$ending"
    done
    for ending in exr hdr vdb png abbe; do run info secret.$ending; secret "info secret.$ending"; done
    run volume info secret.vdb; secret "volume info"
    run convert secret.exr x.png; secret convert
    run compare secret.exr secret.exr; secret compare
    run merge secret.abbe -o x.exr; secret merge
    for word in 'shape mesh "secret.obj"' 'shape mesh "secret.ply"' 'shape mesh "secret.gltf"' 'shape mesh "secret.glb"' \
        'light ies "secret.ies"' 'light environment "secret.hdr"' 'light environment "secret.exr"' 'volume vdb "secret.vdb" { extinction 1 per-m }' \
        'material m diffuse { reflectance table "secret.csv" }' 'material m diffuse { reflectance image "secret.png" }'; do
        printf 'scene 1\ncamera { from 0 0 4; look-at 0 0 0 }\nlight sky\n%s\n' "$word" >uses.scene
        run uses.scene --size 4x4 --samples 1 -o x.exr
        secret "$word"
    done
    cp secret.abbe x.exr.ckpt
    run "$scenes/room.scene" --size 4x4 --samples 1 -o x.exr --resume; secret "a checkpoint"
    rm -f x.exr.ckpt
done

# `--resume` is offered where there is something to go on from.
start gone.exr "$scenes/room.scene" --size 32x32 --checkpoint 100ms
for _ in {1..100}; do [[ -e gone.exr.ckpt ]] && break; sleep 0.1; done
kill -STOP "$job"
rm gone.exr.ckpt && mkdir gone.exr.ckpt # it cannot be written any more
kill -INT "$job"
kill -CONT "$job"
ended_with 130
says_not err "to go on"
says_not events "gone.exr.ckpt\` holds"

finish
