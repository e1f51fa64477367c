#!/usr/bin/env bash
# An animation: frames by their list, files, moments, what goes on, what is told, and what is refused.
# shellcheck disable=SC2016 # names of parameters and messages
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

cp "$scenes/shot.scene" .
sed -e '/^param/d' -e 's/\$frame/7 deg/' -e 's/shutter/time 0.7 s; shutter/' -e 's/fps 10/seed 7/' shot.scene >still.scene
fast=(-q --png off)

# The same bits in any list, alone, and as a still of that moment.
expect 0 render shot.scene --frames 1-9x3,2 -o a.####.exr "${fast[@]}"
for n in 1 2 4 7; do [[ -s a.000$n.exr ]] || fault "no a.000$n.exr"; done
[[ $(ls a.*.exr) == $'a.0001.exr\na.0002.exr\na.0004.exr\na.0007.exr' ]] || fault "files: $(ls a.*)"
expect 0 render shot.scene --frames 7 -o b.exr "${fast[@]}" -t 1
same_pixels a.0007.exr b.0007.exr
expect 0 render still.scene -o still.exr "${fast[@]}"
same_pixels a.0007.exr still.exr
[[ $(pixels a.0001.exr) != $(pixels a.0002.exr) ]] || fault "two frames are alike"
expect 0 info a.0007.exr
says out "abbe.frame = 7"
says out "abbe.fps = 10"
says out "abbe.time = 0.7"
says out "abbe.seed = 7"
expect 0 render shot.scene --frames=-3--2 --seed 5 -o n.##.exr "${fast[@]}"
expect 0 info n.-03.exr
says out "abbe.seed = 5"
says out "abbe.frame = -3"
expect 0 render shot.scene --frames 4 -o c.exr --png=look.png -q
[[ -s look.0004.png && ! -e look.png ]] || fault "the PNG of a frame: $(ls look*)"

# Other commands look at a frame.
expect 0 info shot.scene --frame 7
expect 0 check shot.scene --frame 7 --json
expect 0 replay a.0007.exr --pixel 3,4 --sample 0:1
cp out of_image
expect 0 replay shot.scene --frame 7 --pixel 3,4 --sample 0:1
cmp -s out of_image || fault "a sample of a frame is repeated differently"
expect 0 render shot.scene --frames 7 --pixel 3,4

# Going on: what is there stays, what is missing, partial or of another render is made.
expect 0 render shot.scene --frames 1-4 -o r.####.exr "${fast[@]}"
before=$(stat -c %y r.0001.exr r.0004.exr)
rm r.0002.exr
cp a.0004.exr r.0003.exr # of another frame
expect 0 render shot.scene --frames 1-4 -o r.####.exr --png off --resume
says err "2 of 4 frames rendered, 2 were there"
says err "frame 1 of 4: number 1 is in r.0001.exr"
says_not err W0664
[[ $(stat -c %y r.0001.exr r.0004.exr) == "$before" ]] || fault "frames that were there were rendered again"
same_pixels r.0002.exr a.0002.exr
[[ $(pixels r.0003.exr) != $(pixels a.0004.exr) ]] || fault "a frame that is another one was kept"
expect 0 render shot.scene --frames 1-4 -o r.####.exr --png off --resume --samples 8
says err "4 of 4 frames rendered, 0 were there"
sed -i 's/radius 0.5/radius 0.6/' shot.scene
expect 0 render shot.scene --frames 1-2 -o r.####.exr --png off --resume --samples 8
says err "2 of 2 frames rendered, 0 were there"
sed -i 's/radius 0.6/radius 0.5/' shot.scene

# In the middle of a frame.
expect 0 render shot.scene --frames 1-3 --samples 10000 -o whole.####.exr "${fast[@]}"
"$program" render shot.scene --frames 1-3 --samples 10000 -o cut.####.exr "${fast[@]}" --json >events 2>err &
job=$!
for _ in {1..600}; do
    grep '"progress"' events | grep -q '"frame":2' && break
    sleep 0.05
