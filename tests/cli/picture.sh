#!/usr/bin/env bash
# What people look at: the PNG beside the image, its exposure, and what is said when there is nothing to see.
#   picture.sh PROGRAM JSON_LINES
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
room=$scenes/room.scene lamp=$scenes/first_lamp.scene
unset OCIO DISPLAY WAYLAND_DISPLAY

is_there() { [[ -s $1 ]] || fault "there is no $1"; }
is_absent() { [[ ! -e $1 ]] || fault "there is a $1"; }
attribute() { "$program" info "$1" | sed -n "s/^$2 = //p"; } # IMAGE NAME
proposed() { sed -n 's/.*write `exposure \(.*\) stops`, or.*/\1/p' err; }

# A PNG by default, the same as that of `convert`; under another name; none.
expect 0 "$room" -o room.exr
says err "image room.png"
says err "picture median "
says_not err "to look at it" # no terminal
expect 0 convert room.exr again.PNG
cmp -s room.png again.PNG || fault "render and convert differ"
rm room.png
for words in "--png off" "--png=off"; do
    # shellcheck disable=SC2086 # two words
    expect 0 "$room" -o room.exr $words
    is_absent room.png
    says_not err "room.png"
done
expect 0 --png look.png "$room" -o room.exr
is_there look.png
is_absent room.png

# The name says the format, or nothing is written.
expect 2 "$room" -o other.exr --png=look.jpg
says err E0432
is_absent other.exr
for name in room.jpg room.tif room room2.exr; do
    expect 2 convert room.exr "$name"
    says err E0432
    is_absent "$name"
    expect 2 convert room.exr "$name" --layer R
    is_absent "$name"
done

# What nobody asked for gives way: to a file that is not ours, to a folder, to a configuration without the view.
echo "a texture" >mine.png
expect 0 "$room" -o mine.exr
says err W0646
is_there mine.exr
[[ $(<mine.png) == "a texture" ]] || fault "a file that was not ours is gone"
expect 0 "$room" -o mine.exr --png --quiet
is_empty err
[[ $(head -c 4 mine.png) == $'\x89PNG' ]] || fault "--png wrote no PNG"
expect 0 "$room" -o mine.exr --quiet # ours now
is_empty err
mkdir folder.png
expect 0 "$room" -o folder.exr
says err W0646
expect 3 "$room" -o folder.exr --png
cat >small.ocio <<'END'
ocio_profile_version: 2
roles:
  default: raw
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  projector:
    - !<View> {name: plain, colorspace: raw}
colorspaces:
  - !<ColorSpace> {name: raw}
  - !<ColorSpace> {name: ACES2065-1}
END
OCIO=$PWD/small.ocio expect 0 "$room" -o config.exr
says err W0646
is_there config.exr
is_absent config.png
OCIO=$PWD/small.ocio expect 3 "$room" -o config.exr --png
expect 0 "$room" -o config.exr --quiet --ocio small.ocio --display projector --view plain
is_there config.png

# 800 lm over a ball: black at 0 stops, which is said with the stops that mend it; they do, and so does `convert`.
expect 0 "$lamp" -o lamp.exr
says err W0644
tells err W0644 black
says err "first_lamp.scene:6:1"
stops=$(proposed)
[[ -n $stops ]] || fault "no stops are proposed"
expect 0 "$lamp" -o mended.exr -D "stops=$stops"
says_not err W0644
expect 0 convert lamp.exr shown.png --exposure "$stops"
(($(stat -c %s shown.png) > $(stat -c %s lamp.png) + 200)) || fault "convert shows no more than before"
expect 0 "$lamp" -o white.exr -D stops=60
tells err W0644 white
[[ $(proposed) == "$stops" ]] || fault "$(proposed) stops are proposed for what is too bright, and $stops for what is too dark"
expect 4 "$lamp" -o lamp.exr --strict
expect 0 "$lamp" -o lamp.exr --png off # nobody looks
says_not err W0644

# The proposals of diagnostics lead to a picture.
sed 's/; power 800 lm//' "$lamp" >unlit.scene
expect 1 check unlit.scene
says err E0340
says err "exposure auto"
sed '/^camera/d' "$lamp" >unseen.scene
expect 1 check unseen.scene
says err "exposure auto"

# `exposure auto`: the same for any threads, samples, seeds and crops; stated; its figure repeats it.
sed 's/exposure $stops stops/exposure auto/' "$lamp" >auto.scene
expect 0 auto.scene -o auto.exr -t 1
says_not err W0644
says err "exposure auto is "
found=$(attribute auto.exr abbe.exposureStops)
[[ $(attribute auto.exr abbe.exposureMode) == auto ]] || fault "the header does not say that the exposure is automatic"
expect 0 auto.scene -q -o auto3.exr -t 3
same_pixels auto.exr auto3.exr
for words in "--samples 4" "--seed 9" "--crop 3,3,9,9"; do
    # shellcheck disable=SC2086 # two words
    expect 0 auto.scene -q -o other.exr $words
    [[ $(attribute other.exr abbe.exposureStops) == "$found" ]] || fault "$words changes the exposure"
done
expect 0 "$lamp" -q -o fixed.exr -D "stops=$found"
same_pixels auto.exr fixed.exr
for part in 1 2; do expect 0 auto.scene -q -o split.exr --part $part/2; done
is_absent split.png
expect 0 merge split.part{1,2}.abbe -o merged.exr
same_pixels auto.exr merged.exr
cmp -s auto.png merged.png || fault "the PNG of the merged image differs"
expect 0 auto.scene -q -o resumed.exr --samples 4 --checkpoint keep
expect 0 auto.scene -q -o resumed.exr --samples 16 --resume
same_pixels auto.exr resumed.exr
sed 's/look-at 0 0 8/look-at 0 0 8; exposure auto/' "$scenes/black.scene" >dark.scene
expect 0 dark.scene -o dark.exr
says err W0645
says err W0641
says_not err W0644

# For programs, and on a terminal.
expect 0 auto.scene -o auto.exr --json
says out '"picture":{"median_nits":'
says out '"exposure_auto":true'
on_terminal() { timeout 60 script -qec "$1 '$program' '$room' -o room.exr" /dev/null </dev/null >out 2>err; }
on_terminal "TERM=xterm"
tells out copy "$PWD/room.png"
on_terminal "TERM=xterm DISPLAY=:0"
tells out xdg-open room.png

finish
