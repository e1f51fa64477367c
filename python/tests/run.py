"""Runs the tests of abbe.usd with a program: `run.py ABBE [NAME…]`. Exit code 77, skipped, where usd-core is missing."""

from __future__ import annotations

import os
import sys
import unittest
from pathlib import Path


def main() -> int:
    try:
        import numpy  # noqa: F401
        from pxr import Usd  # noqa: F401
    except ImportError as fault:
        print(f"skipped: {fault}; docs/testing.md says what to install")
        return 77
    if len(sys.argv) > 1:
        os.environ["ABBE"] = os.path.abspath(sys.argv[1])
    here = Path(__file__).resolve().parent
    sys.path[:0] = [str(here.parent / "src"), str(here)]
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(sys.argv[2:]) if len(sys.argv) > 2 else loader.discover(str(here))
    return 0 if unittest.TextTestRunner(verbosity=1).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
