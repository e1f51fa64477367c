#!/usr/bin/env bash
# A study of a small scene: what it writes, that it survives kills with the same figures, and what it refuses.
#   study.sh PROGRAM JSON_LINES [STEP]       killed so many ms later each time: 100, or 10 with ABBE_NIGHTLY set
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
step=${3:-${ABBE_NIGHTLY:+10}}
step=${step:-100}
scene=$scenes/room.scene
small=(--size 24x16 --samples 32 --seeds 5)

# All but the times, in the order of the file.
figures() { grep -v '^#' "$1" | cut -d, -f1-5; }

expect 0 study "$scene" "${small[@]}" -o whole
says out "as rendered"
says err "study whole.html"
for file in whole.html whole.csv whole.json; do [[ -s $file ]] || fault "no $file"; done
[[ ! -e whole.state ]] || fault "a finished study leaves its state"
"$json_lines" --whole <whole.json >/dev/null || fault "whole.json is no JSON"
says whole.json '"format":"abbe-study/1"'
says whole.json '"id":"denoised"'
says whole.html 'abbe-study/1'
# Four rungs, 4 to 32 samples, five seeds of each.
[[ $(grep -c '^abbe,' whole.csv) -eq 20 ]] || fault "$(grep -c '^abbe,' whole.csv) lines of the main curve"
# What is left out has its reason.
says whole.json '"leftOut":[{"id":"light-tree"'

# Killed again and again, a little later each time, so that it comes to its end at last.
RANDOM=5
killed=0
late=0 # after the reference, when there are seeds to add to those that were measured
for ((run = 1; run < 200; ++run)); do
    "$program" study "$scene" "${small[@]}" -o killed --resume --quiet >out 2>err &
    job=$!
    ms=$((run * step + RANDOM % step))
    sleep "$((ms / 1000)).$(printf '%03d' $((ms % 1000)))"
    if kill -KILL $job 2>/dev/null; then
        killed=$((killed + 1))
        [[ -e killed.state/reference.abbe ]] && late=$((late + 1))
    else
        wait $job || fault "continuing after kills: $(cat err)"
        break
    fi
    wait $job 2>/dev/null
done
((late > 0)) || fault "never killed after the reference"
((killed > 0)) || fault "never killed"
printf '%d kills, %d of them after the reference, %d runs\n' "$killed" $late $run
# How many rungs other ways than the program's own get depends on their time; those that both studies have are the same.
rungs() { figures "$1" | cut -d, -f1,2 | sort -u; }
common() { figures "$1" | grep -Ff <(comm -12 <(rungs whole.csv) <(rungs killed.csv) | sed 's/$/,/'); }
[[ $(common whole.csv) == "$(common killed.csv)" ]] || {
    fault "figures differ after $killed kills"
    diff <(common whole.csv) <(common killed.csv)
}
[[ $(figures killed.csv | grep -c '^abbe,') -eq 20 ]] || fault "the main curve is not whole after kills"
# Biases need the images of all seeds. Those of the fewer rungs are all among those of the other.
biases() { grep -o '"bias2[A-Za-z]*":[^,}]*' "$1" | sort; }
[[ -n $(biases whole.json) && (-z $(comm -23 <(biases whole.json) <(biases killed.json)) ||
    -z $(comm -13 <(biases whole.json) <(biases killed.json))) ]] || fault "biases differ after kills"
[[ ! -e killed.state ]] || fault "the state stays after the end"

# Interrupted, and continued as something else.
"$program" study "$scene" --size 48x32 --samples 512 -o other --json >events 2>err &
job=$!
for _ in {1..300}; do
    [[ -e other.state/curve-abbe.abbe ]] && break
    sleep 0.05
done
kill -INT $job
ended_with 130
"$json_lines" event <events >keys || fault "the events are no JSON"
says keys '"start"'
expect 1 study "$scene" --size 48x32 --samples 256 -o other --resume
says err E0738
says err "rungs: "
expect 1 study "$scene" --size 32x32 --samples 512 -o other --resume
says err "size: "
expect 1 study "$scene" --size 48x32 --samples 512 --seed 9 -o other --resume
says err "seed: "
printf 'x' >>other.state/plan.abbe
expect 1 study "$scene" --size 48x32 --samples 512 -o other --resume
says err E0739

# Anew, warned.
expect 0 study "$scene" --size 16x16 --samples 16 --seeds 2 --variants none -o other
says err W0731
expect 0 study "$scene" --size 16x16 --samples 16 --seeds 2 --variants none -o fresh --resume
says err W0732
says_not fresh.csv random
# Little time: fewer seeds, or fewer samples, but a report.
expect 0 study "$scene" --size 16x16 --time 1 --seeds 1000 --variants random -o hasty --quiet
says hasty.json '"complete":false'
[[ -e hasty.state ]] || fault "no state to go on from"

expect 0 study "$scene" --variants list
says out no-nee
expect 2 study "$scene" --variants no-ne
says err '`no-nee`'
expect 2 study "$scene" --error 1,x
says err "0.3"
expect 2 study "$scene" --seeds 1
expect 1 study "$bad/nine_mistakes.scene"
says err nine_mistakes.scene:5
expect 3 study "$scene" -o nowhere/study
says err E0430

finish
