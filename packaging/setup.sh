# shellcheck shell=bash
# Shared by ./abbe and ./test: packages and builds. Everything is said on stderr, because stdout belongs to the program.
# Requires: `root` is the top of the source tree.

say() { printf 'abbe: %s\n' "$*" >&2; }
fail() { say "$@"; exit 3; }

# The packages of the given lists that are not installed, one a line.
missing_packages() {
    local wanted installed
    wanted=$(sed 's/#.*//' "$@" | tr -s ' \t' '\n' | sed '/^$/d' | sort -u)
    installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p' | sort -u)
    comm -23 <(printf '%s\n' "$wanted") <(printf '%s\n' "$installed")
}

# Installs what is missing from the given lists. Never waits for an answer.
install_packages() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this system has no apt; the packages to have are listed in ${*#"$root/"}"
        return 0
    fi
    local missing admin=()
    mapfile -t missing < <(missing_packages "$@")
    [[ ${#missing[@]} -eq 0 ]] && return 0
    [[ $(id -u) -eq 0 ]] || admin=(sudo -n)
    local update=("${admin[@]}" apt-get update -q)
    local install=("${admin[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}")
    say "${#missing[@]} packages are missing and are installed now:"
    say "  ${install[*]}"
    local by_hand="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    [[ $(id -u) -eq 0 ]] || by_hand="sudo sh -c '$by_hand'"
    mkdir -p "$root/build"
    local log=$root/build/install.log
    if { "${update[@]}" && "${install[@]}"; } >"$log" 2>&1 </dev/null; then
        say "packages installed"
    else
        tail -n 15 "$log" >&2
        say "the packages could not be installed (all output: $log). Type this, then try again:"
        fail "  $by_hand"
    fi
}

# Other renderers and readers of KDL that tests compare with, from PyPI and npm, in build/peers. Without them those tests
# are skipped. Debian's nodejs comes without npm.
install_peers() {
    local place=$root/build/peers list=$root/tests/exchange/requirements.txt log=$root/build/install.log
    mkdir -p "$root/build"
    if { [[ -x $place/bin/python ]] || /usr/bin/python3 -m venv "$place"; } >"$log" 2>&1 </dev/null &&
        "$place/bin/python" -m pip install --disable-pip-version-check -q -r "$list" >>"$log" 2>&1 </dev/null; then
        if command -v npm >/dev/null; then
            npm install --prefix "$place" --silent --no-audit --no-fund @bgotink/kdl@0.4.0 >>"$log" 2>&1 </dev/null ||
                say "@bgotink/kdl could not be installed; scenes are compared with one reader of KDL less"
        fi
        return 0
    fi
    tail -n 3 "$log" >&2
    say "other renderers could not be installed; tests that compare with them are skipped"
}

# build_preset PRESET TARGET…: configures and builds below build/PRESET, output in build.log there.
build_preset() {
    local preset=$1 directory=$root/build/$1
    shift
    mkdir -p "$directory"
    local log=$directory/build.log
    say "building build/$preset (a few minutes the first time; all output: $log)"
    if ! (cd "$root" && cmake --preset "$preset") >"$log" 2>&1 </dev/null; then
        build_failed "$log" "configuring"
        return 1
    fi
    if ! cmake --build "$directory" --target "$@" 2>&1 </dev/null | tee -a "$log" | show_progress; then
        build_failed "$log" "building"
        return 1
    fi
}

build_failed() {
    grep -E -m 20 '(error|Error|ERROR|FAILED)' "$1" >&2 || tail -n 30 "$1" >&2
    say "$2 failed; all output is in $1. If the tree was changed lately, remove ${1%/*} and try again."
}

# Turns ninja's "[12/80] …" into one line that is rewritten on a terminal, or a line per fifth, with the time left: as much for each
# of the steps to come as for those so far.
show_progress() {
    local line fifth=0 shown=0 built all started=$SECONDS
    while IFS= read -r line; do
        [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
        built=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]}
        if [[ -t 2 ]]; then
            printf '\rabbe: built %d of %d%s   ' "$built" "$all" "$(time_left)" >&2
            shown=1
        elif (( built * 5 / all > fifth )); then
            fifth=$(( built * 5 / all ))
            say "built $built of $all$(time_left)"
        fi
    done
    (( shown == 0 )) || printf '\n' >&2
}

# ", about 2 min left" for show_progress; nothing while too little is known.
time_left() {
    local spent=$((SECONDS - started)) seconds
    (( spent >= 5 && built < all )) || return 0
    seconds=$(( spent * (all - built) / built ))
    if (( seconds >= 90 )); then
        printf ', about %d min left' $(( (seconds + 30) / 60 ))
    else
        printf ', about %d s left' $(( seconds < 1 ? 1 : seconds ))
    fi
}
