#!/usr/bin/env bash
# A study against another renderer: a stub in the place of Mitsuba, which does what it is asked for or fails in every
# way, and Mitsuba itself where a Python has it.
# shellcheck source=tests/cli/lib.sh
source "$(dirname -- "$0")/lib.sh" "$@"
export XDG_CACHE_HOME=$folder/xdg
tests=$(cd "$scenes/../.." && pwd)
python=$(command -v python3) || { echo "skipped: there is no python3"; exit 77; }

cat >room.xml <<'S'
<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="8"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="32"/><rfilter type="box"/></film></sensor>
  <emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
  <shape type="sphere"><bsdf type="diffuse"/></shape>
</scene>
S
small=(--size 24x16 --samples 32 --seeds 5 --variants none)
# The stub by way of a Python that finds it first.
printf '#!/bin/sh\nPYTHONPATH=%s exec %s "$@"\n' "$tests/support/peer_stub" "$python" >stub
chmod +x stub
export ABBE_PEER_PYTHON=$folder/stub

# What lies in the current folder is not run.
printf 'raise SystemExit("planted")\n' >drjit.py

# Its curve stands in the report, with a slope of independent samples and against a reference of its own.
expect 0 study room.xml "${small[@]}" --against mitsuba -o peer
says out "Mitsuba"
says peer.json '"peers":[{"id":"mitsuba"'
says peer.json '"variant":"scalar_spectral"'
says peer.json '3.stub'
[[ $(grep -c '^mitsuba,' peer.csv) -ge 10 ]] || fault "$(grep -c '^mitsuba,' peer.csv) lines of the peer"
says peer.csv "# mitsuba: Mitsuba 3.stub, scalar_spectral; reference of its own"
says peer.html '"other renderers"'
# A noise of 0.1/√N about 0.25 has a relMSE of 0.16/(1.01 N): four samples 0.0396.
awk -F, '$1 == "mitsuba" && $2 == 4 { sum += $4; ++n } END { exit !(n == 5 && sum / n > 0.036 && sum / n < 0.043) }' peer.csv ||
    fault "errors of the peer are not its noise: $(grep '^mitsuba,4,' peer.csv)"
[[ ! -e peer.state ]] || fault "a finished study leaves its state"
# Nothing of it is left behind.
compgen -G "${TMPDIR:-/tmp}/abbe-peer-*" >left && fault "left: $(cat left)"

# What it cannot do is said before anything is rendered.
for way in start crash; do
    STUB_FAULT=$way expect 3 study room.xml "${small[@]}" --against mitsuba:scalar_spectral -o failed
    says err E0757
done
STUB_FAULT=start expect 3 study room.xml "${small[@]}" --against mitsuba -o failed
says err "no stub today"
says err "pip install mitsuba"
expect 3 study room.xml "${small[@]}" --against mitsuba:scalar_spektral -o failed
says err "scalar_spectral"
ABBE_PEER_PYTHON=$folder/nowhere expect 3 study room.xml "${small[@]}" --against mitsuba -o failed
says err "cannot be started"
STUB_FAULT=damaged expect 3 study room.xml "${small[@]}" --against mitsuba -o failed
says err "cannot be read"
# A scene of this program's is exported for it.
expect 0 study "$scenes/room.scene" "${small[@]}" --against mitsuba -o exported
says exported.xml "<scene"
says exported.csv "Mitsuba"
expect 1 study room.xml --against mitsuba --camera camera -o failed
says err E0756
expect 1 study room.xml --against mitsuba --effects -o failed
says err E0756
expect 2 study room.xml --against pbrt
says err "mitsuba:VARIANT"

# What fails late leaves a report without it; what hangs is left at the end of the time, or at Ctrl-C.
STUB_FAULT=late expect 3 study room.xml "${small[@]}" --against mitsuba -o late
says err "had enough"
says late.csv "abbe,"
says_not late.csv "mitsuba,"
expect 0 study room.xml "${small[@]}" --against mitsuba -o late --resume
says late.csv "mitsuba,"
STUB_FAULT=hang expect 3 study room.xml "${small[@]}" --against mitsuba -o slow --time 4
says err "the time ended"
STUB_FAULT=hang "$program" study room.xml "${small[@]}" --against mitsuba -o hanging >out 2>err &
job=$!
for _ in {1..300}; do
    pgrep -P $job -f abbe-peer >child && [[ -e hanging.state/reference.abbe ]] && break
    sleep 0.1
done
kill -INT $job
ended_with 130
! kill -0 "$(head -n 1 child)" 2>/dev/null || fault "the peer goes on after Ctrl-C"

# The peer itself.
unset ABBE_PEER_PYTHON
for real in "$tests/../build/peers/bin/python3" "${ABBE_TEST_PEER:-}"; do
    [[ -x $real ]] && "$real" -c 'import mitsuba' 2>/dev/null || continue
    ABBE_PEER_PYTHON=$real expect 0 study room.xml "${small[@]}" --against mitsuba -o real
    says out "Mitsuba"
    grep -q '^mitsuba,32,' real.csv || fault "Mitsuba did not come to its last rung"
    break
done

finish
