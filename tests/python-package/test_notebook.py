"""The notebook of the documentation runs, prints the documented results, and is stored without
outputs."""

import re

import nbformat
import pytest
from nbclient import NotebookClient

from conftest import TOP

NOTEBOOK = TOP / "docs" / "python.ipynb"


@pytest.fixture(scope="module")
def executed():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": NOTEBOOK.parent}}).execute()
    return notebook


def shown(notebook, start):
    cells = [cell for cell in notebook.cells if cell.cell_type == "code" and start in cell.source]
    assert len(cells) == 1
    return cells[0].outputs[-1]["data"]


def test_the_notebook_is_stored_without_outputs():
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    assert all(cell.cell_type != "code" or (not cell.outputs and cell.execution_count is None) for cell in cells)


def test_the_notebook_has_the_hash_of_the_command(executed, golden):
    assert shown(executed, "record=2")["text/plain"] == f"('{golden('swap-circle')[0]}', 16, 0)"


def test_a_run_is_displayed_inline(executed):
    recorded = [cell for cell in executed.cells if cell.source == "result"]
    html = recorded[0].outputs[-1]["data"]["text/html"]
    assert html.startswith("<iframe") and "id=&quot;recording&quot;" in html


def test_a_law_by_name_keeps_robots_apart(executed):
    assert shown(executed, '"law": "goal_flock"')["text/plain"] == "0"


def test_an_own_law_keeps_robots_apart(executed):
    text = re.sub(r"\s+", " ", shown(executed, "def vortex")["text/plain"])
    assert text.startswith("(0, array([") and all(1.0 < float(r) < 3.0 for r in re.findall(r"\d\.\d+", text))


def test_a_thousand_robots_do_not_touch(executed):
    least = re.match(r"\(np.float64\(([0-9.]+)\)", shown(executed, "staya.Orca(")["text/plain"])
    assert float(least.group(1)) > 0.4 - 1e-3
