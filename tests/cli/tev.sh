#!/usr/bin/env bash
# `abbe render --tev` and `abbe view --tev`: what a viewer gets is what the image has, and no viewer can hold a render up or fail it.
#   tev.sh PROGRAM JSON_LINES RECEIVER
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
receiver=$(realpath -- "$3")
viewer=

# listen HOW FILE: a viewer in the background; its port is in $port.
listen() {
    rm -f port
    "$receiver" port "$2" "$1" >seen 2>complaint &
    viewer=$!
    for _ in $(seq 200); do [[ -s port ]] && break; sleep 0.05; done
    port=$(<port)
}

# saw FACT…: the viewer ended well and tells these.
saw() {
    wait "$viewer" || { fault "the viewer: $(<complaint)"; return; }
    local fact
    for fact in "$@"; do says seen "$fact"; done
}

with() { sed "s|film   {|film   {\n    $1\n   |" "$scenes/layers.scene"; }
with '' >layers.scene
sed 's|film   {|film   {\n    output "x.exr" space=rec709\n   |' "$scenes/room.scene" >plain.scene

# All channels of a film with layers, in the colours that tev expects; the first look, and the picture as it was written.
listen plain one.exr
expect 0 layers.scene --size 96x64 --samples 64 --quiet --tev="127.0.0.1:$port" -o one.exr
saw "image one.exr 96x64" "creates 1" "looks 1"
is_empty err
# Its bits do not depend on it.
expect 0 layers.scene --size 96x64 --samples 64 --quiet -o two.exr
same_pixels one.exr two.exr
listen plain three.exr
expect 0 plain.scene --crop 3,4,40,31 --samples 32 --quiet --tev="localhost:$port" -o three.exr
saw "image three.exr 37x27"

# A view: the bits of a render in the end, through an edit, until the image is closed.
rm -f port.done
expect 0 render layers.scene --size 96x64 --samples 64 --quiet -o view.exr
listen view view.exr
sed 's/samples [0-9]*/samples 1/' layers.scene >seen.scene
"$program" view seen.scene --size 96x64 --samples 64 --tev="127.0.0.1:$port" >url 2>told &
job=$!
for _ in {1..600}; do [[ -s url ]] && break; sleep 0.1; done
sleep 1
cp layers.scene seen.new && mv seen.new seen.scene
for _ in {1..600}; do [[ -e port.done ]] && break; sleep 0.1; done
kill -INT "$job"
ended_with 0
saw "image seen.scene 96x64" "creates 1"
is_empty told
"$program" view plain.scene --samples 8 --tev="127.0.0.1:$port" >url 2>told & # nobody listens any longer
job=$!
for _ in {1..600}; do grep -q W0679 told && break; sleep 0.1; done
kill -INT "$job"
ended_with 0
tells told W0679 "127.0.0.1:$port"
[[ $(grep -c 'warning\[W0679' told) -eq 1 ]] || fault "the view says more than once that nobody listens"
expect 2 view plain.scene --tev=host:0

# Slow, late, and one that hangs up in between.
listen slow slow.exr
expect 0 layers.scene --size 96x64 --samples 32 --quiet --tev="127.0.0.1:$port" -o slow.exr
saw "creates 1"
listen late late.exr
expect 0 plain.scene --samples 256 --quiet --tev="127.0.0.1:$port" -o late.exr
saw "image late.exr 48x32"
listen drop drop.exr
expect 0 layers.scene --size 96x64 --samples 512 --quiet --tev="127.0.0.1:$port" -o drop.exr
saw "creates 2"
is_empty err

# One that takes nothing of 20 MB: the render ends all the same, and soon.
listen stuck stuck.exr
begin=$SECONDS
expect 0 layers.scene --size 500x400 --samples 2 --quiet --tev="127.0.0.1:$port" -o stuck.exr
[[ $((SECONDS - begin)) -lt 200 ]] || fault "a viewer that takes nothing held the render up"
kill "$viewer"
wait "$viewer" 2>/dev/null
viewer=

# Nobody: a warning, once.
expect 0 plain.scene --samples 64 --tev="127.0.0.1:$port" -o none.exr
tells err W0679 "127.0.0.1:$port"
says err "help: start tev"
[[ $(grep -c W0679 err) -le 2 ]] || fault "it is said more than once" # and where to read more
expect 4 plain.scene --samples 64 --strict --tev="127.0.0.1:$port" -o none.exr

# What is no place.
for place in host:0 host:x ::1 '[::1' 'http://host'; do
    expect 2 plain.scene --tev="$place" -o no.exr
    says err "--tev"
done
expect 2 plain.scene --tev --part 1/2
says err "leave one of them out"
[[ ! -e no.exr ]] || fault "an image in spite of a wrong command line"
finish
