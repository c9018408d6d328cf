"""What holds of every status, also of one that is added: number, advice, pages, recordings."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.kernels.frame import answer
from standoff.kernels.state import arrays
from standoff.motion import Helix

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def recording() -> so.Recording:
    """A short run, one frame a status and more."""
    tracker = so.Tracker(so.shapes.sphere(1.0), so.shapes.sphere(0.1), dt=0.01)
    return so.simulate(tracker, so.Pose.identity(), Helix(2.0, 0.4, 2.0), 0.01 * len(so.Status))


@pytest.mark.parametrize("status", so.Status)
def test_a_status_has_the_kernels_number(status: so.Status) -> None:
    assert getattr(arrays, status.name) == status.value
    # what Python proves by itself needs no kernel
    assert hasattr(answer, status.name) or status is so.Status.OVERLAPPING


@pytest.mark.parametrize("status", so.Status)
def test_a_status_says_what_to_do(status: so.Status) -> None:
    assert re.fullmatch(r"[A-Z].{40,}\.", status.advice)


@pytest.mark.parametrize("status", so.Status)
def test_a_status_is_on_the_pages(status: so.Status) -> None:
    row = rf"^\| `{status.name}` \| .+ \| .+ \| .+ \|$"
    assert re.search(row, (DOCS / "answers.md").read_text("utf-8"), re.MULTILINE)
    (column,) = re.findall(
        r"^\| `status` \| string .*", (DOCS / "scene-format.md").read_text("utf-8"), re.MULTILINE
    )
    assert f"`{status.name}`" in column


def test_every_status_is_kept_in_a_file(recording: so.Recording, tmp_path: Path) -> None:
    statuses = np.array(so.Status, dtype=object)
    changed = replace(recording, status=np.resize(statuses, len(recording)))
    changed.save(tmp_path / "run.parquet")
    again = so.open_recording(tmp_path / "run.parquet")
    assert again.status.tolist() == changed.status.tolist()
    assert again.certified.tolist() == [s.certified for s in changed.status]
    assert again.penetrating.tolist() == [s.penetrating for s in changed.status]
    assert again.status_frames().keys() == set(so.Status)
