"""All pairs of an assembly: answers, verdicts, and the report's page and picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from parts import bolt, plate_with_hole, ring

import standoff as so
from standoff.clearance.assembly import AssemblyFile, assembly_report
from standoff.clearance.fits import Fit
from standoff.clearance.page import page_of
from standoff.clearance.report import Looked, Wanted
from standoff.clearance.verdicts import Verdict
from standoff.errors import StandoffError
from standoff.solids import Arrangement


def at(x: float, y: float, z: float) -> so.Pose:
    return so.Pose(np.eye(3), [x, y, z])


@pytest.fixture(scope="module")
def assembly() -> Arrangement:
    """A bolt in a plate's hole with 0.1 of play, a ring around it, a ball inside the plate."""
    return Arrangement(
        {
            "plate": (plate_with_hole(8.0, 1.0, 1.1), at(0.0, 0.0, 1.0)),
            "bolt": (bolt(1.0, 2.0, 3.0, 4.0), at(0.0, 0.0, -0.5)),
            "ring": (ring(2.6, 0.4), at(0.0, 0.0, 3.0)),
            "ball": (so.shapes.ellipsoid(0.2, 0.2, 0.2), at(3.0, 3.0, 1.5)),
            "far": (so.shapes.ellipsoid(0.2, 0.3, 0.2), at(50.0, 0.0, 0.0)),
        },
        title="A bolt in a plate",
        unit="mm",
    )


def test_every_pair_has_its_answer(assembly: Arrangement) -> None:
    answer = assembly.distances(within=10.0)
    assert answer.certified
    assert len(answer.near) + len(answer.far) == 10
    assert set(answer.far) == {(n, "far") for n in ("plate", "bolt", "ring", "ball")}
    assert all(bound > 10.0 for bound in answer.far.values())
    bolt_in_plate = answer["plate", "bolt"]
    assert bolt_in_plate.distance == pytest.approx(0.1, abs=1e-9)
    assert answer["bolt", "plate"] is bolt_in_plate
    assert answer["bolt", "ring"].distance == pytest.approx(0.2, abs=1e-9)
    assert answer["ball", "plate"].inside == "ball"
    assert answer["ball", "plate"].distance == pytest.approx(0.3, abs=1e-9)


def test_the_report_has_every_verdict(assembly: Arrangement) -> None:
    report = assembly_report(assembly.distances(within=10.0), Wanted(0.15, None))
    found = {row.names: row for row in report.rows}
    inside = found["plate", "ball"]
    assert inside.verdict is Verdict.CONTAINED
    assert "inside the other's material" in inside.failure
    assert found["plate", "bolt"].verdict is Verdict.APART
    assert "not proven to keep 0.15" in found["plate", "bolt"].failure
    assert not found["bolt", "ring"].failure
    assert report.clearance == -np.inf
    assert report.tally()[Verdict.CONTAINED] == 1


def test_a_part_inside_another_is_no_fit_that_is_meant(assembly: Arrangement) -> None:
    fits = (Fit("plate", "ball", 1.0, "meant"),)
    report = assembly_report(assembly.distances(within=1.0), Wanted(None, fits))
    (inside,) = [row for row in report.rows if row.verdict is Verdict.CONTAINED]
    assert inside.failure
    assert not report.fits[0].holds


def test_the_page_names_and_draws_the_parts(assembly: Arrangement) -> None:
    report = assembly_report(assembly.distances(within=10.0), Wanted(0.05, None))
    file = AssemblyFile(Path("assembly.step"), assembly.title, assembly.unit)
    text = page_of(file, report, Looked(0.0, 0.0, 1))  # type: ignore[arg-type]
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


def test_bad_parts_are_refused() -> None:
    with pytest.raises(TypeError, match="mapping"):
        Arrangement([so.shapes.sphere(1.0)])  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match="needs parts"):
        Arrangement({})
    with pytest.raises(TypeError, match="Part 'a' is 3"):
        Arrangement({"a": 3})
    two = Arrangement({"a": so.shapes.sphere(1.0), "b": so.shapes.sphere(2.0)})
    with pytest.raises(StandoffError, match="no part 'c'"):
        two.distance(("a", "c"))
    with pytest.raises(StandoffError, match="within"):
        two.distances(within=-1.0)
