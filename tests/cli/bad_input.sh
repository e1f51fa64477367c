#!/usr/bin/env bash
# Bad scenes end in a located diagnostic, odd ones in a correct image; never in a crash, a hang or a silent black frame.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

bad_scene() { # NAME PLACE TEXT
    expect 1 render "$scenes/$1.scene" -o "$1.exr"
    says err "$1.scene:$2"
    says err "$3"
    [[ ! -e $1.exr ]] || fault "$1 wrote an image"
}

bad_scene no_camera 1:1 "no camera"
bad_scene no_light 1:1 "no light"
bad_scene cyclic_instances 8:14 "contains itself"
bad_scene not_a_number 3:17 "is not a number"
bad_scene not_a_number 7:29 "infinite"
bad_scene missing_file 5:18 "file not found"
bad_scene damaged_ply 5:18 "damaged.ply"
bad_scene zero_area 6:1 "no area"
bad_scene wrong_units 3:48 "not a temperature"

# No mistake is hidden by another one.
expect 1 check --format=short "$scenes/not_a_number.scene"
[[ $(wc -l <err) -eq 4 ]] || fault "four mistakes give $(wc -l <err) lines"

for size in 1x1 32768x1 1x4096; do
    expect 0 "$scenes/room.scene" --size $size --samples 32 -o odd.exr -q
    says_not err W0641
    expect 0 info odd.exr
    says out "${size/x/×}"
done
expect 0 "$scenes/film_1x1.scene" -o odd.exr
expect 0 "$scenes/film_32768x1.scene" -o odd.exr --png
expect 0 "$scenes/black.scene" -o odd.exr
says err W0641

# Images: those that are none, too short, or hold what is no number; numbers out of a picture of colours.
printf 'P6\n2 2\n255\n123456789012' >good.ppm
printf 'P6\n64 64\n255\n123456789012' >cut.ppm
echo "no picture" >text.ppm
{ printf 'PF\n1 1\n-1.0\n' && printf '\000\000\300\177\000\000\000\077\000\000\000\100'; } >nan.pfm
{ printf 'PF\n1 1\n-1.0\n' && printf '\000\000\200\277\000\000\000\077\000\000\000\100'; } >odd.pfm
textured() { # PROPERTY
    printf 'scene 1\ncamera\nlight sky\nshape quad { material conductor { index metal Ag; %s } }\n' "$1" >image.scene
}
export XDG_CACHE_HOME=$PWD/cache
for name in cut.ppm nan.pfm; do
    textured "tint image \"$name\""
    [[ $name == cut.ppm ]] && wanted=1 || wanted=0
    expect $wanted check image.scene # pixels that cannot be in the file are told by its header
    expect 1 check --textures image.scene
    says err "image.scene:4:62"
    says err "$name"
done
textured 'tint image "text.ppm"'
expect 1 check image.scene
says err "image.scene:4:62"
textured 'tint image "odd.pfm"'
expect 4 check --strict --textures image.scene
tells err W0453 "1 of 1" odd.pfm
tells err W0454 "1 of 1" odd.pfm
textured 'roughness image "good.ppm"'
expect 4 check --strict --format=short image.scene
says err "image.scene:4:67: warning[W0450]"
textured 'roughness image "good.ppm" space=data; tint image "good.ppm"'
expect 0 check --strict --textures image.scene
unset XDG_CACHE_HOME

# Empty, binary and cut files, and a folder.
: >empty.scene
expect 1 empty.scene
head -c 20000 /dev/urandom >binary.scene
timeout 20 "$program" check binary.scene >out 2>err
code=$?
[[ $code -eq 1 || $code -eq 3 ]] || fault "a binary file ended with $code"
for length in 1 40 100 200 300 500; do
    head -c $length "$scenes/room.scene" >cut.scene
    timeout 20 "$program" check cut.scene >out 2>err
    code=$?
    [[ $code -le 1 || $code -eq 3 ]] || fault "the first $length bytes of a scene ended with $code"
done
expect 3 render .

finish
