"""Where a solid's boundary meets itself: solids that cross themselves by what they are made of, and
near misses and healthy ones that must not be told."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from draws import draws
from families import crossing_solids as made
from families.solid_shapes import egg
from shares import only
from standoff.bodies import Boundary
from standoff.errors import StandoffError
from standoff.geometry import Plane
from standoff.kernels.solids import spatial_self as K
from standoff.solids import SelfIntersections, Solid
from standoff.solids.spatial import self_intersections as si
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.own_pairs import OwnPairs, one_to_one
from standoff_studies.soak.solid_parts import MAKERS, bolt, elbow


def crossings(boundary: Boundary) -> SelfIntersections:
    """What is found of a boundary that is refused."""
    with pytest.raises(StandoffError, match="crosses itself: face") as raised:
        Solid(boundary)
    assert isinstance(raised.value.value, SelfIntersections)
    found = raised.value.value
    assert found.crossings
    for place in found.places:
        assert np.linalg.norm(place.point_a - place.point_b) == pytest.approx(place.gap, abs=1e-14)
        assert place.gap <= found.tolerance
    return found


def faces(found: SelfIntersections) -> set[tuple[int, int]]:
    return {(p.feature_a.index, p.feature_b.index) for p in found.crossings}


@pytest.mark.parametrize("past", only([1e-6, 0.2], [1e-6, 1e-3, 0.2]))
def test_a_pocket_deeper_than_its_box(past: float) -> None:
    found = crossings(made.pocket(1.0 + past))
    assert faces(found) == {(0, k) for k in (7, 8, 9, 10)}
    for place in found.crossings:
        assert abs(place.point_a[2]) < 1e-12
        assert np.abs(place.point_a[:2]).max() == pytest.approx(0.4, abs=1e-12)
        assert place.depth == pytest.approx(past, rel=0.02)


@pytest.mark.parametrize("past", [-1e-3, -1e-6])
def test_a_pocket_nearly_as_deep_as_its_box_is_proven_not_to_meet_it(past: float) -> None:
    assert Solid(made.pocket(1.0 + past)).self_intersections.proven_none


def test_a_pocket_as_deep_as_its_box_touches_it() -> None:
    found = Solid(made.pocket(1.0)).self_intersections
    assert found.places
    assert not found.crossings
    assert not found.none_outside_joints
    assert (0, 6) in {(p.feature_a.index, p.feature_b.index) for p in found.places}
    assert "face 0 meets face 6" in "; ".join(found.lines())


@pytest.mark.parametrize(
    ("beside", "undecided", "lines"),
    [
        (0, 0, [si.NONE_PROVEN]),
        (3, 0, [si.NONE_OUTSIDE]),
        (0, 1, [si.NONE_FOUND, "undecided: 1 pair of pieces of faces, which may or may not meet"]),
        (2, 5, [si.NONE_FOUND, "undecided: 5 pairs of pieces of faces, which may or may not meet"]),
    ],
)
def test_what_is_proven_and_what_is_not_are_told_in_different_words(
    beside: int, undecided: int, lines: list[str]
) -> None:
    found = si.SelfIntersections((), 1e-9, 10, beside, undecided)
    assert found.lines() == lines
    # no sentence is another one with its words in another order
    words = [sorted(text.split()) for text in (si.NONE_PROVEN, si.NONE_OUTSIDE, si.NONE_FOUND)]
    assert len({tuple(each) for each in words}) == 3


@settings(max_examples=draws(4), deadline=None)
@given(x=st.floats(0.0, 0.9), y=st.floats(0.0, 0.9), half=st.floats(0.05, 0.6))
def test_a_cavity_is_refused_where_it_pokes_through(x: float, y: float, half: float) -> None:
    past = max(abs(x), abs(y)) + half - 1.0
    if abs(past) < 1e-6 or 2.0 * half - past < 0.05:
        return
    boundary = made.cavity((x, y), half)
    if past < 0.0:
        assert Solid(boundary).self_intersections.proven_none
        return
    for place in crossings(boundary).crossings:
        assert place.feature_a.index in range(6)
        assert place.feature_b.index in range(6, 12)
        assert np.abs(place.point_a[:2]).max() == pytest.approx(1.0, abs=1e-9)
        assert np.abs(place.point_b[:2] - [x, y]).max() <= half + 1e-9


@pytest.mark.parametrize("past", [pytest.param(1e-5, marks=pytest.mark.soak), 0.3])
def test_legs_of_a_bent_rod_that_cross(past: float) -> None:
    found = crossings(made.hook(0.3 + past))
    deepest = found.crossings[0]
    assert deepest.depth == pytest.approx(past, rel=0.02)
    assert deepest.point_a == pytest.approx([0.3, -0.3, 0.0], abs=1e-9)


@pytest.mark.parametrize("short", [pytest.param(1e-3, marks=pytest.mark.soak), 1e-6])
def test_legs_of_a_bent_rod_that_nearly_cross(short: float) -> None:
    found = Solid(made.hook(0.3 - short)).self_intersections
    assert not found.places
    assert not found.proven_none  # halves of one cylinder, beside their common edges


@pytest.mark.soak
def test_a_bent_tube_whose_ends_cross() -> None:
    found = crossings(made.looped_tube(0.05))
    for place in found.crossings:
        assert np.linalg.norm(place.point_a - [0.5, 0.38, 0.075]) < 0.3


@pytest.mark.soak
def test_a_bent_tube_whose_ends_pass_each_other() -> None:
    assert not Solid(made.looped_tube(0.3)).self_intersections.places


@pytest.mark.parametrize("dent", only([1.52], [1.52, 3.0]))
def test_neighbours_that_cross_away_from_their_common_edge(dent: float) -> None:
    found = crossings(made.dented_wedge(dent))
    assert faces(found) == {(0, 1)}
    x, y, z = found.crossings[0].point_a
    assert abs(z) < 1e-9
    assert made.wedge_top(x, y, dent) == pytest.approx(0.0, abs=1e-9)
    assert x > 0.1
    assert 1e-4 < found.crossings[0].depth < 1.0


@pytest.mark.parametrize("spare", only([1e-6], [1e-3, 1e-6]))
def test_neighbours_that_nearly_touch(spare: float) -> None:
    assert not Solid(made.dented_wedge(1.5 - spare)).self_intersections.places


def test_turned_neighbours_that_cross_in_a_circle() -> None:
    found = crossings(made.goblet(0.9))
    for place in found.crossings:
        across = float(np.hypot(*place.point_a[:2]))
        assert (across, place.point_a[2]) == pytest.approx((0.86, 0.98), abs=1e-9)


@pytest.mark.soak
def test_a_turned_profile_with_a_loop() -> None:
    pull = 0.5
    share = 0.4 / (0.4 + 3.0 * pull)
    for place in crossings(made.crossing_profile(pull)).crossings:
        across = float(np.hypot(*place.point_a[:2]))
        assert (across, place.point_a[2]) == pytest.approx((1.0, 3.6 * share), abs=1e-9)


QUICK = ("bolt", "plate", "bracket", "hollow", "wedge", "egg")
"""Of the study's solids, those that take a second to make."""


