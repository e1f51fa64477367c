#!/usr/bin/env bash
# Scenes over scenes: include, override, variants and --set with every command that reads a scene, and what a render is known by.
# shellcheck disable=SC2016 # names of parameters and messages
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

fast=(-q --png off)
mkdir -p props
cat >props/ball.scene <<'END'
scene 1 length=cm
param r 40
material paint diffuse { reflectance 0.5 }
shape ball sphere { radius "$r"; material paint }
shape cube mesh "cube.ply" { material paint; transform { translate 100 0 0 } }
END
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n30 0 0\n0 30 0\n3 0 1 2\n' >props/cube.ply
cat >room.scene <<'END'
scene 1
camera main { from 0 0.5 3; look-at 0 0 0; fov 40 deg; exposure 0 stops }
film { size 32 24 }
render { samples 4 }
light sky { luminance 4 nits }
shape floor plane { material diffuse { reflectance 0.4 }; transform { translate 0 -0.5 0 } }
variant dusk { override light sky { luminance 1 nits } }
END
cat >shot.scene <<'END'
scene 1
include "room.scene"
include "props/ball.scene" as=left
override camera { fov 30 deg }
variant red { override material left:paint { reflectance rgb 0.8 0.1 0.1 } }
END
cat >flat.scene <<'END'
scene 1
camera main { from 0 0.5 3; look-at 0 0 0; fov 30 deg; exposure 0 stops }
film { size 32 24 }
render { samples 4 }
light sky { luminance 1 nits }
shape floor plane { material diffuse { reflectance 0.4 }; transform { translate 0 -0.5 0 } }
material left:paint diffuse { reflectance rgb 0.8 0.1 0.1 }
shape left:ball sphere { radius 20 cm; material left:paint }
shape left:cube mesh "flat.ply" { material left:paint; transform { translate 1 0 0 } }
END
sed 's/^30 0 0/0.3 0 0/; s/^0 30 0/0 0.3 0/' props/cube.ply >flat.ply
chosen=(--variant dusk --variant red -D left:r=20)

# The layers are the scene that one would have written.
expect 0 check shot.scene room.scene --format=short
expect 0 render flat.scene -o flat.exr "${fast[@]}"
expect 0 render shot.scene "${chosen[@]}" -o shot.exr "${fast[@]}"
same_pixels shot.exr flat.exr
expect 0 render shot.scene --set 'light.sky.luminance=1 nits' --set 'material.left:paint.reflectance=rgb 0.8 0.1 0.1' \
    --set 'shape.left:ball.radius="2 * 10 cm"' -o set.exr "${fast[@]}"
same_pixels set.exr flat.exr
expect 0 render shot.scene --variant dusk -o dusk.exr "${fast[@]}"
[[ $(pixels dusk.exr) != "$(pixels shot.exr)" ]] || fault "a variant changes nothing"

# An image says what it is of.
expect 0 info shot.exr
says out "abbe.variants = dusk red"
expect 0 info set.exr
says out "abbe.set = light.sky.luminance=1 nits"
hashes() { for arguments in "" "--variant dusk" "--variant red" "--set camera.fov=50" "-D left:r=30"; do
    # shellcheck disable=SC2086 # words
    "$program" info shot.scene $arguments | sed -n 's/^hash *//p'
done; }
[[ $(hashes | sort -u | wc -l) -eq 5 ]] || fault "hashes: $(hashes)"
before=$(hashes | head -1)
sed -i 's/param r 40/param r 41/' props/ball.scene
[[ $(hashes | head -1) != "$before" ]] || fault "the hash does not count included files"
sed -i 's/param r 41/param r 40/' props/ball.scene

# A list of files and variants.
expect 0 info shot.scene --variant red
says out "variant    dusk"
says out "variant    red  (chosen)"
tells out file room.scene
tells out file props/ball.scene
tells out file props/cube.ply
expect 0 info shot.scene --json
says out '"variants"'

# A checkpoint goes on with the same layers only: variants, values, included files, and numbers that texts compute with.
expect 0 render shot.scene "${chosen[@]}" -o part.exr --checkpoint keep "${fast[@]}"
expect 0 render shot.scene "${chosen[@]}" -o part.exr --checkpoint keep --resume --samples 8 "${fast[@]}"
for other in "--variant dusk -D left:r=20" "--variant dusk --variant red" "--variant dusk --variant red -D left:r=20 --set camera.fov=31"; do
    # shellcheck disable=SC2086
    expect 1 render shot.scene $other -o part.exr --checkpoint keep --resume --samples 8 "${fast[@]}"
    says err E0663
done
expect 0 render shot.scene "${chosen[@]}" --part 1/2 -o p.exr "${fast[@]}"
expect 0 render shot.scene "${chosen[@]}" --part 2/2 -o p.exr "${fast[@]}"
expect 0 merge p.part1.abbe p.part2.abbe -o merged.exr
same_pixels merged.exr shot.exr

# Other commands.
expect 0 explain shot.scene "${chosen[@]}"
expect 0 export shot.scene --to pbrt -o out.pbrt "${chosen[@]}"
grep -q '0.2' out.pbrt || fault "the export is not of the chosen radius"
expect 0 render shot.scene "${chosen[@]}" --pixel 16,12
expect 0 replay shot.exr --pixel 16,12 --sample 0:1
expect 0 verify shot.scene "${chosen[@]}" --samples 32 -q

# A pack has all of it, and what was chosen.
touch .abbe-project
mkdir -p elsewhere && cp props/* elsewhere && cp shot.scene elsewhere/shot.scene
sed -i 's|"room.scene"|"../room.scene"|; s|"props/ball.scene"|"ball.scene"|' elsewhere/shot.scene
for scene in shot.scene elsewhere/shot.scene; do
    rm -rf packed.abz packed
    expect 0 pack "$scene" -o packed.abz "${chosen[@]}" --set 'camera.fov=30 deg'
    expect 0 render packed.abz -o packed.exr "${fast[@]}"
    same_pixels packed.exr shot.exr
    expect 0 pack "$scene" -o packed/ "${chosen[@]}"
    expect 0 render packed/shot.scene -o packed.exr "${fast[@]}"
    same_pixels packed.exr shot.exr
done
expect 0 info packed.abz
says out "variant    command-line  (chosen)"

# Frames of an animation: a text that computes with the frame.
cat >turn.scene <<'END'
scene 1
include "shot.scene"
param frame 0
override shape left:ball { transform { translate "$frame / 24 * 1 m" 0 0 } }
END
expect 0 render turn.scene --frames 1-2 -o f.##.exr "${fast[@]}"
[[ $(pixels f.01.exr) != "$(pixels f.02.exr)" ]] || fault "two frames are alike"
says_not err W0

# Faults.
expect 1 check shot.scene --variant red --variant nigth --format=short
tells err E0231 nigth
expect 1 check shot.scene --set camera.fov --format=short
says err E0233
expect 1 check shot.scene --set material.left:pain.reflectance=1 --format=short
tells err E0229 'did you mean `left:paint`'
printf 'scene 1\ninclude "loop.scene"\n' >loop.scene
expect 1 check loop.scene --format=short
says err E0227
printf 'scene 1\ninclude "props/bal.scene"\n' >missing.scene
expect 1 check missing.scene
says err '`props/ball.scene` exists'
expect 1 check - --as props/x.scene <missing.scene
says err E0401
finish
