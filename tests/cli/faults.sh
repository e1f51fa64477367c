#!/usr/bin/env bash
# Every call that opens, writes, flushes, closes or renames a file and every text that is written fails in turn, or the
# disk is full from then on, or the process is killed in the middle of it: nothing that was finished is ever lost.
#   faults.sh PROGRAM JSON_LINES FAULT_LAYER       with ABBE_NIGHTLY set all kinds of faults at each call
layer=$(realpath -- "$3") # before the tests go elsewhere
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/room.scene
small=("$scene" --size 12x8 -t 1)
log=$folder/calls
elsewhere=$folder/elsewhere
mkdir elsewhere

# faulted KIND N ARGUMENT…: the program with a fault at its N-th call; its end is left in `code`.
faulted() {
    local kind=$1 at=$2
    shift 2
    : >"$log"
    rm -rf "${elsewhere:?}"/*
    (LD_PRELOAD='' timeout 60 env LD_PRELOAD="$layer" FAULT_FOLDER="$PWD/work" FAULT_LOG="$log" FAULT_KIND="$kind" \
        FAULT_AT="$at" TMPDIR="$elsewhere" "$program" "$@" >out 2>err
    exit $?) 2>/dev/null # nor does the shell tell that it was killed
    code=$?
    cat out >>err # with --json errors go there
}

killed() { [[ $code -eq 137 ]]; }
new() { [[ $(pixels "$1") == "$wanted" ]]; }
# What was there before the program started is there, or what it was to make, whole.
old_or_new() { cmp -s "base/$1" "work/$1" || new "work/$1" || fault "$where: $1 is neither the older nor the new one"; }

# sweep NAME KIND CHECK ARGUMENT…: at every call in turn, each time from the files in base.
sweep() {
    local name=$1 kind=$2 check=$3 n
    shift 3
    for ((n = 1; n < 1000; ++n)); do
        rm -rf work && cp -a base work
        faulted "$kind" "$n" "$@"
        where="$name, $kind at $(grep -F '*' "$log")"
        if ! killed; then
            [[ $code -eq 0 || $code -eq 3 ]] || fault "$where: ended with $code: $(cat err)"
            [[ $kind == short && $code -ne 0 ]] && fault "$where: ended with $code"
            [[ $code -eq 0 || -s err ]] || fault "$where: nothing was said"
            [[ -z $(find work -name '*.tmp') ]] || fault "$where: temporary files are left"
        fi
        grep -q '\*' "$log" || break
        [[ $kind != full ]] && grep -q '\* write (std' "$log" && ! killed && [[ $code -ne 0 ]] && fault "$where: lost text ended it with $code"
        $check
    done
    printf '%-10s %-6s %d calls\n' "$name" "$kind" $((n - 1))
    ((n > 5 && n < 1000)) || fault "$name: $n calls"
}
kinds() { # those of a quick run, and all others
    if [[ -n ${ABBE_NIGHTLY:-} ]]; then printf '%s\n' fail tear full short; else printf '%s\n' "$@"; fi
}

# What is named in the message as saved elsewhere is there, and private.
saved_elsewhere() { # WHAT
    local path
    path=$(sed -n "s/.*the $1 was saved as \`\\([^\`]*\\)\`.*/\\1/p" err)
    [[ -n $path ]] && [[ $(stat -c %a "$(dirname "$path")") == 700 ]] && printf '%s' "$path"
}

# --- A render over an older image.
mkdir base
expect 0 "${small[@]}" --samples 2 --seed 3 -q -o base/o.exr --checkpoint off
expect 0 "${small[@]}" --samples 2 -q -o whole.exr
wanted=$(pixels whole.exr)
check_render() {
    old_or_new o.exr
    killed && return
    if [[ $code -eq 0 ]]; then
        new work/o.exr || fault "$where: ended well without its image"
    elif ! grep -q E0430 err && ! new work/o.exr; then # what was rendered has to be somewhere
        new "$(saved_elsewhere image)" || fault "$where: the image is lost: $(cat err)"
    fi
}
for kind in $(kinds fail tear); do sweep render "$kind" check_render "${small[@]}" --samples 2 -o work/o.exr; done
sweep json fail check_render "${small[@]}" --samples 2 -o work/o.exr --json --checkpoint off --png off

