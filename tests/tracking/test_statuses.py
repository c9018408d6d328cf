"""What holds of every status, also of one that is added: number, advice, pages, recordings."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.kernels.entries import frames
from standoff.kernels.frame import answer
from standoff.kernels.state import arrays
from standoff.motion import Helix
from standoff.tracking.status import OF_SOLIDS

DOCS = Path(__file__).parents[2] / "docs"
ANSWERED = [s for s in so.Status if s is not so.Status.REFUSED and s not in OF_SOLIDS]
"""Those of frames; the others are of rows that no kernel answers, and of solids."""


@pytest.fixture(scope="module")
def recording() -> so.Recording:
    """A short run, one frame a status and more."""
    tracker = so.Tracker(so.shapes.sphere(1.0), so.shapes.sphere(0.1), dt=0.01)
    return so.track(tracker, so.Pose.identity(), Helix(2.0, 0.4, 2.0), 0.01 * len(so.Status))


@pytest.mark.parametrize("status", ANSWERED)
def test_a_status_has_the_kernels_number(status: so.Status) -> None:
    assert getattr(arrays, status.name) == status.value
    assert hasattr(frames if status is so.Status.FAR else answer, status.name)


@pytest.mark.parametrize("status", so.Status)
def test_a_status_says_what_to_do(status: so.Status) -> None:
    assert re.fullmatch(r"[A-Z].{40,}\.", status.advice)


@pytest.mark.parametrize("status", so.Status)
def test_a_status_is_on_the_pages(status: so.Status) -> None:
    row = rf"^\| `{status.name}` \| .+ \| .+ \| .+ \|$"
    assert re.search(row, (DOCS / "answers.md").read_text("utf-8"), re.MULTILINE)
    if status not in ANSWERED:
        return
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


def test_statuses_can_be_counted() -> None:
    lens, tool = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.3, 0.2)
    poses = np.tile(np.eye(4), (6, 1, 1))
    poses[:, 0, 3] = 3.0, 2.5, 2.0, 0.2, 0.1, 0.0
    poses[1:3, 0, 0] = np.nan
    tracker = so.Tracker(lens, tool)
    _, answers = tracker.run(tracker.start(np.eye(4), poses[0]), np.eye(4), poses[[0, 3, 4]])
    found = so.distances(lens, tool, np.eye(4), poses)
    for status, expected in (
        (answers.status, {so.Status.CONVERGED: 1, so.Status.GLOBAL: 2}),
        (found.status, {so.Status.CONVERGED: 1, so.Status.GLOBAL: 3, so.Status.REFUSED: 2}),
    ):
        kinds, counts = np.unique(status, return_counts=True)
        assert dict(zip(kinds, counts.tolist(), strict=True)) == expected
        assert Counter(status.tolist()) == expected
    assert np.unique(found.derivatives().smoothness).size >= 2
    with pytest.raises(TypeError):
        so.Status.CONVERGED < 3  # noqa: B015


def test_pandas_counts_them() -> None:
    pandas = pytest.importorskip("pandas")
    column = pandas.Series([so.Status.CONVERGED, so.Status.REFUSED, so.Status.CONVERGED])
    assert column.value_counts().to_dict() == {so.Status.CONVERGED: 2, so.Status.REFUSED: 1}
