#!/usr/bin/env bash
# A shot on a cluster: the real Slurm, with four nodes on this machine. The same bits as one render on one thread,
# whatever happens to workers and nodes. Needs root.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
# shellcheck source=tests/support/slurm.sh
source "$scenes/../../support/slurm.sh"
[[ $EUID -eq 0 ]] || { echo "Debian's Slurm is started as root"; exit 1; }
trap 'stop_slurm "$folder/cluster"; sleep 0.3; rm -rf "$folder"' EXIT
mkdir cluster
start_slurm "$folder/cluster" || { cat cluster/log/*; fault "Slurm does not start"; exit 1; }
scene=$scenes/room.scene
small=(--size 24x16 --seed 3)

watch_shot() { # SHOT: until it is over
    timeout 200 "$program" farm watch "$1.farm" --every 0.3s >out 2>err || fault "$1: $(tail -n 2 out) $(cat err)"
}
same() { # SHOT WHOLE WHAT
    [[ -e $1.exr && $(pixels "$1.exr") == "$(pixels "$2")" ]] || fault "$3: other pixels than one render's"
}
job_of() { sed -n '/"jobs"/,/]/s/ *"\([0-9]*\)".*/\1/p' "$1.farm/plan.json" | head -n 1; }
queue_is_empty() { [[ -z $(squeue --noheader) ]]; }
wait_for() { # COMMAND…: at most half a minute
    local i
    for ((i = 0; i < 300; i++)); do
        "$@" && return 0
        sleep 0.1
    done
    fault "waited in vain: $*"
}

# Four frames of four parts, with everything of a frame: motion, its parameter, its seed.
animated=("$scenes/shot.scene" "${small[@]:0:2}" --samples 64)
expect 0 render "${animated[@]}" --frames 1-7x2 -t 1 -q -o whole.####.exr
expect 0 farm submit "${animated[@]}" --frames 1-7x2 --parts 4 -o shot.####.exr
says err "farm watch"
watch_shot shot
for n in 1 3 5 7; do
    [[ -e shot.000$n.exr && $(pixels shot.000$n.exr) == "$(pixels whole.000$n.exr)" ]] ||
        fault "frame $n: other pixels than one render's"
done
[[ $(pixels shot.0001.exr) != "$(pixels shot.0003.exr)" ]] || fault "two frames are alike"

# Four long parts, all at once: one is killed, one is sent away by the scheduler, one loses its node, one is cancelled.
expect 0 "$scene" "${small[@]}" --samples 24000 -q -o long.exr
expect 0 farm submit "$scene" "${small[@]}" --samples 24000 --parts 4 --checkpoint 0.3s -o long_shot.exr
job=$(job_of long_shot)
for k in 1 2 3 4; do wait_for test -s "long_shot.farm/parts/r1.part$k.abbe"; done
pkill -STOP -f "farm work $PWD/long_shot.farm 1 part" # so that they are in the middle, however fast the machine is
expect 0 farm picture long_shot.farm -o look.exr
pkill -KILL -f "farm work $PWD/long_shot.farm 1 part 1 " || fault "no worker to kill"
scontrol requeue "${job}_2"
node=$(squeue --noheader --format=%N --job="${job}_3")
scontrol update "NodeName=$node" State=DOWN Reason=test
scancel "${job}_4"
pkill -CONT -f "farm work $PWD/long_shot.farm 1 part"
sleep 2
scontrol update "NodeName=$node" State=RESUME
watch_shot long_shot
same long_shot long.exr "after kill, requeue, node down and scancel"
"$program" farm status long_shot.farm --json >out
requeued=$(sed -n 's/.*"requeued": \([0-9]*\).*/\1/p' out)
[[ $requeued -ge 3 ]] || fault "only $requeued parts were taken up again"
[[ $(grep -c "" long_shot.farm/tasks/r1.p2.jsonl) -gt 2 ]] || fault "what was said before a requeue is lost"

# Cancelled as a whole, and taken up again.
expect 0 farm submit "$scene" "${small[@]}" --samples 24000 --parts 2 -o cancelled.exr
wait_for grep -qs '"progress"' cancelled.farm/tasks/r1.p1.jsonl
expect 0 farm cancel cancelled.farm
wait_for queue_is_empty
sleep 0.5
expect 0 farm status cancelled.farm
tells out cancelled
[[ ! -e cancelled.exr ]] || fault "an image of a cancelled shot"
expect 0 farm resume cancelled.farm
watch_shot cancelled
same cancelled long.exr "cancelled and taken up again"

# A part of another render is refused by name, and nothing is merged with it.
expect 0 "$scene" --size 24x16 --seed 4 --samples 64 --part 2/2 -q -o other.exr
for n in 1 2 3 4; do scontrol update "NodeName=n$n" State=DRAIN Reason=test; done
expect 0 farm submit "$scene" "${small[@]}" --samples 64 --parts 2 -o wrong.exr
expect 1 farm submit "$scene" "${small[@]}" --samples 64 --parts 2 -o wrong.exr
says err E0761
cp other.part2.abbe wrong.farm/parts/r1.part2.abbe
for n in 1 2 3 4; do scontrol update "NodeName=n$n" State=RESUME; done
timeout 100 "$program" farm watch wrong.farm --every 0.3s >out
[[ $? -eq 1 ]] || fault "a shot with a part of another render did not fail"
tells out failed r1.p2 E0663 seed
[[ ! -e wrong.exr ]] || fault "an image with a part of another render"

# A noise goal in rounds.
expect 0 farm submit "$scene" "${small[@]}" --noise 6% --parts 3 -o goal.exr
watch_shot goal
tells out "noise goal" met
"$program" farm status goal.farm --json >out
samples=$(sed -n 's/.*"samples_planned": \([0-9]*\).*/\1/p' out)
[[ $samples -gt 32 ]] || fault "the goal was met in one round"
expect 0 "$scene" "${small[@]}" --samples "$samples" --pilot 4 -q -o whole_goal.exr
same goal whole_goal.exr "rounds"

exit $faults
