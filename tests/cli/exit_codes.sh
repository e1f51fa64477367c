#!/usr/bin/env bash
# Exit codes, and where the words go: data to stdout, everything else to stderr.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# 0
expect 0 "$scenes/room.scene" -o room.exr
is_empty out
says err "image room.exr"
[[ -s room.exr ]] || fault "no image"
expect 0 render "$scenes/room.scene" --quiet # named after the scene, in the current folder
is_empty out
is_empty err
expect 0 check "$scenes/room.scene" "$scenes/glass.scene"
expect 0 --version
says out "abbe "
is_empty err
expect 0 --help
says out "Examples:"
expect 0 render --help
says out "--samples"
says out "--png[=FILE]"
expect 0 info room.exr
says out "ACES2065-1"
says out "abbe.sceneHash = "
says out "abbe.command = abbe "
says out "abbe.partial = 0"
expect 0 info "$scenes/room.scene"
says out "shapes"
says out "shape      ball sphere  -0.1 0 -0.4 … 0.7 0.8 0.4 m"
expect 0 explain "$scenes/glass.scene"
says out "dispersion: on"
says out "glass.scene:12"
says out "polarization"
expect 0 explain "$scenes/glass.scene" --effects --json
says out '"effect": "dispersion"'
expect 0 explain --effects
says out "depth-of-field"
expect 0 explain # the language itself
printf 'scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky\nrender { forbid { dispersion } }\n%s\n' \
    'shape sphere { material dielectric { ior glass BK7 } }' >forbidden.scene
expect 1 check forbidden.scene
says err "error[E0684]"
says err "forbidden.scene:5:"
expect 0 explain "$scenes/room.scene"
tells out refractive wavelength
expect 0 explain camera.lens
says out "Focal length"
expect 0 explain E0310
expect 0 explain unit nits

# PNG by a display view
expect 0 convert room.exr room2.png
expect 0 "$scenes/room.scene" -o room.exr --png --quiet
cmp -s room.png room2.png || fault "render --png and convert differ"
expect 3 "$scenes/room.scene" -o room.exr --png --view "no such view"
says err "no such view"

# parameters
expect 0 "$scenes/turntable.scene" -o a.exr --quiet
expect 0 "$scenes/turntable.scene" -o b.exr --quiet -D "yaw=70 deg"
[[ $(pixels a.exr) != $(pixels b.exr) ]] || fault "-D changes nothing"
expect 1 "$scenes/turntable.scene" -D "pitch=70 deg"
says err E0221

# 1: the scene has errors, all of them in one run
expect 1 render "$bad/nine_mistakes.scene"
is_empty out
says err "9 errors"
expect 1 check --format=short "$bad/nine_mistakes.scene"
[[ $(wc -l <err) -eq 9 ]] || fault "nine mistakes give $(wc -l <err) lines"
expect 1 explain wobble

# --fix repairs two of them in place: what can mean one thing only
cp "$bad/nine_mistakes.scene" fixed.scene
expect 1 check --fix fixed.scene
says err "repaired"
says fixed.scene "2 m"
says fixed.scene "focus 2 m"
says fixed.scene "f-stop 4 mm" # an f-number, or a diameter?

# 2: wrong command line
expect 2
expect 2 render
expect 2 "$scenes/room.scene" --smaples 4
says err "did you mean \`--samples\`?"
expect 2 chekc "$scenes/room.scene"
says err "did you mean \`check\`?"
expect 2 "$scenes/room.scene" --size 0x4
expect 2 "$scenes/room.scene" --size 100000x100000
expect 2 "$scenes/room.scene" -o image.png
expect 2 "$scenes/room.scene" --pixel 48,0

# 3: files
expect 3 no_such.scene
says err "no_such.scene"
expect 3 check no_such.scene
expect 3 "$scenes/room.scene" -o no/such/folder/a.exr
says err E0430
expect 3 info no_such.exr
mkdir folder.exr
expect 3 "$scenes/room.scene" -o folder.exr
head -c 700 room.exr >cut.exr
expect 3 info cut.exr
printf 'scene 1\n\xff\xfe' >latin.scene
expect 3 check latin.scene

# found out before rendering: nothing was rendered in the meantime
expect 3 "$scenes/room.scene" -o no/such/folder/a.exr --samples 4000000000

# 4: thresholds
expect 0 "$scenes/room.scene" -o other.exr --seed 1 --quiet
expect 0 compare room.exr other.exr
says out relMSE
expect 0 compare room.exr other.exr --threshold 10
expect 4 compare room.exr other.exr --threshold 1e-6
expect 0 compare room.exr room.exr --threshold 0
expect 1 compare room.exr a.exr # another size
expect 4 "$scenes/black.scene" --strict
says err W0641
expect 0 "$scenes/black.scene"

# 5: more memory than there is
sed "s/samples 16/samples 16; replicates 16/" "$scenes/room.scene" >huge.scene # a terabyte
expect 5 huge.scene --size 46000x46000 -o huge.exr
says err E0650

if [[ $(uname -m) == x86_64 ]] && ! sanitized; then # sanitizers reserve terabytes
    (ulimit -v 2500000 && timeout 60 "$program" "$scenes/room.scene" --size 9000x9000 -o huge.exr >out 2>err)
    code=$?
    [[ $code -eq 5 ]] || fault "out of memory ended with $code"
fi

# colours only when asked for
expect 1 check "$bad/nine_mistakes.scene"
says_not err $'\x1b'
expect 1 check --color always "$bad/nine_mistakes.scene"
says err $'\x1b'

finish
