#!/usr/bin/env bash
# abbe volume: makes, inspects and converts OpenVDB files.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"

expect 0 volume make fire fire.vdb --resolution 24
is_empty out
says err "volume fire.vdb"
expect 0 volume info fire.vdb
is_empty err
says out "grids        3"
says out "temperature"
says out "unit         K"
says out "stored as half"
expect 0 volume info --json fire.vdb
"$json_lines" --whole <out >/dev/null || fault "info --json is no JSON"
expect 0 volume make smoke smoke.vdb --resolution 24 --seed 3 --quiet
is_empty err
expect 0 volume info smoke.vdb
says out "vec3s"
expect 0 volume make cumulus cloud.vdb --resolution 48

# the same command, the same values
expect 0 volume make fire again.vdb --resolution 24
expect 0 volume info fire.vdb
cp out first
expect 0 volume info again.vdb
cmp -s out first || fault "two runs differ"

expect 0 volume convert fire.vdb small.vdb --grid density --resample 2 --half --clean --prune 0.001
expect 0 volume info small.vdb
says out "grids        1"
says_not out "temperature"
expect 0 volume convert cloud.vdb part.vdb --crop -100,0,-100,100,300,100
expect 0 volume info --json part.vdb

# wrong command lines
expect 2 volume
expect 2 volume make
expect 2 volume make tornado x.vdb
expect 2 volume make fire x.vdb --resolution 4
expect 2 volume info
expect 2 volume convert fire.vdb x.vdb --crop 1,2,3
expect 2 volume info fire.vdb --jsn
says err "did you mean \`--json\`?"
expect 0 volume --help
expect 0 volume make --help
says out "--resolution"

# wrong files; whatever stood at the output stays
expect 1 volume convert fire.vdb fire.vdb --grid densiti
says err "no grid \`densiti\`"
cp fire.vdb before.vdb
cmp -s fire.vdb before.vdb || fault "the output was touched"
expect 3 volume info none.vdb
says err "none.vdb"
for size in 500 2000; do
    head -c $size fire.vdb >cut.vdb
    expect 3 volume info cut.vdb
    says err "\`cut.vdb\`"
    tells err damaged "$size bytes"
    says_not err "Error:"
done
expect 3 volume convert cut.vdb out.vdb
[[ ! -e out.vdb && -z $(find . -name '*.tmp') ]] || fault "a failed conversion left a file"
printf 'not a volume' >text.vdb
expect 3 volume info text.vdb
tells err text.vdb OpenVDB
says_not err "not a vo" # it is nobody's business what is in it
says_not err "Error:"
expect 3 volume make fire no/such/folder/x.vdb
mkdir folder.vdb
expect 3 volume info folder.vdb
expect 3 volume make fire folder.vdb

# interrupted: nothing is left behind, and what stood there stays
cp fire.vdb kept.vdb
"$program" volume make cumulus kept.vdb --resolution 2000 >out 2>err &
child=$!
sleep 1
kill -INT "$child"
wait "$child"
code=$?
[[ $code -eq 130 ]] || fault "an interrupted make ended with $code"
cmp -s fire.vdb kept.vdb || fault "an interrupted make replaced its output"
[[ -z $(find . -name '*.tmp') ]] || fault "an interrupted make left a file"

finish
