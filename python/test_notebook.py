"""The notebook of the docs runs, from its first cell to the last.

    BRAKEWAVE=target/release/brakewave python3 python/test_notebook.py

Where nbclient, nbformat and ipykernel are there a kernel runs it as Jupyter would; elsewhere its cells are executed one
after the other.
"""

import contextlib
import importlib.util
import io
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

if any(importlib.util.find_spec(name) is None for name in ("pandas", "matplotlib")):
    print("test of the notebook skipped: pandas or matplotlib is not here")
    sys.exit(0)

import matplotlib

matplotlib.use("Agg")
from testing import ROOT, require_binary

NOTEBOOK = ROOT / "docs" / "notebook.ipynb"


class Notebook(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        self.notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
        self.cells = [cell for cell in self.notebook["cells"] if cell["cell_type"] == "code"]

    def test_every_cell_runs(self):
        names = {}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            for cell in self.cells:
                exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
        self.assertGreater(Path("impact.png").stat().st_size, 10_000)
        # below the fold the orbit of one impact is unstable, and the orbit of eight periods is found
        self.assertEqual(len(names["branches"]), 2, printed.getvalue())
        self.assertIn("continuation.parameter: `B` is no parameter", printed.getvalue())
        self.assertRegex(names["single"]._repr_html_(), "(?s)<table.*<img src=.data:image/svg")

    def test_a_kernel_runs_it(self):
        if any(importlib.util.find_spec(name) is None for name in ("nbclient", "nbformat", "ipykernel")):
            print("not run by a kernel: nbclient, nbformat or ipykernel is not here")
            self.skipTest("nothing to run it with")
        import nbclient
        import nbformat

        notebook = nbformat.read(NOTEBOOK, as_version=4)
        nbformat.validate(notebook)
        nbclient.NotebookClient(notebook, timeout=600).execute()
        shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        self.assertFalse([output for output in shown if output["output_type"] == "error"])
        pages = [output["data"]["text/html"] for output in shown if "text/html" in output.get("data", {})]
        self.assertTrue(any("data:image/svg+xml" in page and "<table" in page for page in pages))

    def test_it_is_kept_without_outputs(self):
        for cell in self.cells:
            self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None), cell["id"])


if __name__ == "__main__":
    require_binary()
    unittest.main()
