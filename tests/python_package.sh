#!/usr/bin/env bash
# Builds the wheel of the Python package out of the objects of build/dev, installs it into an empty environment and runs its tests there:
#   tests/python_package.sh [NAME…]   all of python/tests/api, or test_render, test_scene.Errors, …
# With WHEEL=plain without putting the shared libraries into the wheel.
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
place=$root/build/wheel
rm -f "$place"/*.whl
wheel=$("$root/packaging/wheel.sh" "$place" dev RelWithDebInfo | tail -n 1)
printf '%s, %s bytes\n' "$(basename "$wheel")" "$(stat -c %s "$wheel")"
rm -rf "$place/venv"
python3 -m venv "$place/venv"
"$place/venv/bin/python" -m pip install --disable-pip-version-check -q "$wheel"
# A notebook is executed by these, where they can be had.
"$place/venv/bin/python" -m pip install --disable-pip-version-check -q nbclient ipykernel || printf 'no nbclient: the notebook is left out\n'
cd "$root/python/tests/api"
export ABBE=$root/build/dev/abbe ABBE_WHEEL=${WHEEL:-whole}
unset LD_LIBRARY_PATH PYTHONPATH
if (($# > 0)); then
    exec "$place/venv/bin/python" -m unittest "$@"
fi
exec "$place/venv/bin/python" -m unittest discover
