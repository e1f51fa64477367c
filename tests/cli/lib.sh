# shellcheck shell=bash
# Shared by the tests of the command line. A test is called as  TEST.sh PROGRAM JSON_LINES  and runs in an empty folder
# of its own; it goes on after a fault and ends with the number of faults.
# Requires: $0 is the test's own path.
# shellcheck disable=SC2034 # the variables are for the tests
set -uo pipefail
program=$(realpath -- "$1")
json_lines=$(realpath -- "$2")
scenes=$(cd "$(dirname -- "$0")/scenes" && pwd)
bad=$(cd "$(dirname -- "$0")/../language/bad" && pwd)
[[ -x $program ]] || { echo "$program is no program"; exit 1; }
folder=$(mktemp -d)
# A background job that is signalled before its program has begun is still this shell, and runs the trap, too.
trap '[[ $BASHPID != "$$" ]] || rm -rf "$folder"' EXIT
cd "$folder" || exit 1
faults=0
unset NO_COLOR
# Sanitizers make programs several times slower and larger.
sanitized() { grep -q -e asan -e tsan <<<"$program"; }
patience=300 # seconds
! sanitized || patience=2400
at_most() { sanitized || ulimit -v "$1"; } # KiB of memory in this shell; sanitizers reserve terabytes

fault() {
    printf 'FAULT: %s\n' "$*"
    faults=$((faults + 1))
}

# expect CODE ARGUMENT…: runs the program; output is left in files out and err.
expect() {
    local wanted=$1 code
    shift
    timeout "$patience" "$program" "$@" >out 2>err
    code=$?
    [[ $code -eq $wanted ]] && return 0
    fault "abbe $* ended with $code instead of $wanted"
    sed 's/^/    /' out err
    return 1
}

says() { # FILE TEXT
    grep -qF -e "$2" "$1" || { fault "no \`$2\` in:"; sed 's/^/    /' "$1"; }
}

# A line of the file has all of these, in any order: codes, names and figures. The words between them are free.
tells() { # FILE FACT…
    local file=$1 fact lines
    lines=$(<"$file")
    shift
    for fact in "$@"; do lines=$(grep -F -e "$fact" <<<"$lines"); done
    [[ -n $lines ]] || { fault "no line with \`$*\` in:"; sed 's/^/    /' "$file"; }
}

says_not() { # FILE TEXT
    ! grep -qF -e "$2" "$1" || { fault "\`$2\` in:"; sed 's/^/    /' "$1"; }
}

is_empty() { # FILE
    [[ ! -s $1 ]] || { fault "$1 should be empty:"; sed 's/^/    /' "$1"; }
}

# The fingerprint of all channels of an image.
pixels() { "$program" info "$1" | sed -n 's/^pixels *//p'; }

# What an image says about its error.
stated() { "$program" info "$1" | grep -E '^abbe\.(error|samples(Fewest|Mean|Most))'; }

same_certificate() { # A B
    [[ -n $(stated "$1") && $(stated "$1") == "$(stated "$2")" ]] || fault "the certificates of $1 and $2 differ"
}

same_pixels() { # A B
    local a b
    a=$(pixels "$1")
    b=$(pixels "$2")
    [[ -n $a && $a == "$b" ]] || fault "$1 and $2 differ: $a, $b"
}

# start OUTPUT SCENE ARGUMENT…: renders for ever in the background as $job, and returns when samples are being taken.
start() {
    local output=$1
    shift
    : >events # not those of the last one
    "$program" "$@" --samples 4000000000 -o "$output" --json >events 2>err &
    job=$!
    for _ in {1..300}; do
        grep -q '"progress"' events && return
        kill -0 "$job" 2>/dev/null || break
        sleep 0.1
    done
    fault "rendering did not begin"
}

ended_with() { # CODE
    local code
    for _ in {1..300}; do
        kill -0 "$job" 2>/dev/null || break
        sleep 0.1
    done
    kill -KILL "$job" 2>/dev/null # after half a minute
    wait "$job"
    code=$?
    [[ $code -eq $1 ]] || fault "ended with $code instead of $1"
}

# same_for_threads_and_kernels SCENE IMAGE: renders the image, with the same bits for any threads and the largest kernel.
same_for_threads_and_kernels() {
    local scene=$1 image=$2 threads
    expect 0 "$scene" -q -o "$image" -t 1
    for threads in 2 8; do
        expect 0 "$scene" -q -o threads.exr -t $threads
        same_pixels "$image" threads.exr
        same_certificate "$image" threads.exr
    done
    expect 0 "$scene" -q -o all.exr --kernel all
    same_pixels "$image" all.exr
}

# survives_kills KILLS SCENE OPTION…: a render that is killed at any moment, KILLS times or as often as it can be, goes on
# to the bits of one that was not.
survives_kills() {
    local kills=$1 scene=$2 killed=0 run
    shift 2
    RANDOM=7
    local long=("$@")
    expect 0 "$scene" "${long[@]}" --quiet -o long.exr --checkpoint off
    for ((run = 0; run < 500; ++run)); do
        rm -f killed.exr
        "$program" "$scene" "${long[@]}" --quiet -o killed.exr --checkpoint 10ms --resume >out 2>err &
        job=$!
        if ((killed < kills)); then
            # After a checkpoint of this run, or a moment later.
            for _ in {1..200}; do
                [[ killed.exr.ckpt -nt out ]] && break
                kill -0 $job 2>/dev/null || break
                sleep 0.01
            done
            sleep "0.0$((RANDOM % 10))"
            kill -KILL $job 2>/dev/null && killed=$((killed + 1))
            wait $job 2>/dev/null
            [[ -e killed.exr ]] && break
        else
            wait $job || fault "continuing after kills: $(cat err)"
            break
        fi
    done
    ((killed > 0)) || fault "never killed"
    same_pixels long.exr killed.exr
    same_certificate long.exr killed.exr
    if [[ -e long.deep.exr ]]; then same_pixels long.deep.exr killed.deep.exr; fi
    rm -f long.deep.exr killed.deep.exr
    [[ ! -e killed.exr.ckpt ]] || fault "the checkpoint stays after the end"
    printf '%d kills, %d runs %s\n' "$killed" $((run + 1)) "$(basename "$scene")"
}

finish() {
    [[ $faults -eq 0 ]] || printf '%d faults\n' "$faults"
    exit $((faults > 0))
}
