#!/usr/bin/env bash
# A shot in parts, run by processes of this machine: the same bits as one render, whatever is killed, cancelled or wrong.
# tests/cli/farm_slurm.sh does it with Slurm.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/room.scene
small=(--size 24x16 --seed 3)
submit=(farm submit "$scene" "${small[@]}" --engine local -t 1)

# One image of four parts, and of so many that they are gathered first.
expect 0 "$scene" "${small[@]}" --samples 64 -t 1 -q -o whole.exr
expect 0 "${submit[@]}" --samples 64 --parts 4 --at-once 2 -o four.exr
[[ $(pixels four.exr) == "$(pixels whole.exr)" ]] || fault "four parts have other pixels"
[[ -s four.png ]] || fault "no PNG of the merged image"
expect 0 "${submit[@]}" --samples 64 --parts 26 --at-once 2 -o many.exr
[[ $(pixels many.exr) == "$(pixels whole.exr)" ]] || fault "26 parts have other pixels"
[[ -s many.farm/parts/r1.g1.abbe ]] || fault "26 parts were not gathered"
expect 0 farm status four.farm
tells out "done:" 100
expect 0 farm status four.farm --json
[[ $("$json_lines" out 2>/dev/null | wc -l) -ge 0 ]] && says out '"state": "done"'

# A second shot does not go into the folder of the first.
expect 1 "${submit[@]}" --samples 8 --parts 2 -o four.exr
says err E0761
says err "farm resume"

# A noise goal in rounds: as many samples in one render have the same bits.
expect 0 "${submit[@]}" --noise 6% --parts 2 --at-once 2 -o goal.exr
tells err "noise goal" met
expect 0 farm status goal.farm --json
samples=$(sed -n 's/.*"samples_planned": \([0-9]*\).*/\1/p' out)
[[ $samples -gt 32 ]] || fault "the goal was met in one round of $samples samples: no test of rounds"
expect 0 "$scene" "${small[@]}" --samples "$samples" --pilot 4 -q -o whole_goal.exr
[[ $(pixels goal.exr) == "$(pixels whole_goal.exr)" ]] || fault "rounds have other pixels than one render"
# A goal that the most samples do not meet is no success.
expect 4 "${submit[@]}" --noise 0.5% --samples 64 --parts 2 --at-once 2 -o limit.exr
tells err 64 "most that they may have"
expect 4 farm status limit.farm

# Ctrl-C saves; `resume` goes on with what there is. What a part had is not rendered again: it was taken up.
"$program" "${submit[@]}" --samples 24000 --parts 2 --at-once 2 -o stopped.exr 2>err &
shot=$!
for ((i = 0; i < 300; i++)); do
    grep -qs '"progress"' stopped.farm/tasks/r1.p1.jsonl && break
    sleep 0.1
done
sleep 0.5
kill -INT $shot
wait $shot
[[ $? -eq 130 ]] || fault "Ctrl-C ended a shot with another code"
says err "farm resume"
[[ ! -e stopped.exr ]] || fault "an image of a shot that was stopped"
expect 0 farm picture stopped.farm -o sofar.exr
"$program" info sofar.exr | grep -q "abbe.partial = 1" || fault "a picture of what there is does not say that it is partial"
expect 0 farm resume stopped.farm
expect 0 "$scene" "${small[@]}" --samples 24000 -q -o long.exr
[[ $(pixels stopped.exr) == "$(pixels long.exr)" ]] || fault "a shot that was stopped has other pixels"
expect 0 farm status stopped.farm --json
grep -q '"requeued": [1-9]' out || fault "no part was taken up again"

# A task that is killed is tried again; what it had saved is kept.
"$program" "${submit[@]}" --samples 24000 --parts 2 --checkpoint 0.3s --at-once 2 -o killed.exr 2>err &
shot=$!
for ((i = 0; i < 300; i++)); do
    [[ -s killed.farm/parts/r1.part1.abbe ]] && break
    sleep 0.1
done
pkill -KILL -f "farm work $PWD/killed.farm 1 part 1" || fault "nothing to kill"
wait $shot || fault "a shot of which a task was killed failed: $(cat err)"
tells err "try 2"
[[ $(pixels killed.exr) == "$(pixels long.exr)" ]] || fault "a shot of which a task was killed has other pixels"

# A part of another scene, of another version, and a plan that is damaged: refused by name.
expect 0 "${submit[@]}" --samples 64 --parts 2 -o wrong.exr
expect 0 "$scene" --size 24x16 --seed 4 --samples 64 --part 2/2 -q -o other.exr
rm -f wrong.exr wrong.farm/tasks/r1.json wrong.farm/tasks/r1.p2.json
cp other.part2.abbe wrong.farm/parts/r1.part2.abbe
expect 1 farm resume wrong.farm
tells err r1.p2 E0663 seed
[[ ! -e wrong.exr ]] || fault "an image with a part of another render"
sed -i 's/"program": "abbe .*"/"program": "abbe 0.0.1"/' wrong.farm/plan.json
expect 1 farm status wrong.farm
tells err E0762 0.0.1
echo '{"format": 1' >wrong.farm/plan.json
expect 1 farm status wrong.farm
says err E0762
expect 1 farm status nothing.farm
says err E0761

# What a divided render cannot do, and a scene that does not render.
expect 1 "${submit[@]}" --time 3s -o no.exr
tells err E0764 --time
expect 1 farm submit "$bad/nine_mistakes.scene" --engine local -o no.exr
[[ ! -e no.farm ]] || fault "a folder of a shot that was not planned"

# Scripts for reading.
expect 0 farm submit "$scene" "${small[@]}" --samples 64 --parts 4 -t 2 --sbatch=--partition=night --print -o printed.exr
tells out r1.parts.sh
says printed.farm/slurm/r1.parts.sh "#SBATCH --array=1-4"
says printed.farm/slurm/r1.parts.sh "#SBATCH --partition=night"
bash -n printed.farm/slurm/r1.parts.sh || fault "a script that is none"

exit $faults
