"""A solid in a cavity of another, or in a hole of a planar one, is told to be there."""

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import ball, peg, socket, tube
from standoff.geometry import ConicArc
from standoff.tracking.status import Status

STILL = so.Pose.identity()
SHELL = socket(0.5, 0.8)


def at(*shift: float) -> so.Pose:
    return so.Pose(np.eye(3), shift)


def ring() -> so.PlanarSolid:
    hole = [ConicArc((0, 0), (0.5, 0), (0, 0.5))]
    return so.PlanarSolid.from_loops([ConicArc((0, 0), (1, 0), (0, 1))], [hole])


def disc(radius: float) -> so.PlanarSolid:
    return so.PlanarSolid.from_loops([ConicArc((0, 0), (radius, 0), (0, radius))])


@pytest.mark.parametrize("shift", [0.0, 0.1, 0.19])
def test_in_a_cavity(shift) -> None:
    answer = so.distance(SHELL, ball(0.3), STILL, at(shift, 0, 0))
    assert answer.status in (Status.CONVERGED, Status.CONTINUUM)
    assert (answer.cavity, answer.inside) == ("B", "")
    assert answer.distance == pytest.approx(0.2 - shift, abs=1e-12)
    assert so.distance(ball(0.3), SHELL, at(shift, 0, 0), STILL).cavity == "A"
    assert answer.as_dict()["cavity"] == "B"


def test_in_the_material_or_outside_it_is_in_no_cavity() -> None:
    walled = so.distance(SHELL, ball(0.05), STILL, at(0.65, 0, 0))
    assert (walled.status, walled.inside, walled.cavity) == (Status.CONTAINED, "B", "")
    assert so.distance(SHELL, ball(0.3), STILL, at(2, 0, 0)).cavity == ""
    overlapping = so.distance(SHELL, ball(0.3), STILL, at(0.3, 0, 0))
    assert (overlapping.status, overlapping.cavity) == (Status.OVERLAPPING, "")


def test_a_hole_that_goes_through_is_no_cavity() -> None:
    assert so.distance(tube(0.5, 0.8, -0.6, 0.6), peg(0.45, -0.7, 0.7), STILL, STILL).cavity == ""


def test_in_the_plane_a_hole_is_one() -> None:
    assert so.distance(ring(), disc(0.3), STILL, at(0.1, 0, 0)).cavity == "B"
    assert so.distance(disc(0.3), ring(), at(0.1, 0, 0), STILL).cavity == "A"
    assert so.distance(ring(), disc(0.3), STILL, at(2, 0, 0)).cavity == ""
    walled = so.distance(ring(), disc(0.05), STILL, at(0.75, 0, 0))
    assert (walled.status, walled.cavity) == (Status.CONTAINED, "")


def test_worlds_and_trackers_tell_it() -> None:
    bodies = {"ball": ball(0.3), "shell": SHELL}
    answer = so.World(bodies, within=1.0).distances({"ball": at(0.1, 0, 0), "shell": STILL})
    assert answer["ball", "shell"].cavity == "A"
    assert answer["shell", "ball"].cavity == "B"
    tracked = so.Tracker(SHELL, ball(0.3)).start(STILL, at(0.1, 0, 0))
    assert tracked.proximity.cavity == "B"
