#!/usr/bin/env bash
# `abbe view` as a program: an address on stdout, a picture after each save, who is let in and who is not, and an end.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
requests=$scenes/../view_requests.mjs

command -v node >/dev/null || { echo "no node"; exit 77; }
expect 3 view missing.scene
says err missing.scene
expect 3 view .
expect 2 view
expect 2 view "$scenes/room.scene" --port 0
expect 2 view "$scenes/room.scene" --port 70000

cp "$scenes/room.scene" room.scene
"$program" view room.scene --size 96x64 --samples 16 >url 2>told &
job=$!
for _ in {1..300}; do
    [[ -s url ]] && break
    kill -0 "$job" 2>/dev/null || break
    sleep 0.1
done
grep -qE '^http://127\.0\.0\.1:[0-9]+/\?token=[A-Za-z0-9_-]{22,}$' url || fault "no address: $(cat url told)"
node "$requests" "$(cat url)" room.scene || fault "requests"
# What is shown in the end is the picture of a render.
expect 0 render room.scene --size 96x64 --samples 16 -q -o rendered.exr
expect 0 compare room.view-0001.exr rendered.exr --threshold 0
expect 0 info room.view-0001.exr
for name in version sceneHash command seed samples error noise; do says out "abbe.$name"; done
# The port is taken, and only on this machine.
port=$(sed -E 's/.*:([0-9]+)\/.*/\1/' url)
expect 3 view room.scene --port "$port"
tells err "$port" --port
kill -INT "$job"
ended_with 0
is_empty told
ls ./*.tmp 2>/dev/null && fault "temporary files are left"
"$program" view room.scene --size 96x64 --samples 100000000 >url 2>told & # also in the middle of a render
job=$!
sleep 1
kill -TERM "$job"
ended_with 0

# --open gives the address to xdg-open as one word, in a process group that Ctrl-C does not reach; without one it goes on.
mkdir -p bin
cat >bin/xdg-open <<'END'
#!/bin/sh
[ "$(ps -o pgid= -p $$ | tr -d ' ')" = "$$" ] && apart=apart
echo "$# $1 $apart" >opened.new
mv opened.new opened
END
chmod +x bin/xdg-open
rm url
PATH=$PWD/bin:$PATH "$program" view room.scene --size 96x64 --open >url 2>told &
job=$!
for _ in {1..300}; do [[ -s opened ]] && break; sleep 0.1; done
[[ $(cat opened 2>/dev/null) == "1 $(<url) apart" ]] || fault "opened: $(cat opened 2>/dev/null), not $(<url)"
kill -INT "$job"
ended_with 0
rm bin/xdg-open url
PATH=$PWD/bin "$program" view room.scene --size 96x64 --open >url 2>told &
job=$!
for _ in {1..300}; do [[ -s url ]] && break; sleep 0.1; done
[[ -s url ]] || fault "no address without xdg-open"
kill -INT "$job"
ended_with 0
is_empty told
finish
