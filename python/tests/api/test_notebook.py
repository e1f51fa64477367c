"""The tutorial, executed from top to bottom."""

from __future__ import annotations

import json
import unittest
from pathlib import Path

import abbe

TUTORIAL = Path(__file__).resolve().parents[2] / "tutorial.ipynb"


class Tutorial(unittest.TestCase):
    def test_in_a_kernel(self) -> None:
        try:
            import nbclient
            import nbformat
        except ImportError as fault:
            self.skipTest(str(fault))
        book = nbformat.read(TUTORIAL, as_version=4)
        nbclient.NotebookClient(book, timeout=300, kernel_name="python3").execute()
        kinds = [kind for cell in book.cells for output in cell.get("outputs", ()) for kind in output.get("data", ())]
        self.assertIn("image/png", kinds)

    def test_without_one(self) -> None:
        """The same statements, where no kernel can be had."""
        names: dict[str, object] = {}
        for cell in json.loads(TUTORIAL.read_text(encoding="utf-8"))["cells"]:
            self.assertFalse(cell.get("outputs"), "outputs are not kept")
            if cell["cell_type"] == "code":
                exec("".join(cell["source"]), names)
        self.assertIsInstance(names["image"], abbe.Image)


if __name__ == "__main__":
    unittest.main()