@pytest.mark.parametrize(
    "name",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.soak) for name in MAKERS],
)
def test_no_solid_of_the_study_meets_itself(name: str) -> None:
    found = Solid(MAKERS[name]().boundary).self_intersections
    assert not found.places
    leaves = found.apart + found.beside + found.undecided
    assert found.undecided <= 0.002 * leaves
    if name in ("bolt", "pin", "plate", "bracket", "channel", "hollow", "brick", "wedge", "drum"):
        assert found.proven_none


@settings(max_examples=draws(4), deadline=None)
@given(
    shank=st.floats(0.05, 0.4), wider=st.floats(1e-3, 0.5), under=st.floats(0.05, 1.0),
    head=st.floats(1e-3, 1.0),
)  # fmt: skip
def test_no_bolt_meets_itself(shank: float, wider: float, under: float, head: float) -> None:
    """Close to the joints of some it is not proven."""
    boundary = bolt(shank, shank + wider, under, under + head).boundary
    assert Solid(boundary).self_intersections.none_outside_joints


@pytest.mark.soak
@pytest.mark.parametrize("wall", [1e-3, 1e-6])
def test_no_thin_pipe_meets_itself(wall: float) -> None:
    assert not Solid(elbow(0.5, 0.2, 0.2 + wall, 0.3).boundary).self_intersections.places


