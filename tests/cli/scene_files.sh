#!/usr/bin/env bash
# What a scene may read and write (docs/language/files.md): of a scene file what it names, of a pack what is in it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$PWD/xdg
snippets=$(cd "$(dirname -- "$0")/../snippets" && pwd)

mkdir -p shot library elsewhere
cp "$snippets/any.ply" library/mesh.ply
cp "$snippets/any.png" library/paint.png
printf 'scene 1\nmaterial paint diffuse { reflectance image "paint.png" }\n' >library/paints.scene
for name in mesh.ply paint.png paints.scene; do
    ln -s "$PWD/library/$name" "shot/link-$name"
done
# A link to an included file leads to the folder that it is in: its own files are beside its name.
cp library/paint.png shot/paint.png

# shot WAY: a scene that names mesh, picture and layer by names that begin so.
shot() {
    local way=$1
    cat >shot/shot.scene <<END
scene 1
camera { from 0 0 5; look-at 0 0 0; exposure auto }
light sky { luminance 100 nits }
film { size 8 8; output "shot.exr" }
render { samples 2 }
include "${way}paints.scene"
shape plane { material diffuse { reflectance image "${way}paint.png" } }
shape mesh "${way}mesh.ply" { material paint }
END
}

# A scene file reads what it names, in whichever way it names it.
for way in ../library/ "$PWD/library/" link-; do
    shot "$way"
    expect 0 check shot/shot.scene
done

# With ABBE_ROOT it reads and writes below its own folder and below the folders that are listed.
for way in ../library/ "$PWD/library/" link-; do
    shot "$way"
    ABBE_ROOT=$PWD/shot expect 1 check shot/shot.scene
    tells err E0417 "${way}paint"
    ABBE_ROOT=$PWD/elsewhere:$PWD/library expect 0 check shot/shot.scene
    ABBE_ROOT=. expect 0 check shot/shot.scene
done
sed -i 's|output "[^"]*"|output "../elsewhere/shot.exr"|' shot/shot.scene
mkdir -p deep
(cd deep && ABBE_ROOT=$PWD/../library "$program" render ../shot/shot.scene -q 2>../err) && fault "an image where nothing may be written"
tells err E0417 elsewhere
[[ -z $(ls -A elsewhere) ]] || fault "something was written: $(ls -A elsewhere)"
(cd deep && ABBE_ROOT=$PWD/../library "$program" render ../shot/shot.scene -q -o ../elsewhere/mine.exr) || fault "-o is not the scene's"
rm elsewhere/*

# In a pack it reads nothing but the pack: absolute paths, ../ and links that lead out of it are faults at the name.
shot ../library/
expect 0 pack shot/shot.scene -o shot.abz
expect 0 check shot.abz
for name in /etc/hostname ../outside.png "$PWD/library/paint.png" ../../library/paint.png; do
    printf 'scene 1\nparam file "paint.png"\ncamera\nlight sky\nshape plane { material diffuse { reflectance image $file } }\n' >shot/one.scene
    expect 0 pack shot/one.scene -o one.abz
    expect 1 check one.abz -D "file=$name"
    tells err E0415 "$name"
    ABBE_ROOT=$PWD/library expect 1 check one.abz -D "file=$name"
    tells err E0415 "$name"
    sed 's/shape plane.*/shape mesh $file/; s/paint.png/link-mesh.ply/' shot/one.scene >shot/two.scene
    expect 0 pack shot/two.scene -o two.abz
    expect 1 check two.abz -D "file=$name"
    tells err E0415 "$name"
done

# It writes one image, whose name is that of an OpenEXR file, and what follows from that name.
shot ../library/
for name in shot.txt ../elsewhere/profile "$PWD/elsewhere/.bashrc" shot.exr/; do
    sed -i "s|output \"[^\"]*\"|output \"$name\"|" shot/shot.scene
    expect 2 render shot/shot.scene -q
    says err E0431
done
[[ -z $(ls -A elsewhere) ]] || fault "something was written: $(ls -A elsewhere)"
sed -i 's|output "[^"]*"|output "../elsewhere/shot.exr"|' shot/shot.scene
mkdir run
(cd run && "$program" render ../shot/shot.scene -q) || fault "an image elsewhere"
[[ -f elsewhere/shot.exr && -z $(ls -A run) ]] || fault "not the image that the scene names: $(ls -A run elsewhere)"
rm elsewhere/*
expect 0 pack shot/shot.scene -o shot.abz
(cd run && "$program" render ../shot.abz -q) || fault "an image of a pack"
[[ -f run/shot.exr && -z $(ls -A elsewhere) ]] || fault "a pack wrote elsewhere: $(ls -A run elsewhere)"

# -o says what is written, whatever the scene says; a check writes nothing.
before=$(find . -path ./xdg -prune -o -type f -print | sort)
expect 0 check shot/shot.scene
[[ $(find . -path ./xdg -prune -o -type f -print | sort) == "$before" ]] || fault "a check wrote something"
expect 0 render shot/shot.scene -q -o run/mine.exr
[[ -f run/mine.exr && -z $(ls -A elsewhere) ]] || fault "the scene wrote in spite of -o"
finish
