"""The notebooks: each runs from its first cell to its last, and keeps no output."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def cells(file: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(file.read_text("utf-8"))["cells"]
    return found


def test_there_are_notebooks() -> None:
    names = {file.stem for file in NOTEBOOKS}
    assert names == {"first-tour", "planner-with-gradients", "equation-12-yourself", "robot-arm"}


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_is_well_formed_and_keeps_no_output(file: Path) -> None:
    content = json.loads(file.read_text("utf-8"))
    assert (content["nbformat"], content["nbformat_minor"]) == (4, 5)
    assert content["metadata"]["kernelspec"]["language"] == "python"
    assert len({cell["id"] for cell in content["cells"]}) == len(content["cells"])
    for cell in content["cells"]:
        assert cell["cell_type"] in ("markdown", "code")
        assert isinstance(cell["source"], list)
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None


@pytest.fixture
def no_windows() -> Iterator[None]:
    """Figures of pyplot need no display, and are closed at the end."""
    plt.switch_backend("Agg")
    yield
    plt.close("all")


@pytest.mark.usefixtures("no_windows")
@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_runs(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    code = [cell for cell in cells(file) if cell["cell_type"] == "code"]
    if any("import mujoco" in line for cell in code for line in cell["source"]):
        pytest.importorskip("mujoco")
    assert any("assert " in line for cell in code for line in cell["source"])
    for k, cell in enumerate(code):
        exec(compile("".join(cell["source"]), f"{file.name}, code cell {k}", "exec"), names)
