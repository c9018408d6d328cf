"""Worlds and compounds with solids that need not be convex: closed forms, and each pair alone."""

from __future__ import annotations

import pickle
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ball, peg, socket, tube
from standoff.geometry import ConicArc, Line
from standoff.motion import ConstantTwist
from standoff.solids import OpenPair, Overlap, PlanarSolid, SolidProximity
from standoff.solids.of_pieces import OfPieces, answer_of_pieces, turned
from standoff.tracking.derivatives import Smoothness
from standoff.world import SolidPairAnswer

EYE = np.eye(3)


def rot(vector: np.ndarray) -> np.ndarray:
    """By a rotation vector, radians."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


WITHIN = 2e-9
"""To what distances of order 1 are proven, length."""


def at(x: float, y: float = 0.0, z: float = 0.0, turn: np.ndarray | None = None) -> so.Pose:
    return so.Pose(EYE if turn is None else turn, [x, y, z])


def close(answer: SolidProximity, distance: float) -> None:
    assert answer.certified
    assert answer.distance == pytest.approx(distance, abs=WITHIN)
    assert distance - WITHIN <= answer.lower_bound <= distance + 1e-14
    assert distance - 1e-14 <= answer.upper_bound <= distance + WITHIN


RING = tube(1.0, 1.5, -0.5, 0.5)
PEG = peg(0.9, -3.0, 3.0)
RINGS = so.compound({"low": (RING, at(0.0, 0.0, -1.0)), "high": (RING, at(0.0, 0.0, 1.0))})


def test_two_rings_around_a_peg_are_as_near_as_one() -> None:
    found = so.distance(RINGS, PEG, at(0.0), at(0.03, 0.04))
    assert type(found) is SolidProximity
    close(found, 0.05)
    assert found.status is so.Status.CONTINUUM
    assert {pair.pieces for pair in found.minima} == {("low", ""), ("high", "")}
    alone = so.distance(RING, PEG, at(0.0, 0.0, 1.0), at(0.03, 0.04))
    assert found.distance == pytest.approx(alone.distance, abs=1e-12)
    # ... and from the other side
    back = so.distance(PEG, RINGS, at(0.03, 0.04), at(0.0))
    assert back.distance == pytest.approx(found.distance, abs=1e-12)
    assert back.pieces[0] == ""
    np.testing.assert_allclose(back.normal, -found.normal, atol=1e-9)


def test_a_tilted_peg_is_nearest_to_one_ring() -> None:
    # about y through the upper ring's middle: the lower ring is nearer
    turn = rot(np.array([0.0, 0.01, 0.0]))
    found = so.distance(
        RINGS, PEG, at(0.0), so.Pose(turn, np.array([0, 0, 1.0]) - turn @ [0, 0, 1.0])
    )
    each = [
        so.distance(
            RING, PEG, at(0.0, 0.0, z), so.Pose(turn, np.array([0, 0, 1.0]) - turn @ [0, 0, 1.0])
        )
        for z in (-1.0, 1.0)
    ]
    assert found.pieces == ("low", "")
    assert found.distance == pytest.approx(min(x.distance for x in each), abs=1e-12)
    assert found.lower_bound <= min(x.lower_bound for x in each) + 1e-13


SOCKET, BALL = socket(1.0, 1.3), ball(0.4)


def test_balls_in_sockets_as_they_move() -> None:
    """Each ball has one socket: 0.6 less its way from the middle; the others' are beyond it."""
    names = [f"ball{k}" for k in range(3)]
    world = so.World(
        {**{f"socket{k}": SOCKET for k in range(3)}, **dict.fromkeys(names, BALL)},
        fixed={f"socket{k}": at(4.0 * k) for k in range(3)},
        within=1.0,
    )
    ways = [np.array([0.3, 0.1, 0.0]), np.array([0.0, 0.0, 0.5]), np.zeros(3)]

    def places(time: float) -> list[so.Pose]:
        return [at(*(4.0 * k * EYE[0] + time * way)) for k, way in enumerate(ways)]

    state = world.start(places(0.0))
    for time in (0.0, 0.25, 0.5, 1.0):
        state, answer = world.step(state, places(time), dt=0.1)
        assert len(answer.pairs) == 3
        assert answer.certified
        least = np.inf
        for k, way in enumerate(ways):
            found = answer[f"socket{k}", names[k]]
            assert isinstance(found, SolidPairAnswer)
            gap = 0.6 - time * float(np.linalg.norm(way))
            assert found.lower_bound - 1e-14 <= gap <= found.upper_bound + 1e-14
            assert found.distance == pytest.approx(gap, abs=WITHIN)
            least = min(least, gap)
        assert answer.clearance == pytest.approx(least, abs=WITHIN)
        assert answer.clearance <= least + 1e-14
        assert answer["socket0", "ball1"].status is so.Status.FAR
        assert answer["ball1", "ball0"].lower_bound >= 1.0
    # the ball that rests was not asked again
    assert answer.counts.started == 2
    assert answer.counts.resting == 1
    # in the middle all directions are as near: no gradient
    with pytest.raises(so.StandoffError, match="no gradient"):
        _ = answer["socket2", "ball2"].gradient


