"""The notebooks run, each once: what they assert holds, and what they show is of today's code.

What a notebook claims it asserts, in the cell that shows it. Outputs are compared as well, for
the site shows those that are committed. `python tests/test_notebooks.py` executes all and saves
their outputs, `python tests/test_notebooks.py 03 05` those two.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
PATHS = sorted(NOTEBOOKS.glob("*.ipynb"))
COMPARED = ("text/latex", "text/plain")


def runner(notebook: nbformat.NotebookNode) -> NotebookClient:
    """What executes `notebook`, beside the others."""
    return NotebookClient(
        notebook,
        timeout=300,
        kernel_name="python3",
        resources={"metadata": {"path": str(NOTEBOOKS)}},
        record_timing=False,
        coalesce_streams=True,
    )


def tidy(notebook: nbformat.NotebookNode) -> None:
    """Keep nothing that depends on when and where a notebook was executed."""
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


@pytest.fixture(scope="module")
def kernel() -> Iterator[NotebookClient]:
    """One kernel for all notebooks: its start and its imports take longer than most of them."""
    client = runner(nbformat.v4.new_notebook())
    with client.setup_kernel():
        yield client


#: A name that an earlier notebook defined is none here. An image is not compared: it is drawn once,
#: without a look at how much of it is empty. Compiling makes many objects that stay
BEFORE = """%reset -f
%matplotlib inline
%config InlineBackend.print_figure_kwargs = {"bbox_inches": None}
__import__("gc").set_threshold(100_000, 50, 100)
"""


def test_notebooks_are_in_order():
    """Each has its number in name and title, a picture, and two exercises with computed answers."""
    assert len(PATHS) >= 12
    for number, path in enumerate(PATHS, start=1):
        assert path.stem.startswith(f"{number:02d}_")
        cells = nbformat.read(path, as_version=4).cells
        assert cells[0].source.startswith(f"# {number} · ")
        answers = [cell for cell in cells if "answer" in cell.metadata.get("tags", [])]
        assert [("assert " in cell.source, bool(cell.outputs)) for cell in answers] == 2 * [
            (True, True)
        ]
        assert "".join(cell.source for cell in cells).count("<summary>Answer</summary>") == 2
        outputs = [output for cell in cells for output in cell.get("outputs", [])]
        assert any("image/png" in output.get("data", {}) for output in outputs)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_outputs_are_current(path, kernel):
    committed = nbformat.read(path, as_version=4)
    fresh = nbformat.read(path, as_version=4)
    kernel.nb = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(BEFORE), *fresh.cells])
    kernel.execute(cleanup_kc=False)  # an error in a cell raises here
    tidy(fresh)
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
        runner(content).execute()
        tidy(content)
        nbformat.write(content, notebook_path)
