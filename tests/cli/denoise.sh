#!/usr/bin/env bash
# Denoising by Open Image Denoise: with a library that stands for it, and with the real one where there is one.
#   denoise.sh PROGRAM JSON_LINES OIDN_STUB FOLDER_OF_PYTHON
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
stub=$(realpath -- "$3")
packages=$4
unset ABBE_OIDN OIDN_STUB OIDN_STUB_LOG

sed 's|film   {|film   {\n    layers { denoise }\n   |' "$scenes/room.scene" >room.scene
expect 0 room.scene --size 80x64 --samples 16 --quiet -o room.exr
"$program" info room.exr | grep -E '^ *(channels|abbe\.(samples|seed))' >before

# The header has the name and the version; nothing else of the picture changes, and another method takes its place.
export ABBE_OIDN=$stub
expect 0 denoise room.exr --method oidn -o oidn.exr
says err "denoised by oidn 1 (Open Image Denoise 2.5.9, cpu)"
says err "relMSE"
expect 0 info oidn.exr
says out "abbe.denoiser = oidn 1 (Open Image Denoise 2.5.9, cpu) (biased)"
expect 0 compare oidn.exr room.exr --threshold 0
expect 0 denoise room.exr --method oidn --json -o oidn.exr
says out '"denoiser":"oidn 1 (Open Image Denoise 2.5.9, cpu)"'
says out '"outside_rec709"'
expect 0 denoise oidn.exr --method preview
expect 0 info oidn.exr
says out "abbe.denoiser = preview 2 (biased)"

# What is wrong is said with what can be done, and the file stays as it was.
cp room.exr kept.exr
for mode in commit:E0444 memory:E0444 nan:E0444 old:E0443 no-device:E0443; do
    OIDN_STUB=${mode%:*} expect 3 denoise room.exr --method oidn
    says err "${mode#*:}"
    says err "nfor"
done
ABBE_OIDN=$folder/nowhere expect 3 denoise room.exr --method oidn
tells err E0442 "nowhere"
says err "help: name the file"
ABBE_OIDN='' VIRTUAL_ENV='' HOME=$folder timeout 60 "$program" denoise room.exr --method oidn >out 2>err
code=$?
[[ $code -eq 0 ]] || says err "pip install pyoidn" # unless the system has it
[[ $code -eq 0 ]] || cmp -s room.exr kept.exr || fault "a file was written without a denoiser"
expect 2 denoise room.exr --method odin
says err "oidn"
expect 2 denoise room.exr --method oidn --preview
says err "leave one out"

# The real one: the same bits for any number of threads, and less noise.
real=$(compgen -G "$packages/lib/python3*/site-packages/pyoidn/oidn/lib/libOpenImageDenoise.so.2" | head -n 1)
if [[ -n $real && -z ${ASAN_OPTIONS:-} ]]; then
    export ABBE_OIDN=$packages
    expect 0 denoise kept.exr --method oidn -t 1 --json -o one.exr
    error=$(sed -n 's/.*"rel_mse":\([0-9.e-]*\).*/\1/p' out)
    before=$(sed -n 's/.*"rel_mse_before":\([0-9.e-]*\).*/\1/p' out)
    awk -v a="$error" -v b="$before" 'BEGIN { exit !(a < b / 2) }' || fault "relMSE $error, before $before"
    expect 0 denoise kept.exr --method oidn -t 2 -o two.exr
    same_pixels one.exr two.exr
    expect 0 compare one.exr kept.exr --threshold 0
else
    echo "no Open Image Denoise in $packages: the real one was not tried"
fi
finish
