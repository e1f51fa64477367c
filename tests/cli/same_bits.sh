#!/usr/bin/env bash
# The image is the same, bit for bit, for any number of threads and for any instantiation of the path loop that holds the
# scene's effects; and it is another one for another seed.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

for name in room glass; do
    expect 0 "$scenes/$name.scene" --quiet -o one.exr -t 1
    expect 0 "$scenes/$name.scene" --quiet -o two.exr -t 2
    expect 0 "$scenes/$name.scene" --quiet -o eight.exr -t 8
    cp one.exr "$name.one.exr"
    same_pixels one.exr two.exr
    same_pixels one.exr eight.exr
    same_certificate one.exr two.exr
    same_certificate one.exr eight.exr
    expect 0 "$scenes/$name.scene" --quiet -o seed.exr --seed 1
    [[ $(pixels one.exr) != $(pixels seed.exr) ]] || fault "$name: the seed changes nothing"
done

# with a plan of the samples, which threads do not change either
for threads in 1 2 8; do expect 0 "$scenes/uneven.scene" --quiet -o plan$threads.exr -t $threads; done
same_pixels plan1.exr plan2.exr
same_pixels plan1.exr plan8.exr
expect 0 "$scenes/uneven.scene" --quiet -o even.exr --adaptive off
[[ $(pixels plan1.exr) != $(pixels even.exr) ]] || fault "there is no plan"
expect 0 "$scenes/room.scene" --quiet -o off.exr --adaptive off
same_pixels off.exr room.one.exr
expect 2 "$scenes/room.scene" --adaptive maybe
says err "on or off"

# with paths that are guided, in parts and after an interruption, too
sed 's/^render .*/render { samples 16; guiding always }/' "$scenes/../../../scenes/door-ajar/door-ajar.scene" >guided.scene
small=(--quiet --size 64x64 --pilot 30)
for threads in 1 2 8; do expect 0 guided.scene "${small[@]}" -o guide$threads.exr -t $threads; done
same_pixels guide1.exr guide2.exr
same_pixels guide1.exr guide8.exr
expect 0 info guide1.exr
says out "abbe.guide = paths guided"
says_not out "light: in 0 of"
expect 0 guided.scene "${small[@]}" -o guide_all.exr --kernel all
same_pixels guide1.exr guide_all.exr
for part in 2 1; do expect 0 guided.scene "${small[@]}" -o part.exr --part $part/2; done
expect 0 merge part.part{1,2}.abbe -o merged.exr
same_pixels guide1.exr merged.exr
expect 0 guided.scene "${small[@]}" --samples 8 -o resumed.exr --checkpoint keep
expect 0 guided.scene "${small[@]}" -o resumed.exr --resume
same_pixels guide1.exr resumed.exr
expect 0 guided.scene --quiet --size 64x64 --samples 16 --pilot 10 -o fewer.exr
[[ $(pixels fewer.exr) != $(pixels guide1.exr) ]] || fault "the size of the pilots changes nothing"

# with lamps that a wall hides, and a solid in which walks are drawn towards the surface
cat >hidden.scene <<'END'
scene 1
film { size 64 64 }
camera { from 0 9 0.1; look-at 0 0 0; fov 40 deg; exposure 10 stops }
render { samples 8 }
material stone subsurface { reflectance 0.6; mean-free-path 5 cm; boundary diffuse }
shape floor quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.6 } }
shape wall box { min -0.05 0 -3; max 0.05 3 3; material diffuse { reflectance 0.3 } }
shape ball sphere { center 1.2 0.6 -1; radius 0.6; material stone }
light left sphere { center -1 1.5 0; radius 0.1; power 20 W }
light right sphere { center 1 1.5 1; radius 0.1; power 60 W }
END
for threads in 1 2 8; do expect 0 hidden.scene --quiet -o hidden$threads.exr -t $threads; done
same_pixels hidden1.exr hidden2.exr
same_pixels hidden1.exr hidden8.exr
for part in 2 1; do expect 0 hidden.scene --quiet -o part.exr --part $part/2; done
expect 0 merge part.part{1,2}.abbe -o merged.exr
same_pixels hidden1.exr merged.exr
expect 0 hidden.scene --json -o hidden_again.exr
says out '"lights_by_arrival":true'
says out '"walks_to_surface":{"stone":0.'

# superset
expect 0 "$scenes/room.scene" --quiet -o least.exr
expect 0 "$scenes/room.scene" --quiet -o all.exr --kernel all
expect 0 info least.exr
says out "abbe.kernel = plain"
expect 0 info all.exr
says_not out "abbe.kernel = plain"
says out "abbe.effects = none"
same_pixels least.exr all.exr
# and of what ships: textures, absorption, motion, openings, depth of field
for name in textures shader-ball motion-blur hair-ball screen-and-lanterns; do
    shipped=$(cd "$scenes/../../../scenes/$name" && pwd)/$name.scene
    expect 0 "$shipped" --quiet --size 24x16 --samples 4 -o least.exr
    expect 0 "$shipped" --quiet --size 24x16 --samples 4 -o all.exr --kernel all
    same_pixels least.exr all.exr
done

# One pixel alone takes the samples that it takes in the image.
expect 0 "$scenes/room.scene" --pixel 20,16
cp out first
expect 0 "$scenes/room.scene" --pixel 20,16 --kernel all
cmp -s out first || fault "--pixel differs"
says out "pixel 20 16"

finish