# --- A part, which is all that there is of what it took.
wanted=$(pixels whole.exr)
rm -rf base && mkdir base
check_part() {
    local part=work/o.part1.abbe
    killed && { [[ ! -e $part ]] || "$program" merge $part -o part.exr --png off >/dev/null 2>&1 || fault "$where: half a part"; return; }
    grep -q E0430 err && return
    [[ $code -eq 0 ]] || part=$(saved_elsewhere part)
    rm -f part.exr
    "$program" merge "$part" -o part.exr --png off >/dev/null 2>&1
    new part.exr || fault "$where: the part is lost: $(cat err)"
}
for kind in $(kinds full); do sweep part "$kind" check_part "${small[@]}" --samples 2 -o work/o.exr --part 1/1; done

# --- Going on from a checkpoint, which stays good for that whatever happens.
rm -rf base && mkdir base
expect 0 "${small[@]}" --samples 4 -q -o whole.exr
wanted=$(pixels whole.exr)
more=("${small[@]}" --samples 4 --resume -o work/o.exr --checkpoint keep --png off)
expect 0 "${small[@]}" --samples 2 -q -o base/o.exr --checkpoint keep
check_resume() {
    old_or_new o.exr
    rm -f work/o.exr
    "$program" "${more[@]}" >again 2>&1 || fault "$where: cannot be continued: $(cat again)"
    grep -q W0664 again && fault "$where: the checkpoint is lost"
    new work/o.exr || fault "$where: continued to another image"
}
for kind in $(kinds fail tear); do sweep resume "$kind" check_resume "${more[@]}"; done

# --- Putting parts together, and making a PNG.
rm -rf base && mkdir base
for part in 1 2; do expect 0 "${small[@]}" --samples 4 -q -o base/o.exr --part $part/2; done
expect 0 "${small[@]}" --samples 2 --seed 3 -q -o base/o.exr
expect 0 convert base/o.exr base/o.png
check_merge() {
    for part in 1 2; do cmp -s base/o.part$part.abbe work/o.part$part.abbe || fault "$where: part $part was changed"; done
    old_or_new o.exr
    killed || [[ $code -ne 0 ]] || new work/o.exr || fault "$where: ended well without its image"
}
for kind in $(kinds fail); do sweep merge "$kind" check_merge merge work/o.part{1,2}.abbe -o work/o.exr; done
expect 0 convert whole.exr new.png
check_convert() {
    cmp -s work/o.png base/o.png || cmp -s work/o.png new.png || fault "$where: half a PNG"
    killed || [[ $code -ne 0 ]] || cmp -s work/o.png new.png || fault "$where: ended well without its PNG"
}
for kind in $(kinds fail tear); do sweep convert "$kind" check_convert convert whole.exr work/o.png; done

# --- What a killed render leaves is private, and goes with the next one.
rm -rf work && cp -a base work
faulted none 0 "${small[@]}" --samples 2 -o work/o.exr
at=$(grep -m 1 'write .*o.exr.abbe-' "$log")
faulted tear "${at%% *}" "${small[@]}" --samples 2 -o work/o.exr
left=$(find work -name 'o.exr.abbe-*.tmp')
killed && [[ $(stat -c %a "$left") == 600 ]] || fault "killed while writing, it left $(ls -l work)"
expect 0 "${small[@]}" --samples 2 -q -o work/o.exr
[[ -z $(find work -name '*.tmp') ]] || fault "what a killed render left stays: $(ls work)"

# --- What is rescued when the disk is full is private, and replaces and follows nothing.
echo precious >precious
rm -rf work && mkdir work
mkdir shared && cp precious shared/o.exr && ln -s "$folder/precious" shared/o.exr.tmp
faulted none 0 "${small[@]}" --samples 2 -o work/o.exr --checkpoint off
at=$(grep -m 1 'write o.exr.abbe-' "$log")
(LD_PRELOAD='' env LD_PRELOAD="$layer" FAULT_FOLDER="$PWD/work" FAULT_LOG="$log" FAULT_KIND=full FAULT_AT="${at%% *}" \
    TMPDIR="$PWD/shared" "$program" "${small[@]}" --samples 2 -o work/o.exr --checkpoint off >out 2>err)
says err "No space left on device"
expect 0 info "$(saved_elsewhere image)"
cmp -s precious shared/o.exr || fault "a file in the folder of temporary files was replaced"
cmp -s precious "$folder/precious" && [[ -L shared/o.exr.tmp ]] || fault "a link in that folder was followed"

finish
