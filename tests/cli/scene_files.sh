#!/usr/bin/env bash
# What a scene may read and write (docs/language/files.md): what is in its project and in folders that its user stated; of a pack what is in it.
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

# A scene reads below its own folder, and what its user allows.
for way in ../library/ "$PWD/library/" link-; do
    shot "$way"
    expect 1 check shot/shot.scene
    tells err E0417 "${way}paint"
    says err "\`--search $PWD/library\` lets the scene read there"
    expect 1 check shot/shot.scene --search elsewhere
    expect 0 check shot/shot.scene --search library
    expect 0 check shot/shot.scene --search elsewhere --search ./library/
    expect 0 check shot/shot.scene --search /
    ABBE_PATH=$PWD/elsewhere:$PWD/library expect 0 check shot/shot.scene
    touch .abbe-project
    expect 0 check shot/shot.scene
    rm .abbe-project
    touch shot/.abbe-project library/.abbe-project
    expect 1 check shot/shot.scene
    rm shot/.abbe-project library/.abbe-project
done

# An included file names what is in the project of the scene, from where it lies; alone it has its own folder.
mkdir -p deep/sets deep/paint
cp library/paint.png deep/paint/
printf 'scene 1\ncamera\nlight sky\ninclude "sets/room.scene"\n' >deep/shot.scene
printf 'scene 1\nshape plane { material diffuse { reflectance image "../paint/paint.png" } }\n' >deep/sets/room.scene
expect 0 check deep/shot.scene
expect 1 check deep/sets/room.scene
tells err E0417 ../paint/paint.png

# What is not beside the scene is found in the search folders, in their order, and said to be looked for there.
printf 'scene 1\ncamera\nlight sky\ninclude "paints.scene"\nshape mesh "mesh.ply" { material paint }\n' >shot/found.scene
expect 1 check shot/found.scene
says err E0401
says err "looked in shot"
expect 1 check shot/found.scene --search elsewhere
says err "looked in shot, $PWD/elsewhere"
expect 0 check shot/found.scene --search elsewhere --search library
ABBE_PATH=library expect 0 check shot/found.scene
mkdir first
printf 'scene 1\n' >first/paints.scene
expect 1 check shot/found.scene --search first --search library
tells err E0202 paint
ABBE_PATH=first expect 0 check shot/found.scene --search library

# What the command line names may lie anywhere, and what that includes or names does not.
printf 'scene 1\nparam file "paint.png"\ncamera\nlight sky\nmaterial m diffuse { reflectance image $file }\nshape plane { material m }\n' >shot/param.scene
expect 0 check shot/param.scene -D "file=$PWD/library/paint.png"
expect 0 check shot/param.scene --set "material.m.reflectance=image \"$PWD/library/paint.png\""

# The choice is handed on: to a sample that is taken again, to parts and to what merges them, elsewhere.
shot ../library/
cat >>shot/shot.scene <<'END'
shape ball sphere { material dielectric { ior 1.5 } }
END
expect 0 render shot/shot.scene -q --search library --part 1/2
expect 0 render shot/shot.scene -q --search library --part 2/2
(cd deep && "$program" merge ../shot.part*.abbe -o ../merged.exr 2>../err) || fault "parts cannot be merged elsewhere: $(cat err)"
expect 0 render shot/shot.scene -q --search library -o whole.exr
same_pixels merged.exr whole.exr
rm -f ./*.exr* ./*.png ./*.abbe

# An import of another folder tells what the scene has to be told.
mkdir -p foreign/textures
cp library/paint.png foreign/textures/
cat >foreign/room.pbrt <<'END'
LookAt 0 0 5 0 0 0 0 1 0
Camera "perspective"
WorldBegin
LightSource "infinite"
Texture "t" "spectrum" "imagemap" "string filename" "textures/paint.png"
Material "diffuse" "texture reflectance" "t"
Shape "sphere"
END
expect 0 check foreign/room.pbrt
expect 0 import foreign/room.pbrt -o deep/room.scene
says out "next: abbe render deep/room.scene --search $PWD/foreign"
expect 1 check deep/room.scene
expect 0 check deep/room.scene --search foreign
sed 's|textures/paint.png|../library/paint.png|' foreign/room.pbrt >foreign/other.pbrt
expect 1 check foreign/other.pbrt
tells err E0802 "outside of the scene's project"
expect 0 check foreign/other.pbrt --search library
expect 1 import foreign/other.pbrt -o deep/other.scene
expect 0 import foreign/other.pbrt -o deep/other.scene --search library
cat >foreign/room.xml <<'END'
<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>
<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="../library/paint.png"/></texture></bsdf></shape>
</scene>
END
expect 1 check foreign/room.xml
tells err E0417 ../library/paint.png
expect 0 check foreign/room.xml --search library

# It writes below its own folder and below the current one.
shot ""
sed -i '/^include/d; /^shape mesh/d' shot/shot.scene
sed -i 's|output "[^"]*"|output "../elsewhere/shot.exr"|' shot/shot.scene
(cd deep && "$program" render ../shot/shot.scene -q 2>../err) && fault "an image where nothing may be written"
tells err E0417 elsewhere
[[ -z $(ls -A elsewhere) ]] || fault "something was written: $(ls -A elsewhere)"
(cd deep && "$program" render ../shot/shot.scene -q -o ../elsewhere/mine.exr) || fault "-o is not the scene's"
rm elsewhere/*
sed -i 's|output "[^"]*"|output "elsewhere/shot.exr"|' shot/shot.scene
expect 0 render shot/shot.scene -q
[[ -f elsewhere/shot.exr ]] || fault "no image below the current folder"
rm elsewhere/*

# In a pack it reads nothing but the pack: absolute paths, ../ and links that lead out of it are faults at the name.
shot ../library/
expect 0 pack shot/shot.scene -o shot.abz --search library
expect 0 check shot.abz
for name in /etc/hostname ../outside.png "$PWD/library/paint.png" ../../library/paint.png; do
    printf 'scene 1\nparam file "paint.png"\ncamera\nlight sky\nshape plane { material diffuse { reflectance image $file } }\n' >shot/one.scene
    expect 0 pack shot/one.scene -o one.abz
    expect 1 check one.abz -D "file=$name"
    tells err E0415 "$name"
    ABBE_PATH=$PWD/library expect 1 check one.abz -D "file=$name"
    tells err E0415 "$name"
    sed 's/shape plane.*/shape mesh $file/; s/paint.png/link-mesh.ply/' shot/one.scene >shot/two.scene
    expect 0 pack shot/two.scene -o two.abz --search library
    expect 1 check two.abz -D "file=$name"
    tells err E0415 "$name"
done

# It writes one image, whose name is that of an OpenEXR file, and what follows from that name.
shot ../library/
export ABBE_PATH=$PWD/library
for name in shot.txt ../elsewhere/profile "$PWD/elsewhere/.bashrc" shot.exr/; do
    sed -i "s|output \"[^\"]*\"|output \"$name\"|" shot/shot.scene
    expect 2 render shot/shot.scene -q
    says err E0431
done
[[ -z $(ls -A elsewhere) ]] || fault "something was written: $(ls -A elsewhere)"
sed -i 's|output "[^"]*"|output "../elsewhere/shot.exr"|' shot/shot.scene
mkdir run
(cd run && "$program" render ../shot/shot.scene -q --search ../elsewhere) || fault "an image elsewhere"
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
