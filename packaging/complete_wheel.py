"""Puts libraries into a wheel that auditwheel takes for part of every system and a bare Debian has not (X11, GLib, which image formats come with):

complete_wheel.py WHEEL FOLDER   writes the wheel of the same name into the folder. Needs `wheel` and `patchelf`.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# What Python itself and libstdc++ bring along.
BASE = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|stdc\+\+|gcc_s|z|expat))\.so\.[0-9]+$")


def is_elf(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) == b"\x7fELF"


def needed(path: Path) -> list[str]:
    return subprocess.run(["patchelf", "--print-needed", str(path)], check=True, capture_output=True, text=True).stdout.split()


def system_places() -> dict[str, Path]:
    """By soname, as the loader's cache has them."""
    lines = subprocess.run(["/sbin/ldconfig", "-p"], check=True, capture_output=True, text=True).stdout.splitlines()
    found = (re.match(r"\s*(\S+) \(libc6,x86-64.*\) => (\S+)", line) for line in lines)
    return {m[1]: Path(m[2]) for m in found if m}


def complete(root: Path) -> list[str]:
    """The libraries that were added."""
    places, added = system_places(), []
    folder = next(root.glob("*.libs"))
    waiting = [path for path in root.rglob("*") if path.is_file() and is_elf(path)]
    there = {path.name for path in waiting}
    while waiting:
        for soname in needed(waiting.pop()):
            if soname in there or BASE.match(soname):
                continue
            copy = folder / soname
            shutil.copyfile(places[soname].resolve(), copy)
            subprocess.run(["patchelf", "--set-rpath", "$ORIGIN", str(copy)], check=True)
            there.add(soname)
            added.append(soname)
            waiting.append(copy)
    return added


def main() -> int:
    wheel, target = Path(sys.argv[1]), Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([sys.executable, "-m", "wheel", "unpack", str(wheel), "-d", scratch], check=True, stdout=subprocess.DEVNULL)
        root = next(Path(scratch).iterdir())
        print("added to the wheel:", *complete(root))
        target.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", str(root), "-d", str(target)], check=True, stdout=subprocess.DEVNULL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