done
kill -INT $job
wait $job
code=$?
[[ $code -eq 130 ]] || fault "ended with $code instead of 130"
failed=$(sed -n 's/.*"failed":\([0-9]*\).*/\1/p' events) # 2; 3 on a machine that is faster than this loop
[[ -s cut.0001.exr ]] || fault "frame 1 is not done"
tells events '"event":"frames"' '"exit":130' "\"rendered\":$((failed - 1))"
[[ ! -e cut.000$((failed + 1)).exr ]] || fault "a frame after the interrupted one"
expect 0 render shot.scene --frames 1-3 --samples 10000 -o cut.####.exr --png off --resume
says err "$((4 - failed)) of 3 frames rendered, $((failed - 1)) were there"
for n in 1 2 3; do same_pixels whole.000$n.exr cut.000$n.exr; done
[[ -z $(ls ./*.ckpt 2>/dev/null) ]] || fault "checkpoints stay: $(ls ./*.ckpt)"

# Parts of a frame.
for part in 1 2; do expect 0 render shot.scene --frames 6-7 --part $part/2 -o p.exr -q; done
expect 0 merge p.0007.part1.abbe p.0007.part2.abbe -o merged.exr --png off
same_pixels merged.exr a.0007.exr
same_certificate merged.exr a.0007.exr
expect 0 render shot.scene --frames 6-7 --part 2/2 -o p.exr -q --resume # done already
expect 0 merge p.0007.part1.abbe p.0007.part2.abbe -o merged.exr --png off
same_pixels merged.exr a.0007.exr
expect 1 merge p.0007.part1.abbe p.0006.part2.abbe -o no.exr
tells err E0663 'frame: `6` in the part, `7` in the scene'
expect 0 render shot.scene --frames 6-7 --part 1/2 -o plain -q
[[ -s plain.0006.part1.abbe && -s plain.0007.part1.abbe ]] || fault "parts without an extension: $(ls plain*)"

# What is told.
expect 0 render shot.scene --frames 5-6 -o t.exr --png off --json
[[ $(grep -c '"frame":5' out) -gt 3 ]] || fault "events without their frame"
tells out '"event":"start"' '"frame_position":2' '"frame_count":2' '"frame":6' '"frame_time_s":0.6'
tells out '"event":"frames"' '"done":"5-6"' '"rendered":2' '"exit":0' '"failed":null'
"$json_lines" <out >/dev/null || fault "events are no JSON"
expect 0 render shot.scene --frames 5-6 -o t.exr --png off
says err "frame 2 of 2: number 6, at 0.6 s"
sed -e '/^param/d' -e 's/\$frame/7 deg/' -e 's/at 0 s { \(.*\) }; at 1 s .*$/\1 } }/' -e 's/2 stops/auto/' shot.scene >dull.scene
expect 0 render dull.scene --frames 1-2 -o d.exr --png off
says err W0698
[[ $(grep -cF 'warning[W0699]' err) -eq 1 ]] || fault "W0699 is not told once"
expect 0 render dull.scene --frames 1 -o d.exr --png off
says_not err W069
sed 's/rotate y \$frame/rotate y 1 deg/; s/at 0 s { \(.*\) }; at 1 s .*$/\1 } }/' shot.scene >unused.scene
expect 0 render unused.scene --frames 1-2 -o d.exr --png off
says err W0698
[[ $(grep -cF 'warning[W0205]' err) -eq 1 ]] || fault "a warning of the scene is told with each frame"

# What frames take over from each other does not show: the camera moves, something turns, the rest stands still.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >corner.obj
cat >kept.scene <<'END'
scene 1
film { size 24 24 }
render { samples 4; fps 10 }
camera { look-at 0 0.5 0; exposure 2 stops; at 0 s { from 0 1 4 }; at 1 s { from 0 1 4 }; at 2 s { from 1 1 4 } }
light daylight { elevation 40 deg; azimuth 20 deg }
light quad { size 1 1; luminance 5000 nits; transform { rotate x 90 deg; translate 0 3 0 } }
material clay diffuse { reflectance 0.4 }
shape plane { material clay }
shape mesh "corner.obj" { material clay }
shape subdivision { points { - -1 0 0; - -1 1 0; - -2 1 0; - -2 0 0 }; faces { - 0 1 2 3 }; dicing 2 px; material clay }
object thing { shape sphere { radius 0.2 }; shape mesh "corner.obj" }
instance thing { transform { translate 1 0 1 } }
instance thing { transform { at 0 s { rotate y 0 deg }; at 1 s { rotate y 90 deg } } }
volume noise { size 1 1 1; extinction 2 per-m; scale 0.3 }
END
expect 0 render kept.scene --frames 1-3,12-14 -o kept.####.exr "${fast[@]}"
for n in 1 2 3 12 13 14; do
    expect 0 render kept.scene --frames $n -o alone.exr "${fast[@]}"
    same_pixels "$(printf 'kept.%04d.exr' $n)" "$(printf 'alone.%04d.exr' $n)"
done

# A frame that fails ends all.
mkdir f.0003.exr
expect 3 render shot.scene --frames 1-5 -o f.####.exr --png off
says err "frame 3 ended the animation; frames that are done: 1-2"
[[ ! -e f.0004.exr ]] || fault "a frame after the one that failed"

# What is refused.
for list in 1- 10-1 1-1000000000 1,,2 1-9x0 all ''; do expect 2 render shot.scene --frames "$list" -o x.exr; done
expect 2 render shot.scene --frames 10-1 -o x.exr
says err "write \`1-10\`"
expect 2 render shot.scene --frames 1-2 -o x.##.##.exr
says err "x.##.__.exr"
sed 's/film {/film { output "y.#.#.exr";/' shot.scene >twice.scene
expect 2 render twice.scene --frames 1-2
says err E0433
expect 2 render shot.scene --frames 1-2 --pixel 3,4
says err "\`--frames 1\`"
expect 2 render shot.scene --frames 1-2 -D "frame=3 deg" -o x.exr
says err "leave one of them out"
[[ -z $(ls x.* 2>/dev/null) ]] || fault "written all the same: $(ls x.*)"
finish
