#!/usr/bin/env bash
# The time left, of real renders: from a tenth of the run on, what is predicted as the whole is within 20 % of what it
# comes to. Work is told in core seconds, so that other programs on the machine do not matter; what the clock makes of it
# is tested by simulation (tests/unit/rendering/time_left_test.cpp).
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/../../../scenes/glass-caustic/glass-caustic.scene

# predicted_well NAME: of the events of a render, core seconds over the fraction done against those at the end. The median
# of the errors counts: the events are many.
predicted_well() {
    local median
    median=$(sed -n 's/.*"event":"progress".*/&/p' events | sed -E 's/.*"done":([0-9.e+-]+).*"core_s":([0-9.e+-]+).*/\1 \2/' |
        awk '{ done[NR] = $1; core[NR] = $2 }
            END { for (i = 1; i < NR; ++i) if (core[i] >= 0.1 * core[NR] && done[i] > 0) {
                      error = core[i] / done[i] / core[NR] - 1
                      printf "%.4f\n", error < 0 ? -error : error } }' |
        sort -g | awk '{ v[NR] = $1 } END { print NR < 5 ? "few" : v[int((NR + 1) / 2)] }')
    printf '%s: median error of the total %s\n' "$1" "$median"
    awk -v m="$median" 'BEGIN { exit !(m != "few" && m < 0.2) }' || fault "$1: predicted with a median error of $median"
}

run() { # NAME OPTION…
    local name=$1
    shift
    timeout 300 "$program" "$scene" -o left.exr --checkpoint off --json "$@" >events 2>err || fault "$name: $(cat err)"
    predicted_well "$name"
}

run samples --size 96x96 --samples 700
run "samples, adaptive" --size 96x96 --samples 700 --adaptive on
# Below the ball of glass the first samples know too little of the noise: by half of the way to 1.8 % the time is a third too short.
scene=$scenes/../../../scenes/cornell-box/cornell-box.scene
run noise --size 96x96 --samples 100000 --noise 2%
scene=$scenes/../../../scenes/glass-caustic/glass-caustic.scene

# A time is a matter of the clock alone, and eta_s says what is left of it.
timeout 300 "$program" "$scene" --size 96x96 --samples 4000000000 --time 5s -o left.exr --checkpoint off --json >events 2>err
sed -n 's/.*"event":"progress".*"elapsed_s":\([0-9.e+-]*\).*"eta_s":\([0-9.]*\)}.*/\1 \2/p' events >told
[[ $(wc -l <told) -ge 3 ]] || fault "no time left is told"
awk 'NR > 1 && $2 > 0 && ($1 + $2 < 4 || $1 + $2 > 6) { exit 1 }' told || fault "time goal: $(cat told)"

finish
