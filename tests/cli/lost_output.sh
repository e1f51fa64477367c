#!/usr/bin/env bash
# Losing what it says ends no render: full disks, closed streams, readers that go away, a terminal that hangs up.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
scene=$scenes/room.scene
small=("$scene" --size 16x16 --samples 4)
expect 0 "${small[@]}" -q -o whole.exr

# after CODE WHAT: the render that just ended is whole.
after() {
    [[ $1 -eq 0 ]] || fault "$2: ended with $1"
    same_pixels whole.exr lost.exr
    rm -f lost.exr*
}
lost=("${small[@]}" -o lost.exr)
"$program" "${lost[@]}" 2>/dev/full; after $? "stderr is full"
"$program" "${lost[@]}" 2>&-; after $? "stderr is closed"
"$program" "${lost[@]}" --json >/dev/full; after $? "stdout is full"
"$program" "${lost[@]}" --json >&-; after $? "stdout is closed"
"$program" "${lost[@]}" --json --cost <&- >&- 2>&-; after $? "all streams are closed"
"$program" "${lost[@]}" 2>&1 | head -n 1 >/dev/null; after "${PIPESTATUS[0]}" "a reader of one line"
"$program" "${lost[@]}" --json | head -c 1 >/dev/null; after "${PIPESTATUS[0]}" "a reader of one byte"
"$program" "${lost[@]}" 2> >(exec true) ; after $? "nobody reads"
# With diagnostics, and where nothing but those is said.
"$program" "$scenes/black.scene" -o lost.exr 2>/dev/full || fault "a warning that is lost ends with $?"
[[ -s lost.exr ]] || fault "no image"
"$program" check "$bad/nine_mistakes.scene" 2>/dev/full
code=$?
[[ $code -eq 1 ]] || fault "errors that are lost end with $code"
"$program" chekc 2>/dev/full
code=$?
[[ $code -eq 2 ]] || fault "a wrong command line whose message is lost ends with $code"

# A file must not become the stream that is closed, and get the text written into it.
"$program" "$scenes/black.scene" -o closed.exr --checkpoint 1ms 2>&- || fault "stderr is closed: $?"
expect 0 info closed.exr

# Text that is the result is no loss that may go unsaid, unless the reader has had enough.
for words in "info whole.exr" "--help" "explain camera" "reference json"; do
    # shellcheck disable=SC2086
    "$program" $words >/dev/full 2>err
    code=$?
    [[ $code -eq 3 ]] || fault "abbe $words, whose text is lost, ends with $code"
done
"$program" info whole.exr >/dev/full 2>err
tells err stdout "No space left"
"$program" explain camera | head -n 1 >/dev/null
[[ ${PIPESTATUS[0]} -eq 0 ]] || fault "a reader who had enough is no fault"

# The terminal goes away: checkpoint and image are saved, and the render goes on.
if command -v script >/dev/null; then
    # shellcheck disable=SC2016
    run='echo $$ >pid; exec "$0" "$@"'
    words=$(printf '%q ' bash -c "$run" "$program" "$scene" --size 32x32 --samples 4000000000 -o hung.exr)
    TERM=xterm script -qfc "$words" shown </dev/null >/dev/null 2>&1 &
    terminal=$!
    for _ in {1..300}; do
        grep -q 'pass' shown 2>/dev/null && break
        sleep 0.1
    done
    job=$(cat pid)
    [[ ! -e hung.exr ]] || fault "an image before the terminal went away"
    kill -KILL "$terminal"
    wait "$terminal" 2>/dev/null
    for _ in {1..100}; do
        [[ -e hung.exr && -e hung.exr.ckpt ]] && break
        sleep 0.1
    done
    [[ -e hung.exr && -e hung.exr.ckpt ]] || fault "nothing was saved when the terminal went away"
    sleep 1 # some lines of progress later
    kill -0 "$job" 2>/dev/null || fault "the render ended with its terminal"
    kill -INT "$job"
    for _ in {1..100}; do
        kill -0 "$job" 2>/dev/null || break
        sleep 0.1
    done
    kill -KILL "$job" 2>/dev/null && fault "the render could not be ended"
    expect 0 info hung.exr
    says out "abbe.partial = 1"
fi

finish
