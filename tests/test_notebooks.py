"""The notebooks run, each once: what they assert holds, and what they show is of today's code.

What a notebook claims it asserts, in the cell that shows it. Outputs are compared as well, for
the site shows those that are committed. `python tests/test_notebooks.py` executes all and saves
their outputs, `python tests/test_notebooks.py 03 04b` those two.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
PATHS = sorted(NOTEBOOKS.glob("*.ipynb"))
COMPARED = ("text/latex", "text/plain")


def execute(notebook: nbformat.NotebookNode) -> None:
    """Run all cells in a fresh kernel and keep nothing that depends on when and where."""
    NotebookClient(
        notebook,
        timeout=300,
        kernel_name="python3",
        resources={"metadata": {"path": str(NOTEBOOKS)}},
        record_timing=False,
        coalesce_streams=True,
    ).execute()
    notebook.metadata["language_info"] = {"name": "python"}
    for cell in notebook.cells:  # what the first run of all says of compiling
        if "outputs" in cell:
            cell.outputs = [each for each in cell.outputs if each.get("name") != "stderr"]


def shown(cell: nbformat.NotebookNode) -> list[Any]:
    """Collect what a cell printed and displayed, less its images."""
    texts: list[Any] = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream":
            texts.append(output.text)
        else:
            texts.append({mime: output.data[mime] for mime in COMPARED if mime in output.data})
    return texts


def test_all_notebooks_are_found():
    assert len(PATHS) >= 8


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_outputs_are_current(path):
    committed = nbformat.read(path, as_version=4)
    fresh = nbformat.read(path, as_version=4)
    execute(fresh)  # an error in a cell raises here
    for old, new in zip(committed.cells, fresh.cells, strict=True):
        assert shown(old) == shown(new), f"stale output below\n{old.source}"


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_nothing_was_written_to_stderr(path):
    cells = nbformat.read(path, as_version=4).cells
    outputs = [output for cell in cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert "execution" not in {key for cell in cells for key in cell.metadata}


if __name__ == "__main__":
    numbers = sys.argv[1:] or [path.name.split("_")[0] for path in PATHS]
    for notebook_path in (path for path in PATHS if path.name.split("_")[0] in numbers):
        content = nbformat.read(notebook_path, as_version=4)
        execute(content)
        nbformat.write(content, notebook_path)
