#!/usr/bin/env bash
# An image says how large its error is: in its header, in a file beside it, in the report; and `certify` measures it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
room=("$scenes/room.scene" --size 48x32)

dark=--exposure=-1
expect 0 "${room[@]}" --samples 32 "$dark" -o image.exr
says err "  error "
says err "display "
says err " of 255 ("
[[ -s image.exr.json ]] || fault "no file beside the image"
for word in abbe-certificate relative display worst_tile caveat capped_paths dropped core_seconds; do
    says image.exr.json "\"$word"
done
expect 0 info image.exr
says out "certificate  error "
says out "abbe.certificate = abbe-certificate 1"
tells out abbe.errorDisplayView "-1 stops" abbe-aces-1.3

# Held against long renders; against a picture of something else it is outside.
expect 0 "${room[@]}" --samples 1024 --seed 2 -q -o long2.exr
expect 0 "${room[@]}" --samples 1024 --seed 3 -q -o long3.exr
expect 0 certify image.exr --ref long2.exr --ref long3.exr "$dark"
says out ": inside"
says_not out ": outside"
expect 0 certify image.exr
says_not out measured

# The reference's own error is taken into account: one that is as noisy as the image differs from it by 1.4 times as much.
expect 0 certify image.exr --ref long2.exr "$dark"
says out ": inside"
says_not out ": outside"
is_empty err
expect 0 "${room[@]}" --samples 32 --seed 2 "$dark" -q -o short2.exr
expect 0 certify image.exr --ref short2.exr "$dark"
says_not out ": outside"
is_empty err
expect 0 "${room[@]}" --samples 256 -q -o own.exr
expect 0 certify image.exr --ref own.exr "$dark"
tells err own.exr seed "(0)"
expect 0 certify image.exr --ref own.exr --ref long2.exr "$dark"
says err "is left out"
expect 0 certify image.exr --ref long2.exr --ref long2.exr "$dark" --json
says out "has the seed of"
says out '"measured_interval"'
"$json_lines" <out >/dev/null || fault "certify --json"
expect 0 "$scenes/glass.scene" --size 48x32 --samples 32 -q -o glass.exr
expect 4 certify image.exr --ref glass.exr "$dark"
says out ": outside"
expect 4 certify image.exr --ref glass.exr "$dark" --json
"$json_lines" <out >/dev/null || fault "certify --json"
expect 0 certify image.exr --ref long2.exr --exposure 1
says err "the display's error is not measured"
expect 0 "$scenes/room.scene" --samples 4 --size 32x32 -q -o small.exr
expect 1 certify image.exr --ref small.exr
expect 2 certify image.exr --ref a --ref b --ref c

# Noise that few samples carry, as no pilot looks for what they find: said in the summary, in the header and beside the image.
expect 0 "$scenes/glossy_caustic.scene" --pilot 0 -o glossy.exr
says err W0649
tells err W0649 "k 0."
says glossy.exr.json '"pareto_k"'
says glossy.exr.json '"tiles_untrusted"'
expect 0 info glossy.exr
tells out variance.Y "error bars"
says out "abbe.errorUnseen = "
expect 0 "${room[@]}" --samples 64 -o even.exr
says_not err W0649

# A certificate that cannot be given, and a file that cannot be written.
sed 's/^scene .*/&\nrender { replicates 1 }/' "$scenes/room.scene" >single.scene
grep -q '^render' "$scenes/room.scene" && sed 's/^render *{/render { replicates 1;/' "$scenes/room.scene" >single.scene
expect 0 single.scene --size 16x16 --samples 4 -o single.exr
says err "no certificate: one replicate"
says single.exr.json '"stated": false'
says_not single.exr.json '"low"'
expect 1 certify single.exr
mkdir folder.exr.json
expect 0 "${room[@]}" --samples 4 -o folder.exr
says err W0667
[[ -s folder.exr ]] || fault "the image is missing"

finish