def test_every_pair_as_it_is_alone(rng: np.random.Generator) -> None:
    bodies = {
        "rings": RINGS,
        "peg": peg(0.9, -1.0, 1.0),
        "socket": SOCKET,
        "box": so.shapes.box((0.5, 0.8, 1.1)),
        "egg": so.shapes.ellipsoid((0.4, 0.6, 0.3)),
    }
    world = so.World(bodies, within=1.5)
    state = None
    seen = set()
    for _ in range(2):
        poses = {
            name: so.Pose(rot(rng.normal(size=3)), rng.uniform(-2.2, 2.2, 3)) for name in bodies
        }
        if state is None:
            state = world.start(poses)
        state, answer = world.step(state, poses)
        least = np.inf
        for a, b in world.pairs():
            found = answer[a, b]
            alone = so.distance(bodies[a], bodies[b], poses[a], poses[b])
            seen.add(found.status.name)
            if found.status is so.Status.FAR:
                assert alone.lower_bound >= found.lower_bound - 1e-12
                continue
            assert found.distance == pytest.approx(alone.distance, abs=1e-8)
            back = answer[b, a]
            assert back.distance == found.distance
            np.testing.assert_array_equal(back.normal, -found.normal)
            np.testing.assert_array_equal(back.point_a, found.point_b)
            assert back.feature_b == found.feature_a
            assert back.pieces == found.pieces[::-1]
            if isinstance(alone, SolidProximity):
                assert found.status is alone.status
                least = min(least, found.lower_bound)
        assert answer.clearance <= least
    assert {"FAR", "CONVERGED"} <= seen


def test_how_the_statuses_of_pieces_are_combined() -> None:
    block = so.shapes.box((2.0, 2.0, 2.0))
    blocks = so.compound({"left": block, "right": (block, at(3.0))})
    bead = so.shapes.ellipsoid((0.2, 0.2, 0.2))
    beads = so.compound({"one": ball(0.2), "two": (bead, at(1.0))})

    # each bead in a block of its own: contained, the wall the thinner one's
    found = so.distance(blocks, beads, at(0.0), at(0.7))  # beads at 0.7 and 1.7
    assert found.status is so.Status.OVERLAPPING  # the second one is between the blocks
    found = so.distance(
        blocks, so.compound({"one": ball(0.2), "two": (bead, at(3.0))}), at(0), at(0.5)
    )
    assert found.status is so.Status.CONTAINED
    assert found.inside == "B"
    close(found, 0.3)
    # of blocks that overlap the wall is that in the one that is thicker there
    thick = so.compound({"left": block, "right": (block, at(0.5))})
    found = so.distance(thick, so.compound({"one": BALL, "two": ball(0.2)}), at(0.0), at(0.5))
    assert found.pieces == ("right", "one")
    close(found, 0.6)
    turned = so.distance(
        so.compound({"one": ball(0.2), "two": (bead, at(3.0))}), blocks, at(0.5), at(0)
    )
    assert turned.inside == "A"

    # one inside a block, one in the open: they overlap, by at least the first one's ball
    found = so.distance(beads, block, at(0.0, 0.0, 0.2), at(-0.5))
    assert found.status is so.Status.OVERLAPPING
    assert found.overlap is not None
    assert 0.15 <= found.overlap.radius <= 0.2
    assert found.distance == -2.0 * found.overlap.radius
    depth = 0.2 - np.linalg.norm(found.overlap.common_point - [0.0, 0.0, 0.2])
    assert found.overlap.radius <= depth + 1e-12
    assert found.inside == ""
    assert not found.certified

    # overlap wins over contact, contact over a gap
    found = so.distance(beads, block, at(0.0), at(1.0))
    assert found.status is so.Status.OVERLAPPING
    found = so.distance(beads, block, at(0.0), at(2.2))
    assert found.status is so.Status.TOUCHING
    assert found.pieces == ("two", "")
    close(so.distance(beads, block, at(0.0), at(2.7)), 0.5)


