"""What is wrong with a scene: every fault with its place, as the program tells it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Diagnostic:
    """One fault or warning. `line` and `column` count from 1; 0 where there is no place, as `file` is then empty."""

    severity: str
    """"error" or "warning"."""
    code: str
    """Stable, documented: "E0201". `abbe.explain("E0201")` says more."""
    message: str
    file: str = ""
    line: int = 0
    column: int = 0
    end_line: int = 0
    end_column: int = 0
    label: str = ""
    """What stands beside the caret of the excerpt."""
    notes: tuple[str, ...] = ()
    """Facts, and other places that belong to it."""
    help: str = ""
    """The remedy, where one is likely right."""

    @classmethod
    def _of(cls, record: tuple[Any, ...]) -> Diagnostic:
        severity, code, message, file, line, column, end_line, end_column, label, notes, remedy = record
        return cls(severity, code, message, file, line, column, end_line, end_column, label, tuple(notes), remedy)

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.file else ""
        remedy = f"; {self.help}" if self.help else ""
        return f"{place}{self.severity}[{self.code}]: {self.message}{remedy}"


class SceneError(Exception):
    """A scene, or a render of it, has errors. `diagnostics` has all of them, warnings among them; str() is what the program prints, with
    excerpts of the text."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...], text: str = "") -> None:
        super().__init__(text.strip() or "\n".join(str(d) for d in diagnostics))
        self.diagnostics = diagnostics

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self.diagnostics, self.args[0]))


def one_fault(code: str, message: str, remedy: str = "") -> SceneError:
    return SceneError((Diagnostic("error", code, message, help=remedy),))


def diagnostics_of(log: Any) -> tuple[Diagnostic, ...]:
    """Of an extension's log."""
    return tuple(Diagnostic._of(record) for record in log.records())


def raise_errors(log: Any) -> tuple[Diagnostic, ...]:
    """Raises SceneError if there is an error among them, else returns the warnings."""
    found = diagnostics_of(log)
    if log.has_errors():
        raise SceneError(found, log.text())
    return found
