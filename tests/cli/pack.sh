#!/usr/bin/env bash
# abbe pack: the packed scene is the same scene, wherever it is, and nothing of a pack reaches out of it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

shipped=$(cd "$(dirname -- "$0")/../../scenes" && pwd)
snippets=$(cd "$(dirname -- "$0")/../snippets" && pwd)
export XDG_CACHE_HOME=$folder/xdg TMPDIR=$folder/tmp
mkdir -p "$TMPDIR"

# A scene whose files are everywhere: beside it, in a folder, above it, at an absolute path; two of one name; tiles; a
# glTF file with its buffer; a volume, a lamp, spectra, an environment, parameters.
touch .abbe-project # whose scenes may name what is in it
mkdir -p artist/shot/tex artist/library/tex artist/models/buffers "artist/odd name"
cp "$snippets/any.png" artist/shot/tex/wood.png
cp "$snippets/any.tif" artist/library/tex/wood.png # by its contents a picture of another kind
for tile in 1001 1002; do cp "$snippets/any.png" "artist/library/tex/skin.$tile.png"; done
cp "$snippets/any.ies" artist/library/
printf '400 0.2\n700 0.6\n' >artist/shot/paint.csv
cp "$snippets/any.exr" "artist/odd name/sky \"1\".exr"
cp "$snippets/any.ply" artist/library/any.ply
expect 0 volume make smoke artist/library/smoke.vdb --resolution 24 -q
tools=$(dirname -- "$(realpath -- "$0")")
nodejs "$tools/packs.mjs" gltf artist/models || fault "no glTF file"
cat >artist/shot/shot.scene <<S
scene 1
// a comment that stays
param shade 0.5 "how dark the floor is"
param picture "../library/tex/wood.png" "what is on the wall"
camera { from 0 2 6; look-at 0 0.5 0; exposure auto }
film { size 40 24; output "$folder/artist/picture.exr" }
render { samples 4; seed 3 }
light environment { image "$folder/artist/odd name/sky \"1\".exr" }
light ies "../library/any.ies" { position 0 3 0 }
texture grain image "tex/./wood.png"
texture other image \$picture
material floor diffuse { reflectance \$shade }
material wall diffuse { reflectance other }
material skin diffuse { reflectance image "../library/tex/skin.<UDIM>.png" }
material paint diffuse { reflectance table "paint.csv" }
material wood diffuse { reflectance grain }
shape mesh "../models/square.gltf" { material floor }
shape quad { points -2 0 -1  2 0 -1  2 2 -1  -2 2 -1; material wall }
shape mesh "$folder/artist/library/any.ply" { material wood }
shape sphere { center 1 0.5 0; radius 0.5; material paint }
shape quad { points 0 0 1  1 0 1  1 1 1  0 1 1; material skin }
volume vdb "../library/smoke.vdb" { scattering 1 per-m }
S
expect 0 check artist/shot/shot.scene || { cat out err; }
expect 0 pack artist/shot/shot.scene -o shot.abz
says out "shot.abz"
cp shot.abz first.abz
touch artist/shot/tex/wood.png artist/shot/shot.scene
TZ=Asia/Tokyo expect 0 pack artist/shot/shot.scene -o shot.abz
cmp shot.abz first.abz || fault "the same inputs make other bytes"

# Anybody can look into it.
mkdir by-hand
(cd by-hand && cmake -E tar xf ../shot.abz) || fault "not a ZIP file for others"
nodejs "$tools/packs.mjs" check by-hand 12 || fault "abz.json does not list the files"
says by-hand/shot.scene "a comment that stays"
says by-hand/shot.scene 'param shade 0.5 "how dark the floor is"'
says_not by-hand/shot.scene "../"
says by-hand/shot.scene 'image "files/sky \"1\".exr"'
[[ $(grep -c "$folder" by-hand/shot.scene) -eq 1 ]] || fault "paths of the artist stay" # that of the picture

# The same bits without the artist's files: from the pack, from its folder, from a folder that pack made.
expect 0 render artist/shot/shot.scene -q -o plain.exr
expect 0 render artist/shot/shot.scene -q -o dark.exr -D shade=0.1 -D picture=tex/wood.png
expect 0 render artist/shot/shot.scene -q -o split.exr --part 1/2
expect 0 pack artist/shot/shot.scene -o given.abz -D shade=0.1 -D picture=tex/wood.png
expect 0 pack artist/shot/shot.scene -o folder/
expect 3 pack artist/shot/shot.scene -o folder/
mv artist gone
expect 0 render shot.abz -q -o packed.exr
same_pixels plain.exr packed.exr
same_certificate plain.exr packed.exr
expect 0 render by-hand/shot.scene -q -o by-hand.exr
same_pixels plain.exr by-hand.exr
expect 0 render folder/shot.scene -q -o folder.exr
same_pixels plain.exr folder.exr
diff -r by-hand folder || fault "the folder is not the unpacked pack"
expect 0 render given.abz -q -o given.exr
same_pixels dark.exr given.exr
expect 0 render shot.abz -q -o dark-again.exr -D shade=0.1 -D picture=tex/wood.png
same_pixels dark.exr dark-again.exr
expect 0 pack shot.abz -o again.abz
cmp shot.abz again.abz || fault "a pack that is packed is another one"

# One render is one render, packed or not: parts of both fit together.
expect 0 render shot.abz -q -o split.exr --part 2/2
expect 0 merge split.part1.abbe split.part2.abbe -o merged.exr --scene shot.abz
same_pixels plain.exr merged.exr