def test_an_open_pair_that_may_be_nearer_leaves_the_whole_open() -> None:
    near = so.distance(BALL, SOCKET, at(0.0), at(1.8))
    far = so.distance(BALL, SOCKET, at(0.0), at(2.0))
    left = OpenPair(-0.5, near.feature_a, near.feature_b, np.zeros((8, 3)), np.ones((8, 3)))
    open_ = replace(far, status=so.Status.WITHIN, lower_bound=-0.5, open=(left,))

    def whole(*found: SolidProximity) -> SolidProximity:
        parts = [
            OfPieces(0, k, ("", name), each, (BALL, SOCKET))
            for k, (name, each) in enumerate(zip(("one", "two"), found, strict=True))
        ]

        def none(part: OfPieces) -> Overlap:
            raise AssertionError(part)

        return answer_of_pieces(parts, (1, 2), np.inf, none)

    found = whole(near, open_)
    assert found.status is so.Status.WITHIN
    assert found.pieces == ("", "one")
    assert (found.lower_bound, found.upper_bound) == (-0.5, near.upper_bound)
    assert found.open == (left,)
    with pytest.raises(so.StandoffError, match="no gradient"):
        _ = found.gradient
    # one whose bound is above it leaves nothing open
    assert whole(near, replace(open_, lower_bound=0.15)).status is near.status
    back = turned(found)
    assert back.open[0].feature_a == left.feature_b
    np.testing.assert_array_equal(back.open[0].corners_a, left.corners_b)


def test_all_minima_of_several_pieces_are_kept() -> None:
    turn = rot(np.array([0.0, 0.0, 0.4]))
    world = so.World({"rings": RINGS, "peg": PEG}, minima=1.0)
    answer = world.distances({"rings": at(0.0), "peg": so.Pose(turn, [0.03, 0.04, 0.0])})
    found = answer.minima(("peg", "rings"))
    assert [each.pieces[1] for each in found] in (["low", "high"], ["high", "low"])
    assert [each.distance for each in found] == pytest.approx([0.05, 0.05], abs=WITHIN)
    for each in found:
        assert isinstance(each, SolidPairAnswer)
        assert all(pair.pieces == each.pieces for pair in each.minima)
        np.testing.assert_allclose(each.poses[0][9:], [0.03, 0.04, 0.0])
    assert answer.minima(("rings", "peg"), below=0.01) == ()


def test_a_world_tells_the_worst_first() -> None:
    world = so.World(
        {"plate": tube(1.0, 3.0, -1.0, 1.0), "pin": peg(0.9, -2.0, 2.0), "bead": ball(0.2)},
        margins={("pin", "plate"): 0.2, ("bead", "plate"): 0.1},
        fixed={"plate": at(0.0)},
    )
    answer = world.distances({"pin": at(0.0), "bead": at(2.0)})
    assert answer.closest is not None
    assert answer.closest.names == ("plate", "bead")
    assert answer.clearance == -np.inf
    assert [x.names for x in answer.below_margin] == [("plate", "pin"), ("plate", "bead")]
    wall = answer["bead", "plate"]
    assert wall.distance == pytest.approx(0.8, abs=WITHIN)
    assert answer.pairs.lower_bound[1] == pytest.approx(0.8, abs=WITHIN)
    assert answer.pairs.order[1] == -np.inf
    assert [x.name for x in answer.pairs.status][1:] == ["CONTAINED", "CONVERGED"]
    told = wall.as_dict()
    assert list(told["names"]) == ["bead", "plate"]
    assert "bodies" not in told


