import os

import nbformat
from nbclient import NotebookClient


def test_the_notebook_runs_and_draws(samples, tmp_path):
    notebook = nbformat.read(samples / "panel.ipynb", 4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "kept without what it printed"
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    text = "".join(output.get("text", "") for output in outputs)
    assert len(pictures) == 4 and text.count("passed") >= 3 and "deviation" in text
    if "HOTBLADE_NOTEBOOK" in os.environ:  # kept to be looked at
        nbformat.write(notebook, os.environ["HOTBLADE_NOTEBOOK"])
