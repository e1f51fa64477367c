"""The end of a process in which something still runs that was interrupted (docs/python.md, "Ctrl-C")."""

from __future__ import annotations

import atexit
import os
import signal
import sys

from abbe import _abbe


def _end_by_interrupt() -> None:
    """At once, as Python ends by a KeyboardInterrupt that nobody catches."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGINT)


def _wait() -> None:
    """The libraries must not be taken down under a thread that reads or builds a scene."""
    if _abbe.wait_for_abandoned():
        return
    died_of = getattr(sys, "last_type", None)
    if died_of is KeyboardInterrupt and not hasattr(sys, "ps1"):
        _end_by_interrupt()
    try:
        while not _abbe.wait_for_abandoned():
            pass
    except KeyboardInterrupt:
        _end_by_interrupt()


atexit.register(_wait)