def test_gradients_and_rates_are_by_the_motion_of_the_bodies() -> None:
    turn = rot(np.array([0.3, -0.2, 0.5]))
    hand = so.compound(
        {"palm": (SOCKET, at(0.0, 2.0)), "tip": (ball(0.3), at(2.0, 0.5, 0.2, turn))}
    )
    egg = so.shapes.ellipsoid((0.3, 0.5, 0.4))
    world = so.World({"hand": hand, "egg": egg})
    poses = {"hand": so.Pose(turn, [0.1, 0.2, 0.3]), "egg": so.Pose(turn.T, [2.5, 2.0, 1.0])}
    twists = {
        "hand": so.Twist([0.1, -0.2, 0.3], [0.4, 0.1, -0.3]),
        "egg": so.Twist([0, 1, 0], [1, 0, 0]),
    }
    state = world.start(poses, twists)
    found = world.answer(state)["hand", "egg"]
    assert found.pieces == ("tip", "")
    flat = np.concatenate([[0.1, -0.2, 0.3, 0.4, 0.1, -0.3], [0, 1, 0, 1, 0, 0]])
    rate = float(world.answer(state).pairs.rate[0])
    assert rate == pytest.approx(float(found.gradient @ flat), abs=1e-12)
    h = 1e-4
    ends = []
    for sign in (1.0, -1.0):
        moved = {}
        for name, twist in twists.items():
            w = rot(sign * h * np.asarray(twist.omega))
            pose = poses[name]
            moved[name] = so.Pose(
                w @ pose.rotation, pose.translation + sign * h * np.asarray(twist.v)
            )
        ends.append(world.distances(moved)["hand", "egg"].distance)
    assert (ends[0] - ends[1]) / (2.0 * h) == pytest.approx(rate, abs=1e-5)
    assert found.poses[0][9:] == pytest.approx([0.1, 0.2, 0.3])


def test_states_go_on_are_stored_and_carried() -> None:
    world = so.World({"socket": SOCKET, "ball": BALL, "box": so.shapes.box((0.1, 0.1, 0.1))})
    poses = {"socket": at(0.0), "ball": at(0.1), "box": at(0.0, 0.0, 0.8)}
    state = world.start(poses)
    again = pickle.loads(pickle.dumps(state))
    assert world.answer(again)["ball", "socket"].distance == pytest.approx(0.5, abs=WITHIN)
    other, answer = world.step(state, poses)
    assert answer.counts.started == 0
    after = world.changed(remove=["box"])
    new = after.start_from(world, other)
    assert after.answer(new)["socket", "ball"].distance == pytest.approx(0.5, abs=WITHIN)
    assert (new.counts.started, new.counts.resting) == (0, 1)
    # the pair that a narrower horizon left out is asked, and the one that was near is not
    near = world.changed(within=0.45)
    first = near.start(poses)
    assert first.counts.started == 2
    wider = world.start_from(near, first)
    assert (wider.counts.started, wider.counts.resting) == (1, 2)
    for pair in (("socket", "ball"), ("socket", "box"), ("ball", "box")):
        one, other = world.answer(wider)[pair], world.answer(state)[pair]
        assert (one.distance, one.lower_bound) == (other.distance, other.lower_bound)
    for name in ("distance", "lower_bound", "upper_bound"):
        one = getattr(world.answer(state)["socket", "ball"], name)
        assert one == getattr(answer["socket", "ball"], name)
    assert {field.name for field in fields(SolidPairAnswer)} > {"names", "bodies", "time"}


def test_planar_solids_in_a_planar_world() -> None:
    """A pin in a slot beside a convex disc: half the slot's width less the pin's radius."""
    slot = PlanarSolid.from_loops(
        [
            Line([-3, -2, 0], [3, -2, 0]),
            Line([3, -2, 0], [3, 2, 0]),
            Line([3, 2, 0], [-3, 2, 0]),
            Line([-3, 2, 0], [-3, -2, 0]),
        ],
        [
            [
                Line([-2, -1, 0], [2, -1, 0]),
                Line([2, -1, 0], [2, 1, 0]),
                Line([2, 1, 0], [-2, 1, 0]),
                Line([-2, 1, 0], [-2, -1, 0]),
            ]
        ],
    )
    pin = PlanarSolid.from_loops([ConicArc([0, 0, 0], [0.7, 0, 0], [0, 0.7, 0])])
    disc = so.shapes.planar_loop([ConicArc([0, 0, 0], [0.5, 0, 0], [0, 0.5, 0])])
    world = so.World({"slot": slot, "pin": pin, "disc": disc}, within=1.0, fixed={"slot": at(0.0)})
    answer = world.distances({"pin": at(0.4, 0.1), "disc": at(3.6)})
    assert answer["slot", "pin"].distance == pytest.approx(0.2, abs=WITHIN)
    assert answer["slot", "disc"].distance == pytest.approx(0.1, abs=WITHIN)
    assert answer["pin", "disc"].status is so.Status.FAR
    assert world.dimension == 2


