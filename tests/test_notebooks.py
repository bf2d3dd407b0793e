"""The notebooks run, and what they show is what the code gives today.

`python tests/test_notebooks.py` executes them and saves their outputs; the test executes them
and compares.
"""

from __future__ import annotations

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


def shown(cell: nbformat.NotebookNode) -> list[Any]:
    """Collect what a cell printed and displayed, less its images and warnings."""
    texts: list[Any] = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream":
            if output.name == "stdout":
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
    for notebook_path in PATHS:
        content = nbformat.read(notebook_path, as_version=4)
        execute(content)
        nbformat.write(content, notebook_path)