def test_where_a_patch_is_one_to_one() -> None:
    grid = np.linspace(0.0, 1.0, 4)
    net = np.array([[[x, y, 0.1 * x * y] for y in grid] for x in grid])
    whole, half = np.array([[0.0, 1.0, 0.0, 1.0]]), np.array([[0.0, 0.5, 0.0, 1.0]])
    assert one_to_one(made.bezier(net), whole).tolist() == [True]
    net[1, :, 0], net[2, :, 0] = 2.0, -1.0  # it turns back, and back again
    assert one_to_one(made.bezier(net), whole).tolist() == [False]
    assert one_to_one(made.bezier(net), half).tolist() == [False]
    assert one_to_one(Plane.through(np.zeros(3), *np.eye(3)[:2]), whole).tolist() == [True]


def told(make: Callable[[], Boundary]) -> str:
    with pytest.raises(StandoffError) as raised:
        Solid(make())
    return str(raised.value)


def test_the_error_names_both_faces_the_place_and_the_fix() -> None:
    message = told(lambda: made.cavity((0.7, 0.0), 0.5))
    assert "crosses itself: face 3 crosses face" in message
    assert "near (1, " in message
    assert "by about 0.2" in message or "by about 0.19" in message
    assert "Move or trim one of the faces" in message


def test_neighbours_on_a_face_do_not_meet() -> None:
    """Points of one face that are near, with a short way along it between them or a long one."""
    solid = egg(1.0, 0.7, 0.5)
    leaf = next(k for k, one in enumerate(solid.leaves) if one.dim == 2)
    u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
    u, v = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    near, far = 1e-4 * (u1 - u0), 0.4 * (u1 - u0)
    group = OwnPairs((0, 0), np.array([[leaf, leaf]] * 3), np.zeros((0, 4)))
    rows = np.array(
        [[K.MET, 0.0, u, v, u + near, v], [K.MET, 0.0, u, v, u + far, v], [K.APART, 0, u, v, u, v]]
    )
    step = np.linalg.norm(
        leaf_jet_of(solid.packed, leaf, u + near, v)[0] - leaf_jet_of(solid.packed, leaf, u, v)[0]
    )
    told = si._neighbours(solid, group, rows, 2.0 * step)
    assert told.tolist() == [True, False, False]


@pytest.mark.parametrize("share", [1e-9, 0.4])
def test_what_became_of_points_of_one_face(share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neighbours are undecided; others meet."""
    solid = egg(1.0, 0.7, 0.5)
    leaf = next(k for k, one in enumerate(solid.leaves) if one.dim == 2)
    u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
    u, v = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    group = OwnPairs((0, 0), np.array([[leaf, leaf]]), np.zeros((0, 4)))
    row = np.array([[K.MET, 0.0, u, v, u + share * (u1 - u0), v]])
    monkeypatch.setattr(si, "own_pairs", lambda solid, within: ([group], 0))
    monkeypatch.setattr(si, "_looked_at", lambda *given: row.copy())
    found = si.self_intersections(solid)
    assert (found.undecided, len(found.places)) == ((1, 0) if share < 1e-6 else (0, 1))
