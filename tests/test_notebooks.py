"""The notebooks run from their first cell to the last, and show what they promise."""

import re
import shutil
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

EXAMPLES = Path(__file__).parents[1] / "examples"
NOTEBOOKS = sorted((EXAMPLES / "notebooks").glob("*.ipynb"))


def shown(notebook: nbformat.NotebookNode) -> list[tuple[str, str]]:
    """Kind and text of everything that the cells show."""
    found = []
    for output in (o for cell in notebook.cells if cell.cell_type == "code" for o in cell.outputs):
        if output.output_type == "stream":
            found.append((output.name, output.text))
        found += list(output.get("data", {}).items())
    return found


@pytest.fixture(scope="module", params=NOTEBOOKS, ids=lambda path: path.stem)
def ran(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> nbformat.NotebookNode:
    place = tmp_path_factory.mktemp("notebook") / "examples"
    shutil.copytree(EXAMPLES, place)
    notebook = nbformat.read(request.param, as_version=4)
    where = {"metadata": {"path": str(place / "notebooks")}}
    return NotebookClient(notebook, timeout=300, kernel_name="python3", resources=where).execute()


@pytest.mark.slow
def test_a_notebook_runs_and_shows_a_diagnosis_and_a_figure(ran: nbformat.NotebookNode) -> None:
    kinds = {kind for kind, _ in shown(ran)}
    assert "image/png" in kinds
    assert any(kind == "text/html" and "Diagnosis named" in text for kind, text in shown(ran))


@pytest.mark.slow
def test_no_cell_warns_or_shows_pages_of_text(ran: nbformat.NotebookNode) -> None:
    assert [text for kind, text in shown(ran) if kind == "stderr"] == []
    texts = [re.sub(r'src="data:[^"]*"', "", text) for kind, text in shown(ran) if kind != "image/png"]
    assert max(map(len, texts)) < 8000


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(NOTEBOOKS) == 2
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
