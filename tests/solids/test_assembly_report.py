"""All pairs of an assembly: answers, verdicts, and the report's page and picture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from on_first_use import OnFirstUse
from standoff.clearance.assembly import AssemblyFile
from standoff.clearance.fits import Fit
from standoff.clearance.page import page_of
from standoff.clearance.picture import pairs_legend, undecided_gap
from standoff.clearance.report import (
    Instants,
    Report,
    Wanted,
    bounds_of,
    nearest_of,
    no_clearance,
    report_on,
)
from standoff.clearance.verdicts import Verdict
from standoff.solids.spatial import distance as spatial_distance_module
from standoff_studies.soak.solid_parts import bolt, plate, ring

PARTS = OnFirstUse(
    {
        "plate": lambda: plate(8.0, 1.0, 1.1).boundary,
        "bolt": lambda: bolt(1.0, 2.0, 3.0, 4.0).boundary,
        "ring": lambda: ring(2.6, 0.4).boundary,
        "ball": lambda: so.shapes.ellipsoid(0.2, 0.2, 0.2),
        "far": lambda: so.shapes.ellipsoid(0.2, 0.3, 0.2),
    }
)
PLACES = {
    name: so.Pose(np.eye(3), place)
    for name, place in {
        "plate": [0.0, 0.0, 1.0],
        "bolt": [0.0, 0.0, -0.5],
        "ring": [0.0, 0.0, 3.0],
        "ball": [3.0, 3.0, 1.5],
        "far": [50.0, 0.0, 0.0],
    }.items()
}
"""A bolt in a plate's hole with 0.1 of play, a ring around it, a ball inside the plate."""


def answered(within: float) -> tuple[so.World, so.world.WorldAnswer]:
    world = so.World(PARTS, within=within)
    return world, world.distances(PLACES)


@pytest.fixture(scope="module")
def found() -> tuple[so.World, so.world.WorldAnswer]:
    return answered(10.0)


def reported(found: tuple[so.World, so.world.WorldAnswer], wanted: Wanted) -> Report:
    world, answer = found
    near = nearest_of(answer, 0.0)
    return report_on(world, near, bounds_of(world, answer, near), wanted)


def test_every_pair_has_its_answer(found: tuple[so.World, so.world.WorldAnswer]) -> None:
    _, answer = found
    assert answer.certified
    assert len(answer.pairs) == 6
    for name in ("plate", "bolt", "ring", "ball"):
        far = answer[name, "far"]
        assert far.status is so.Status.FAR
        assert far.lower_bound > 10.0
    assert answer["plate", "bolt"].distance == pytest.approx(0.1, abs=1e-9)
    assert answer["bolt", "ring"].distance == pytest.approx(0.2, abs=1e-9)
    inside = answer["ball", "plate"]
    assert isinstance(inside, so.world.SolidPairAnswer)
    assert inside.inside == "A"
    assert inside.distance == pytest.approx(0.3, abs=1e-9)
    assert answer.closest is not None
    assert answer.closest.names == ("plate", "ball")


def test_the_report_has_every_verdict(found: tuple[so.World, so.world.WorldAnswer]) -> None:
    report = reported(found, Wanted(0.15, None))
    rows = {row.names: row for row in report.rows}
    inside = rows["plate", "ball"]
    assert inside.verdict is Verdict.CONTAINED
    assert "inside the other's material, the wall at least 0.29999" in inside.failure
    assert rows["plate", "bolt"].verdict is Verdict.APART
    assert "not proven to keep 0.15" in rows["plate", "bolt"].failure
    assert not rows["bolt", "ring"].failure
    assert report.clearance == -np.inf
    assert report.tally()[Verdict.CONTAINED] == 1


def test_a_part_inside_another_is_no_fit_that_is_meant() -> None:
    fits = (Fit("plate", "ball", (-1.0, np.inf), "meant"),)
    report = reported(answered(1.0), Wanted(None, fits))
    (inside,) = [row for row in report.rows if row.verdict is Verdict.CONTAINED]
    assert inside.failure
    assert not report.fits[0].holds


def test_the_page_names_and_draws_the_parts(
    found: tuple[so.World, so.world.WorldAnswer],
) -> None:
    report = reported(found, Wanted(0.05, None))
    file = AssemblyFile(Path("assembly.step"), "A bolt in a plate", "mm", (), PLACES)
    text = page_of(file, report, Instants(0.0, 0.0, 1))
    for part in (
        "CONTAINED",
        "A bolt in a plate",
        "at rest",
        "assembly.step",
        "gap (mm)",
        "data:image/png",
    ):
        assert part in text
    assert "at 0 s" not in text


def test_an_undecided_pair_is_told_as_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pin that fills its hole, where it is not proven that this holds it all round."""
    monkeypatch.setattr(
        spatial_distance_module, "depth_bound", lambda pair, tolerance, depth=0.0: np.inf
    )
    parts = {"plate": plate(8.0, 1.0, 1.0).boundary, "bolt": PARTS["bolt"], "ring": PARTS["ring"]}
    world = so.World(parts, within=10.0)
    answer = world.distances({name: PLACES[name] for name in parts})
    near = nearest_of(answer, 0.0)
    report = report_on(world, near, bounds_of(world, answer, near), Wanted())
    (row,) = [row for row in report.rows if row.verdict is Verdict.UNDECIDED]
    assert row.names == ("plate", "bolt")
    assert report.clearance == -np.inf
    assert no_clearance(report) == "it is not decided whether these meet: plate - bolt"
    labels = [str(handle.get_label()) for handle in pairs_legend(report.rows, "mm")]
    assert labels[0].startswith("1  plate - bolt: undecided, gap at most ")
    assert labels[1].startswith("2  bolt - ring: gap 0.2 mm")
    file = AssemblyFile(Path("assembly.step"), "A pin", "mm", (), PLACES)
    text = page_of(file, report, Instants(0.0, 0.0, 1))
    (tmp_path / "page.html").write_text(text)
    assert (
        "No clearance is proven for all pairs: it is not decided whether these meet: plate - bolt"
        in text
    )
    assert "overlap" not in text.split("</p>")[0].split('class="summary">')[1]


def test_an_undecided_pair_with_bounds_shows_them(
    found: tuple[so.World, so.world.WorldAnswer],
) -> None:
    report = reported(found, Wanted(None, None))
    row = next(row for row in report.rows if row.names == ("plate", "bolt"))
    between = replace(row, nearest=row.nearest._replace(lower_bound=-0.25))
    assert undecided_gap(between, "mm") == "undecided, gap -0.25 to 0.1 mm"
    open_one = replace(between, verdict=Verdict.UNDECIDED)
    both = replace(report, rows=(open_one, *report.rows))
    assert "one is inside another's material; it is not decided whether these meet" in no_clearance(
        both
    )
