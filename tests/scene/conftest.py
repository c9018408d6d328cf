"""Writing scene files for the tests of this folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from standoff.scene import Scene, load_scene

LoadText = Callable[[str], Scene]


@pytest.fixture
def load_text(tmp_path: Path) -> LoadText:
    """Load a scene from its text, beside whatever files the test put into `tmp_path`."""

    def load(text: str) -> Scene:
        file = tmp_path / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return load_scene(file)

    return load
