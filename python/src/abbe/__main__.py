"""The program `abbe`, out of the extension: `python -m abbe render room.scene`, and the command `abbe` of the package."""

import sys

from abbe import _abbe


def main() -> int:
    return _abbe.run_program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
