#!/usr/bin/env bash
# Files that hold layers: parts, deep samples, overscan, and how they are looked at.
#   layers.sh PROGRAM JSON_LINES
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

# with LINE >FILE: the scene with layers, and this in its film.
with() { sed "s|film   {|film   {\n    $1\n   |" "$scenes/layers.scene"; }
small=(--size 40x24 --samples 16 --quiet)

# Each layer in a part of its own: the same values.
with '' >one.scene
with 'output "x.exr" parts=layers' >parts.scene
expect 0 one.scene "${small[@]}" -o one.exr
expect 0 parts.scene "${small[@]}" -o parts.exr
same_pixels one.exr parts.exr
same_pixels one.deep.exr parts.deep.exr
expect 0 info one.exr
says_not out "parts "
expect 0 info parts.exr
says out "parts        2"
says out "forward.u (float)"
says out "abbe.samples = 16"
expect 0 compare one.exr parts.exr --threshold 0
expect 0 denoise parts.exr
expect 0 denoise one.exr
same_pixels one.exr parts.exr
with 'output "x.exr" parts=layers container=aces' >both.scene
expect 1 both.scene "${small[@]}"
says err E0453

# Deep samples.
expect 0 one.scene --size 40x24 --samples 2 -o told.exr
says err "image told.deep.exr"
expect 0 info one.deep.exr
says out "samples      deep"
says out "channels     A (float) B (float) G (float) R (float) Z (float) ZBack (float)"
expect 0 convert one.deep.exr deep.png
expect 0 convert one.exr one.png
cmp -s deep.png one.png || fault "deep samples put over each other are not the picture"

# Layers as pictures.
for layer in albedo normal position depth uv forward object material CryptoObject samples variance group_lamp direct \
    denoised S0.425nm depth.Z half.albedo; do
    for image in one parts; do expect 0 convert $image.exr $layer.$image.png --layer $layer; done
    cmp -s $layer.one.png $layer.parts.png || fault "$layer differs between the files"
    [[ $(sha256sum <$layer.one.png) != "$(sha256sum <one.png)" ]] || fault "$layer is shown as the picture"
done
expect 1 convert one.exr no.png --layer dept
says err E0657
says err "did you mean \`depth\`?"
expect 1 convert one.exr no.png --layer zebra
says err "its layers are"
says err "albedo"
[[ ! -e no.png ]] || fault "a picture of no layer"

# Overscan: in the file, and in the PNG on request alone.
with 'overscan 8 4 6 2' >wide.scene
expect 0 wide.scene "${small[@]}" -o wide.exr --png=wide.png
expect 0 info --json wide.exr
tr -d ' \n' <out >line
says line '"window":{"x0":-8,"y0":-4,"x1":46,"y1":26}'
says line '"display":{"x0":0,"y0":0,"x1":40,"y1":24}'
expect 0 convert wide.exr inside.png
expect 0 convert wide.exr everything.png --overscan
png_size() { od -An -tu1 -j16 -N8 "$1" | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'; }
for png in one wide inside; do [[ $(png_size $png.png) == 40x24 ]] || fault "$png.png has $(png_size $png.png)"; done
[[ $(png_size everything.png) == 54x30 ]] || fault "everything.png has $(png_size everything.png)"
# Inside it is the picture to the bit: a crop of it has the same pixels.
expect 0 wide.scene "${small[@]}" -o cut.exr --crop 0,0,40,24
expect 0 one.scene "${small[@]}" -o one.exr
same_pixels cut.exr one.exr
same_pixels cut.deep.exr one.deep.exr
# Parts of it, put together, are the whole.
expect 0 wide.scene "${small[@]}" -o a.exr --part 1/1 --crop=-8,-4,5,26
expect 0 wide.scene "${small[@]}" -o b.exr --part 1/1 --crop 5,-4,46,26
expect 0 merge a.part1.abbe b.part1.abbe -o merged.exr
same_pixels wide.exr merged.exr
expect 2 wide.scene "${small[@]}" --crop=-9,0,5,5
tells err E0609 "-8,-4,46,26"
with 'overscan 1 2 3' >three.scene
expect 1 check three.scene
says err E0656

# Parts of samples with every layer, of which a merge has a few rows at a time: the bits of the whole, also by way of a
# part that stands for two, and with each layer in a part of the file.
expect 0 one.scene "${small[@]}" -o one.exr
for part in 1 2 3; do expect 0 one.scene "${small[@]}" -o p.exr --part $part/3; done
expect 0 merge p.part*.abbe -o p.exr
same_pixels one.exr p.exr
same_pixels one.deep.exr p.deep.exr
cmp -s one.png p.png || fault "the PNG of parts differs"
expect 0 merge p.part[12].abbe -o two.abbe
expect 0 merge two.abbe p.part3.abbe -o q.exr
same_pixels one.exr q.exr
same_pixels one.deep.exr q.deep.exr
same_certificate one.exr q.exr
of_layers() { "$program" info "$1" | grep -E '^(cryptomatte/|abbe\.ids)'; }
[[ -n $(of_layers one.exr) && $(of_layers one.exr) == "$(of_layers q.exr)" ]] || fault "attributes of layers differ"
expect 0 merge p.part[13].abbe --so-far -o far.exr
expect 0 info far.exr
says out "abbe.partial = 1"
for part in 1 2; do expect 0 parts.scene "${small[@]}" -o l.exr --part $part/2; done
expect 0 merge l.part*.abbe -o l.exr
same_pixels one.exr l.exr
same_pixels one.deep.exr l.deep.exr
expect 0 info l.exr
says out "parts        2"
# Damage that only shows when layers are read leaves no image.
printf 'x' | dd of=two.abbe bs=1 seek=$(($(stat -c %s two.abbe) - 200)) conv=notrunc status=none
expect 1 merge two.abbe p.part3.abbe -o none.exr
says err E0662
[[ ! -e none.exr && ! -e none.deep.exr ]] || fault "an image of a damaged part"

# A merge needs no more memory for more rows: this film has 985 MB of layers.
sed 's/spectral 400 700 50/spectral 360 830 1/' one.scene >tall.scene
for ((y = 0; y < 512; y += 64)); do
    expect 0 tall.scene --size 128x512 --samples 2 --quiet --crop 0,$y,128,$((y + 64)) --part 1/1 -o tall$y.exr
done
memory_of() { sed -n 's/.*"event":"done".*"memory_bytes":\([0-9]*\).*/\1/p' out; }
expect 0 merge tall*.abbe --json -o tall.exr
sanitized || (($(memory_of) < 400000000)) || fault "a merge took $(memory_of) bytes of memory"
expect 0 merge tall0.part1.abbe --json -o tall.abbe
expect 0 info tall.exr
says out "S0.829,5nm (float)"

# What might not fit into memory is told where it is asked for.
sed 's/deep 6/deep 4096/' "$scenes/layers.scene" >many.scene
expect 0 many.scene --size 512x512 --samples 1000000 --time 0.1s --checkpoint off --quiet -o many.exr
says err W0657
says err "many.scene:9:17"
sed 's/deep 6/deep 1/' "$scenes/layers.scene" >few.scene
expect 1 check few.scene
tells err deep "samples of a pixel"

finish