def test_every_convex_body_may_be_beside_a_solid() -> None:
    """A socket on the ground, a ball in it, a capsule beside it, a point and a rounded box above
    it, as bodies and as pieces of compounds."""
    bodies = {
        "socket": SOCKET,
        "ground": so.shapes.halfspace(),
        "ball": so.shapes.sphere(0.4),
        "rod": so.shapes.capsule(0.2, 1.0),
        "tip": so.shapes.point(),
        "block": so.shapes.box((1.0, 1.0, 1.0), rounding=0.1),
    }
    places = {
        "socket": at(0.0, 0.0, 1.8),
        "ground": at(7.0, -3.0),
        "ball": at(0.1, 0.0, 1.8),
        "rod": at(2.0, 0.0, 1.8),
        "tip": at(0.0, 0.0, 4.0),
        "block": at(0.0, 2.5, 1.8),
    }
    near = {
        ("socket", "ground"): 0.5,
        ("socket", "ball"): 0.5,
        ("socket", "rod"): 0.5,
        ("socket", "tip"): 0.9,
        ("socket", "block"): 0.7,
    }
    world = so.World(bodies, fixed={"ground": places.pop("ground")}, within=1.5)
    answer = world.distances(places)
    for names, gap in near.items():
        close(answer[names], gap)
    # convex pairs are answered as before
    assert answer["rod", "ground"].distance == pytest.approx(1.1)
    whole = so.compound({name: bodies[name] for name in ("ball", "rod")})
    found = so.distance(SOCKET, whole, at(0.0), at(2.0))
    close(found, 0.3)
    assert found.pieces == ("", "ball")
    far = so.distance(so.compound({"a": SOCKET, "b": BALL}), bodies["ground"], at(0, 0, 5.0), at(0))
    close(far, 3.7)
    # the other one's box is as low, but it is not as near
    tilted = so.Pose(rot(np.array([0.5, 0.4, 0.3])), [4.0, 0.0, 5e-3])
    pair = so.compound({"a": (SOCKET, at(0.0)), "b": (SOCKET, tilted)})
    found = so.distance(pair, bodies["ground"], at(0, 0, 5.0), at(0))
    close(found, 3.7)
    assert [each.pieces for each in found.minima] == [("a", "")]
    assert found.unique


def test_the_first_impact_of_a_world_with_solids() -> None:
    """Of a ball in a socket and a box that falls on the ground, whichever is first."""
    still = at(0.0)
    world = so.World(
        {
            "socket": SOCKET,
            "ball": BALL,
            "ground": so.shapes.halfspace(),
            "box": so.shapes.box(0.2, 0.2, 0.2),
        },
        within=1.0,
        fixed={"ground": at(0.0, 0.0, -2.0), "socket": still},
    )
    for speed, names, time in ((1.0, ("ground", "box"), 1.9), (0.2, ("socket", "ball"), 6.0)):
        paths = {
            "ball": ConstantTwist(still, ([0, 0.1, 0], [0, 0, 0])),
            "box": ConstantTwist(at(2.0), ([0, 0, -speed], [0, 0, 0])),
        }
        found = world.time_of_impact(paths, 8.0)
        assert found.names == names
        assert time - 1e-5 < found.time <= time + 1e-9


def test_what_solids_cannot_do_is_refused_with_what_to_use() -> None:
    for shape, words in (
        (so.shapes.segment(0.5), "a radius makes it a ball or a capsule"),
        (so.shapes.ellipsoid(0.1, 0.2, 0.3, rounding=0.1), "a Sphere, has no exact surface"),
    ):
        with pytest.raises(
            so.StandoffError, match="'other' would be a pair with a solid"
        ) as caught:
            so.World({"socket": SOCKET, "other": shape})
        assert words in str(caught.value)
        assert "ignore the pair" in str(caught.value)
        # where it is in no such pair it may stay
        so.World({"socket": SOCKET, "other": shape}, ignore=[("socket", "other")])
    with pytest.raises(TypeError, match="give a Body or a Solid"):
        so.compound({"one": 3})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match=r"'b' is \[1\]: give a Body, a Solid or a Compound"):
        so.distance(RINGS, [1], at(0.0), at(0.0))  # type: ignore[call-overload]
    with pytest.raises(so.StandoffError, match="planar"):
        so.World(
            {
                "socket": SOCKET,
                "disc": so.shapes.planar_loop([ConicArc([0, 0, 0], [1, 0, 0], [0, 1, 0])]),
            }
        )
    with pytest.raises(TypeError, match="World ask solids"):
        so.Tracker(RINGS, so.shapes.box((1, 1, 1)), 0.01)  # type: ignore[arg-type]


