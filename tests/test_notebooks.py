"""Notebooks of the examples: committed without outputs, and run by `make notebooks`."""

import json
from pathlib import Path

import pytest

from kinesic.report.display.frame import MAX_DISPLAY_SIZE

NOTEBOOKS = sorted((Path(__file__).parent.parent / "examples" / "notebooks").glob("*.ipynb"))
DISPLAYED = {  # beginnings of the objects that a notebook must display, by name of the notebook
    "compare_styles": ("<style", "<plan", "<performance"),
    "text_to_gestures": ("<plan", "<synonym match", "<plan"),
    "virtual_servos": ("<robot", "<performance"),
}
MAX_SECONDS = 300.0  # [s] longest run of one cell, on a machine that is shared with other work


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_committed_without_outputs_and_begins_with_a_title(path: Path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["outputs"] for cell in cells if cell["outputs"] or cell["execution_count"]] == []
    assert "".join(notebook["cells"][0]["source"]).startswith("# ")
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"


def test_each_notebook_has_a_list_of_expected_displays():
    assert {path.stem for path in NOTEBOOKS} == DISPLAYED.keys()


@pytest.mark.soak
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_and_shows_its_objects(path: Path, tmp_path: Path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=MAX_SECONDS, kernel_name="python3", resources=place).execute()
    shown = [output.data for cell in notebook.cells for output in cell.get("outputs", []) if "data" in output]
    displays = [data for data in shown if data["text/plain"].startswith(DISPLAYED[path.stem])]
    assert tuple(data["text/plain"].split()[0] for data in displays) == tuple(
        beginning.split()[0] for beginning in DISPLAYED[path.stem]
    )
    assert all("text/html" in data for data in displays)
    assert all(len(str(content)) < MAX_DISPLAY_SIZE for data in shown for content in data.values())
    streams = [output for cell in notebook.cells for output in cell.get("outputs", []) if "name" in output]
    assert [stream.text for stream in streams if stream.name == "stderr"] == []
