"""The program `abbe`, out of the extension: `python -m abbe render room.scene`, and the command `abbe` of the package."""

import sys

from abbe import _abbe


def main() -> int:
    words = sys.argv[1:]
    # Other machines, and other processes, are told to start the program itself, which Python is not.
    if words[:1] == ["farm"] and not {"-h", "--help"} & set(words):
        print(
            "abbe: farm: a farm starts the program `abbe`, which this package has as a library only; use one that was built by CMake", file=sys.stderr
        )
        return 2
    return _abbe.run_program(words)


if __name__ == "__main__":
    sys.exit(main())
