#!/usr/bin/env bash
# Many changed files for every fuzz target, with the corpus as a beginning:  long.sh FOLDER [RUNS [TARGET…]]
# FOLDER holds the programs (build/fuzz/tests); what they find stays there.
set -uo pipefail
corpus=$(cd "$(dirname -- "$0")/corpus" && pwd)
folder=$(realpath -- "$1")
runs=${2:-1000000}
shift $(($# < 2 ? $# : 2))
targets=("$@")
((${#targets[@]})) || mapfile -t targets < <(ls "$corpus" | sed 's/^vdb$/vdb_fork/' && echo layout)
declare -A shared=([vdb_fork]=vdb [layout]=scene) # targets that begin with the files of another one
# Each input of vdb starts a process, and scene_export makes three scenes: a million would take 36, 7 and 15 hours.
declare -A most=([vdb]=20000 [vdb_fork]=100000 [scene_export]=20000)
# What was freed and is kept to find its use counts as memory of the input: less of it.
export ASAN_OPTIONS=new_delete_type_mismatch=0:quarantine_size_mb=64
faults=0
for target in "${targets[@]}"; do
    started=$SECONDS
    memory=512
    [[ $target == vdb* ]] && memory=4096 # grids as they are in memory
    count=$runs
    options=$ASAN_OPTIONS
    [[ $target == vdb_fork ]] && options+=:max_allocation_size_mb=2048 # as CMakeLists.txt explains
    [[ -v most[$target] ]] && ((count > most[$target])) && count=${most[$target]}
    ASAN_OPTIONS=$options "$folder/fuzz_$target" -runs="$count" -memory=$memory -findings="$folder" "$corpus/${shared[$target]:-$target}" || {
        echo "FAULT: fuzz_$target"
        faults=$((faults + 1))
    }
    echo "    $((SECONDS - started)) s"
done
exit $((faults > 0))
