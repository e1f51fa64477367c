# shellcheck shell=bash
# Which unit tests need not run again before a commit, because nothing has changed since they passed. Sourced by ./test, which uses
# it for `quick` alone. A stamp is a hash of the test's program, of every file of the tree that is no C++ source, of the helpers beside
# the programs, of installed packages and of ABBE_* in the environment. Links are by static libraries, and the same sources give
# the same program: a change in materials/ changes the programs of those tests that link it.
# Requires: the working folder is the top of the source tree.

# What is the same for all tests; nothing where there is no git, and then all tests run.
shared_inputs() { # PRESET
    git rev-parse --is-inside-work-tree >/dev/null 2>&1 || return 0
    {
        git ls-files -z --cached --others --exclude-standard | grep -zvE '\.(h|cpp)$' | sort -z | xargs -0 sha256sum
        sha256sum "build/$1"/abbe-vdb "build/$1"/*.so "build/$1"/tests/vdb_cases
        dpkg-query -W
        env | grep '^ABBE_' | sort
    } 2>/dev/null | sha256sum | cut -d ' ' -f 1
}

# The stamp that a test would have now.
stamp_of() { # PRESET TEST SHARED_INPUTS
    printf '%s %s\n' "$3" "$(sha256sum <"build/$1/tests/test_$2")"
}

# The tests of a label whose stamps are as they were, one a line.
unchanged_tests() { # PRESET SHARED_INPUTS
    local program name
    for program in "build/$1"/tests/test_*; do
        name=${program##*/test_}
        [[ -n $2 && -f build/$1/passed/$name && $(stamp_of "$1" "$name" "$2") == "$(<"build/$1/passed/$name")" ]] && echo "$name"
    done
}

# Those of the files, one a line, that are not as they were when the check of that name passed last; all of them where one of its rules has
# changed, or with `all`. note_files afterwards, if it passes.
changed_files() { # CHECK SCOPE RULE… <FILES
    local now=build/$1.now passed=build/$1.passed rules
    rules=$(cat "${@:3}" | sha256sum | cut -d ' ' -f 1)
    xargs -r -d '\n' sha256sum | sed "s/^/$rules /" | sort >"$now"
    [[ $2 != all && -f $passed ]] || : >"$passed"
    comm -23 "$now" "$passed" | cut -d ' ' -f 4-
}

note_files() { # CHECK
    mv "build/$1.now" "build/$1.passed"
}

# Leaves stamps of the tests that passed, as a report of ctest has them.
note_passed() { # PRESET SHARED_INPUTS REPORT
    local name
    [[ -n $2 ]] || return 0
    mkdir -p "build/$1/passed"
    sed -n 's/.*<testcase name="\([^"]*\)".*status="run".*/\1/p' "$3" | while IFS= read -r name; do
        [[ -x build/$1/tests/test_$name ]] && stamp_of "$1" "$name" "$2" >"build/$1/passed/$name"
    done
}
