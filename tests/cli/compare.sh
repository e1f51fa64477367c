#!/usr/bin/env bash
# abbe compare: figures, references, thresholds and the page.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

for seed in 0 1 2; do
    expect 0 "$scenes/room.scene" -o "$seed.exr" --seed "$seed" --quiet
done

# one image against another
expect 0 compare 0.exr 1.exr
for figure in relMSE PSNR HDR-FLIP ΔE2000 "8×8 means" "mean ratio" "not finite" "tiles of 8×8"; do says out "$figure"; done
expect 0 compare 0.exr 0.exr --threshold relmse=0 --threshold flip=0 --threshold delta-e=0 --threshold psnr=1000
tells out images equal
expect 4 compare 0.exr 0.exr --threshold agreement=0.01 # the seeds are the same

# bounds: each figure has its own, at most or at least
expect 4 compare 0.exr 1.exr --threshold 1e-9
says err "relmse of \`0.exr\`"
expect 4 compare 0.exr 1.exr --threshold relmse=1000 --threshold flip=1e-9
says err "flip of \`0.exr\`"
says_not err relmse
expect 0 compare 0.exr 1.exr --threshold psnr=1
expect 4 compare 0.exr 1.exr --threshold psnr=300
says err "not at least 300"
expect 2 compare 0.exr 1.exr --threshold flop=1
says err "did you mean \`flip\`"
expect 2 compare 0.exr 1.exr --threshold flip=much
expect 2 compare 0.exr 1.exr --threshold -1

# references
expect 0 compare 0.exr 1.exr --ref 2.exr
says out "nearer"
says out "reference  2.exr"
expect 0 compare 2.exr 1.exr --ref 2.exr --json
"$json_lines" nearer <out >nearer || fault "no JSON"
says nearer '"flip":"a"'
says nearer '"psnr":"a"'
expect 0 compare 0.exr --ref 1.exr --ref 2.exr
tells out noise references
expect 4 compare 0.exr 1.exr --ref 1.exr --threshold flip=1e-9 # holds for both, and one is not equal
expect 2 compare 0.exr
tells err image missing
expect 2 compare 0.exr --ref 1.exr --ref 2.exr --ref 0.exr

# what cannot be compared
expect 0 "$scenes/room.scene" -o small.exr --size 8x8 --quiet
expect 1 compare 0.exr small.exr
says err "differ in size"
expect 1 compare 0.exr 1.exr --ref small.exr
expect 3 compare 0.exr none.exr
expect 2 compare 0.exr 1.exr --ppd 0
# an image without variances has figures, but no test
sed "s/samples 16/samples 16; replicates 1/" "$scenes/room.scene" >single.scene
expect 0 single.scene -o single.exr --quiet
expect 0 compare single.exr 0.exr
says_not out "tiles of 8×8;"
expect 1 compare single.exr 0.exr --threshold agreement=0.01
says err variance.Y

# the page: whole or not at all, with nothing from elsewhere, names as text
name='<b>"&quot;</script>.exr'
mkdir -p '<b>"&quot;<'
cp 1.exr '<b>"&quot;<'/script\>.exr
cp 0.exr "<img src=x>.exr"
expect 0 compare "<img src=x>.exr" "$name" --html page.html
says err "page page.html"
says page.html "<title>&lt;img src=x&gt;.exr – script&gt;.exr</title>"
says_not page.html "<img"
says_not page.html '<b>'
says_not page.html "http:"
says_not page.html "https:"
[[ $(grep -c '</script>' page.html) -eq 5 ]] || fault "the page has $(grep -c '</script>' page.html) scripts"
expect 0 compare 0.exr 1.exr --ref 2.exr --html three.html
grep -q 'id="image2"' three.html && grep -q 'id="map1"' three.html || fault "the page lacks an image"
expect 3 compare 0.exr 1.exr --html no/such/page.html
expect 4 compare 0.exr 1.exr --threshold 1e-9 --html fails.html # the page is for such cases above all
[[ -s fails.html ]] || fault "no page for a comparison that fails"

finish
