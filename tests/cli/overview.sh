#!/usr/bin/env bash
# All frames of an animation at a glance: the contact sheet and the clip.
#   overview.sh PROGRAM JSON_LINES
# shellcheck disable=SC2016 # a name that a shell would take for a command
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
look=$scenes/../overview.mjs

command -v node >/dev/null || { echo "no node"; exit 77; }
cp "$scenes/shot.scene" .
node=$(command -v node)
tiles() { "$node" "$look" "$@" || fault "overview.mjs $*"; } # SHEET tile gap strip columns count, and the PNGs of the frames; - is a gap

# A sheet has the pixels of the frames' PNGs.
expect 0 render shot.scene --frames 1-5 --size 64x36 -o s.####.exr -q --contact-sheet sheet.png
is_empty err
tiles sheet.png 64x36 1 16 3 5 s.000{1..5}.png
expect 0 info s.0003.exr
says out "abbe.frame = 3"
# Larger frames are made smaller: two by two pixels to one.
expect 0 render shot.scene --frames 8-10 --size 640x400 --samples 2 -o l.####.exr --contact-sheet large.png --view Raw --exposure 1
says err "contact sheet large.png: 3 of 3 frames"
tiles large.png 320x200 8 16 2 3 l.00{08,09,10}.png
# What was there already is in it as well, and nothing is rendered for it.
rm s.0002.exr
expect 0 render shot.scene --frames 1-5 --size 64x36 -o s.####.exr --resume --contact-sheet again.png
says err "1 of 5 frames rendered, 4 were there"
cmp sheet.png again.png || fault "the sheet of frames that were there is another one"
expect 0 render shot.scene --frames 1-5 --size 64x36 -o s.####.exr --resume --contact-sheet again.png --json
tells out '"event":"overview"' '"kind":"contact sheet"' '"file":"again.png"' '"frames":5' '"gaps":""'
"$json_lines" <out >/dev/null || fault "events are no JSON"
# A frame that fails is a gap.
mkdir f.0003.exr
expect 3 render shot.scene --frames 1-5 --size 64x36 -o f.####.exr --contact-sheet gap.png
says err "contact sheet gap.png: 2 of 5 frames; a gap in the place of frame 3"
tiles gap.png 64x36 1 16 3 5 f.0001.png f.0002.png - . .
ls ./*.tmp .*.tmp 2>/dev/null && fault "temporary files are left"

# What is refused, before anything is rendered.
expect 2 render shot.scene --frames 1-2 -o no.####.exr --contact-sheet sheet.jpg
tells err E0432 sheet.jpg
expect 3 render shot.scene --frames 1-2 -o no.####.exr --contact-sheet nowhere/sheet.png
tells err E0430 nowhere
expect 3 render shot.scene --frames 1-2 -o no.####.exr --contact-sheet sheet.png --view None
expect 2 render shot.scene --contact-sheet sheet.png -o no.exr
says err "write \`--frames 1-24\`"
expect 2 render shot.scene --clip clip.mp4 -o no.exr
expect 2 render shot.scene --fps 25 -o no.exr
expect 2 render shot.scene --frames 1-2 --part 1/2 -o no.exr --clip clip.mp4
says err "--part makes no pictures of frames"
expect 1 farm submit shot.scene --frames 1-2 -o no.####.exr --contact-sheet sheet.png --print
says err "--contact-sheet"
for rate in 0 -1 x 1/0 24/ ''; do expect 2 render shot.scene --frames 1 --fps "$rate" -o no.exr; done
mkdir bin
ln -s "$(command -v timeout)" "$(command -v sed)" bin/
PATH=$PWD/bin expect 3 render shot.scene --frames 1-2 -o no.####.exr --clip clip.mp4 # no ffmpeg
tells err E0434 "not on the PATH"
says err "apt install ffmpeg"
[[ -z $(ls no.* clip.mp4 2>/dev/null) ]] || fault "rendered all the same: $(ls no.* clip.mp4)"
# One that gives up in the middle ends no render.
printf '#!/bin/sh\ncase "$*" in *lavfi*) exit 0;; esac\necho "I have had enough" >&2\nexit 5\n' >bin/ffmpeg
chmod +x bin/ffmpeg
PATH=$PWD/bin expect 3 render shot.scene --frames 1-4 --size 640x400 --samples 1 -o e.####.exr --clip clip.mp4
tells err W0671 "ffmpeg ended with 5: I have had enough"
[[ -s e.0004.exr && ! -e clip.mp4 ]] || fault "frames in spite of ffmpeg: $(ls e.* clip.mp4 2>&1)"
[[ $(grep -c 'warning\[W0671' err) -eq 1 ]] || fault "W0671 is not told once"
printf '#!/bin/sh\necho "Unknown encoder" >&2\nexit 1\n' >bin/ffmpeg
PATH=$PWD/bin expect 3 render shot.scene --frames 1-2 -o no.####.exr --clip clip.mp4
tells err E0434 "Unknown encoder"

command -v ffprobe >/dev/null || { echo "no ffmpeg: clips are not looked at"; finish; }
probe() { # FILE: width, height, rate and number of frames
    ffprobe -v error -count_frames -select_streams v -show_entries stream=width,height,r_frame_rate,nb_read_frames -of csv=p=0 "$1"
}
expect 2 render shot.scene --frames 1-2 -o no.####.exr --clip clip.gif
tells err E0434 clip.gif
expect 0 render shot.scene --frames 1-5 --size 64x36 --fps 12 -o c.####.exr --clip clip.mp4
says err "clip clip.mp4: 5 of 5 frames"
[[ $(probe clip.mp4) == 64,36,12/1,5 ]] || fault "the clip: $(probe clip.mp4)"
expect 0 info c.0003.exr
says out "abbe.fps = 12"
says out "abbe.time = 0.25"
ffmpeg -v error -i clip.mp4 -f rawvideo -pix_fmt rgb24 -y frames.raw
"$node" "$look" frames.raw 64x36 c.000{1..5}.png || fault "frames of the clip"
# The scene's own rate, odd sizes, names that a shell would stumble over, and frames that are there.
name='a $(touch pwned);b "c".mov'
expect 0 render shot.scene --frames 1-3 --size 33x21 -o odd.####.exr -q --clip "$name"
[[ $(probe "$name") == 34,22,10/1,3 ]] || fault "the clip of odd size: $(probe "$name")"
[[ ! -e pwned ]] || fault "a shell has seen the name"
expect 0 render shot.scene --frames 1-3 --size 33x21 -o odd.####.exr -q --resume --clip again.mkv --contact-sheet both.png
[[ $(probe again.mkv) == 34,22,10/1,3 ]] || fault "the clip of frames that were there: $(probe again.mkv)"
[[ -s both.png ]] || fault "no sheet beside the clip"
expect 3 render shot.scene --frames 1-5 --size 64x36 -o f.####.exr --clip gap.mp4
says err "clip gap.mp4: 2 of 5 frames; a gap in the place of frame 3"
[[ $(probe gap.mp4) == 64,36,10/1,3 ]] || fault "the clip with a gap: $(probe gap.mp4)"
finish