def test_compounds_of_convex_pieces_are_asked_as_in_a_world() -> None:
    two = so.compound({"left": so.shapes.sphere(0.5), "right": (so.shapes.sphere(0.5), at(2.0))})
    found = so.distance(two, so.shapes.sphere(0.5), at(0.0), at(4.5))
    assert isinstance(found, so.Proximity)
    assert found.distance == pytest.approx(1.5)
    assert found.pieces == ("right", "")
    far = so.distance(RINGS, PEG, at(0.0), at(9.0), within=1.0)
    assert far.status is so.Status.FAR
    assert far.lower_bound >= 1.0


@pytest.mark.parametrize(
    ("gap", "aside"), [(0.1, 0.0), (0.1, 0.04), (0.0, 0.0)], ids=["all round", "line", "touching"]
)
def test_copies_in_one_place_to_each_other_are_asked_once(
    gap: float, aside: float, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Turned and moved together they have the answer of the first, where they are; one that is a
    little aside is asked anew."""
    pin, asked = peg(1.0 - gap, -0.4, 3.0), []

    def counted(*given: object, **options: object) -> SolidProximity:
        asked.append(given)
        return so.solids.distance(*given, **options)  # type: ignore[arg-type]

    monkeypatch.setattr("standoff.world.solid_rows.distance", counted)
    poses: dict[str, so.Pose] = {}
    for k in range(4):
        turn = Rotation.random(random_state=rng).as_matrix()
        whole = so.Pose(turn, 8.0 * k * EYE[0] + rng.normal(size=3))
        poses |= {f"ring{k}": whole, f"pin{k}": whole @ at(aside, 0.0, 1e-6 * (k == 3))}
    world = so.World({name: RING if "ring" in name else pin for name in poses}, within=0.3)
    answer = world.distances(poses)
    assert len(answer.pairs) == 4
    assert len(asked) == 2
    for k in range(4):
        names = f"ring{k}", f"pin{k}"
        found = answer[names]
        alone = so.solids.distance(RING, pin, *(poses[name] for name in names), within=0.4)
        assert found.status is alone.status
        assert found.lower_bound <= alone.upper_bound
        assert alone.lower_bound <= found.upper_bound
        assert found.upper_bound - found.lower_bound < alone.upper_bound - alone.lower_bound + 1e-10
        # its points are on the circles and lines where it is
        for point, name, radius in (
            (found.point_a, "ring", 1.0),
            (found.point_b, "pin", 1.0 - gap),
        ):
            own = poses[f"{name}{k}"].inverse().apply(point)
            assert np.hypot(*own[:2]) == pytest.approx(radius, abs=1e-9)
            assert abs(own[2]) <= 0.5 + 1e-9
        assert found.point_b - found.point_a == pytest.approx(
            found.distance * found.normal, abs=1e-9
        )
        for each in found.minima:
            assert np.linalg.norm(each.point_b - each.point_a) == pytest.approx(
                each.distance, abs=1e-9
            )
        if found.smoothness is Smoothness.PARTIAL:
            pushed = np.r_[-found.normal, found.normal]
            assert found.gradient_rows[[0, 1, 2, 6, 7, 8]] == pytest.approx(pushed, abs=1e-9)


def test_overlaps_of_copies_are_each_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """What parts them is proven where they are."""
    pin, calls = peg(1.01, -0.4, 0.4), []
    monkeypatch.setattr(
        "standoff.world.solid_rows.distance",
        lambda *given, **options: calls.append(1) or so.solids.distance(*given, **options),
    )
    poses = {f"{name}{k}": at(8.0 * k) for k in range(2) for name in ("ring", "pin")}
    world = so.World({name: RING if "ring" in name else pin for name in poses}, within=0.3)
    answer = world.distances(poses)
    assert len(calls) == 2
    assert all(pair.penetrating for pair in answer.pairs)