# Every command that takes a scene takes a pack, and what they write is where they are run.
expect 0 check shot.abz
expect 0 info shot.abz
expect 0 explain shot.abz
expect 0 replay shot.abz --pixel 5,5 --sample 0:1
expect 0 study shot.abz --samples 8 --seeds 2 --variants none -q --size 16x10
[[ -e shot-study.html ]] || fault "no study beside the pack"
expect 0 verify shot.abz --samples 32 -q --size 16x10
mkdir run
(cd run && "$program" render ../shot.abz -q --checkpoint keep) || fault "a render from elsewhere"
[[ -e run/picture.exr && -e run/picture.exr.ckpt && ! -e gone/picture.exr ]] || fault "the picture is elsewhere: $(ls run)"
[[ -z $(ls -A "$TMPDIR") ]] || fault "left in the temporary folder: $(ls -A "$TMPDIR")"
expect 2 check --fix shot.abz
cmp shot.abz first.abz || fault "check --fix changed a pack"
[[ $(stat -c %a "$XDG_CACHE_HOME/abbe/packs") == 700 ]] || fault "the cache is not private"
rm -r "$XDG_CACHE_HOME/abbe/packs"

# Without a home the folder of temporary files has the cache.
(unset XDG_CACHE_HOME HOME && "$program" check -q shot.abz) || fault "no pack without a home"
[[ $(stat -c %a "$TMPDIR/abbe-packs-$(id -u)") == 700 ]] || fault "the cache for want of a home is not private"

# Names that clash, on any system, and names that are none elsewhere.
mkdir -p clash/{a,b,c,shot/files}
number=1
for file in a/x.csv b/x.csv c/X.csv shot/files/x.csv shot/abz.json 'shot/we\ird: "1".csv'; do
    printf '400 0.%d\n700 0.2\n' $number >"clash/$file"
    number=$((number + 1))
done
{
    printf 'scene 1\ncamera { from 0 0 9; look-at 0 0 0; exposure auto }\nfilm { size 24 16 }\nrender { samples 2 }\nlight sky { luminance 5000 nits }\n'
    x=-3
    for name in ../a/x.csv ../b/x.csv ../c/X.csv files/x.csv abz.json 'we\\ird: \"1\".csv' "$folder/clash/a/../a/x.csv"; do
        printf 'shape sphere { center %d 0 0; radius 0.5; material diffuse { reflectance table "%s" } }\n' $x "$name"
        x=$((x + 1))
    done
} >clash/shot/clash.scene
expect 0 render clash/shot/clash.scene -q -o clash.exr
expect 0 pack clash/shot/clash.scene -o clash.abz
expect 0 pack clash/shot/clash.scene -o clash-folder/
mv clash clash-gone
expect 0 render clash.abz -q -o packed.exr
same_pixels clash.exr packed.exr
[[ $(find clash-folder -type f | wc -l) -eq 8 ]] || fault "not each file once: $(find clash-folder -type f)"
[[ $(find clash-folder -type f | tr '[:upper:]' '[:lower:]' | sort -u | wc -l) -eq 8 ]] || fault "names differ in case alone"

# A faulty scene makes no pack; messages of a packed scene name pack and line.
expect 1 pack "$bad/$(basename "$(find "$bad" -name '*.scene' | sort | head -1)")" -o bad.abz
[[ ! -e bad.abz ]] || fault "a faulty scene was packed"
expect 3 pack nowhere.scene -o bad.abz
expect 2 pack shot.abz
expect 1 check shot.abz -D picture=/etc/hostname
tells err "E0415" "/etc/hostname"
expect 1 check shot.abz -D picture=../outside.png
says err "E0415"

# Packs that were made to do harm are refused, and nothing is made outside of the cache.
nodejs "$tools/packs.mjs" make . >made || fault "no made packs"
while read -r code pack message; do
    expect "$code" check "$pack"
    says err "$message"
    for evil in evil tmp/evil xdg/evil xdg/abbe/evil xdg/abbe/packs/evil /tmp/evil; do
        [[ ! -e $evil && ! -L $evil ]] || fault "$pack made $evil"
    done
done <made

# Damage anywhere is found, if not by the checksum of a file, then by its hash.
cp shot.abz damaged.abz
size=$(stat -c %s damaged.abz)
for ((at = 10; at < size; at += size / 40)); do
    rm -rf "$XDG_CACHE_HOME/abbe/packs"
    cp shot.abz damaged.abz
    printf '\xA5' | dd of=damaged.abz bs=1 seek="$at" conv=notrunc status=none
    cmp -s shot.abz damaged.abz && continue
    timeout 60 "$program" check damaged.abz >out 2>err
    case $? in
    0) "$program" render damaged.abz -q -o damaged.exr 2>err && same_pixels plain.exr damaged.exr ;; # names of systems and the like
    3) says err E04 ;;
    *) fault "byte $at: $? $(cat err)" ;;
    esac
done
head -c $((size / 2)) shot.abz >half.abz
expect 3 check half.abz
says err E0414

# Shipped scenes, with volumes, meshes and pictures.
for scene in candle textures instance-field magnifier screen-and-lanterns displaced-stones; do
    expect 0 pack "$shipped/$scene/$scene.scene" -o "$scene.abz"
    expect 0 render "$shipped/$scene/$scene.scene" -q -o plain.exr --size 24x16 --samples 2 --pilot 0
    expect 0 render "$scene.abz" -q -o packed.exr --size 24x16 --samples 2 --pilot 0
    same_pixels plain.exr packed.exr
done
finish
