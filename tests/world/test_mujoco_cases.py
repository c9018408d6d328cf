"""The pair cases of MuJoCo's own tests, all inside one world.

All 48 tests of MuJoCo's ``test/engine/engine_collision_gjk_test.cc`` are of a pair whose geometry
Standoff has, and all are here (`mujoco_cases`). Of them is checked what is a property of the pair:
distance, direction and the contact's place. Not checked are how many contact points MuJoCo makes of
an overlap, the status of its iteration, and how many polygons its mesh has.
"""

import numpy as np
import pytest
from mujoco_cases import CASES, Case

import standoff as so
from oracles.flat_shapes import signed_distance

WITHIN = 1.5
"""Horizon of the world, length: beyond the farthest pair of the cases, at 1."""

ALONE = 1e-12
"""Length. A pair in a world against the pair alone, at the same poses: equal to the last bit where
this was written, but the world's queries are compiled by themselves and may be rounded in another
way elsewhere. And against the pair where MuJoCo has it: moved by up to 700 along x, coordinates are
rounded to 1.1e-13."""

FLAT = 1e-9
"""Length. The oracle takes normals from the cross products of edges that are within 1e-6 rad of
each other, hence to 1e-10."""

APART = 1e-6
"""Length. What the two bounds may be apart here: MuJoCo's tolerance. A depth is proven to a
thousandth of itself at the worst; of all but one of these cases it is to 2e-9."""

FEW_DIGITS = {
    "BoxBoxDepth3",
    "BoxBoxLarge",
    "BoxBoxMultiCCD6",
    "BoxEdgeFlipped",
    "CapsuleCapsule",
    "EllipsoidEllipsoid",
    "EllipsoidEllipsoidSlowConvergence",
    "SmallBoxMesh",
}
"""Cases whose expected value is rounded, the last two of them to 0: within MuJoCo's tolerance of
the distance, and proven not to be it."""

STOPPED_EARLY = {
    "BoxBoxMultiCCD5",
    "EllipsoidEllipsoidIntersect",
    "EllipsoidEllipsoidPenetrating",
}
"""Cases whose expected value has all its digits, and is proven to be off by 1e-11, 6e-7 and 2e-7 at
least, within MuJoCo's tolerance: each less deep than the bodies are, as a polytope is that grows
inside their difference until it is near enough."""


def names_of(case: Case) -> tuple[str, str]:
    return f"{case.name} A", f"{case.name} B"


class Scene:
    """One world of all the cases, side by side along x."""

    def __init__(self) -> None:
        bodies: dict[str, so.Body] = {}
        self.poses: dict[str, np.ndarray] = {}
        self.shifts: dict[str, np.ndarray] = {}
        x = 0.0
        for case in CASES:
            # whole numbers, so that round coordinates stay round
            x = np.ceil(x + case.radius + WITHIN)
            self.shifts[case.name] = np.array([x, 0.0, 0.0])
            for name, body, pose in zip(names_of(case), (case.a, case.b), case.poses, strict=True):
                bodies[name], self.poses[name] = body, pose.copy()
                self.poses[name][:3, 3] += self.shifts[case.name]
            x += case.radius
        self.world = so.World(bodies, within=WITHIN)
        self.state = self.world.start(self.poses)
        self.answer = self.world.answer(self.state)

    def pair(self, case: Case) -> so.world.PairAnswer:
        return self.answer[names_of(case)]


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene()


def of_each(cases: tuple[Case, ...]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", cases, ids=lambda case: case.name)


each = of_each(CASES)

WITH_CORNERS = tuple(
    case for case in CASES if min(len(body.vertex_points) for body in (case.a, case.b)) >= 8
)
"""Those of boxes and meshes alone."""


def test_all_cases_are_there_and_no_other_pair_is_near(scene: Scene) -> None:
    assert len({case.name for case in CASES}) == 48
    assert len(WITH_CORNERS) == 38
    assert len(scene.answer.pairs) == len(CASES)
    assert scene.answer.certified
    assert not any(scene.pair(case).far for case in CASES)
    assert scene.answer.closest is not None
    a, b = scene.answer.closest.names
    assert (a, b) == ("EllipsoidEllipsoidIntersect A", "EllipsoidEllipsoidIntersect B")
    assert scene.answer.clearance == min(scene.pair(case).lower_bound for case in CASES)


@each
def test_the_pair_in_the_world_is_the_pair_alone(scene: Scene, case: Case) -> None:
    found = scene.pair(case)
    alone = so.distance(case.a, case.b, *(scene.poses[name] for name in names_of(case)))
    home = so.distance(case.a, case.b, *case.poses)
    for other in (alone, home):
        assert found.distance == pytest.approx(other.distance, rel=0.0, abs=ALONE)
        assert found.lower_bound == pytest.approx(other.lower_bound, rel=0.0, abs=ALONE)
        assert found.status == other.status
    assert found.lower_bound <= alone.upper_bound
    assert alone.lower_bound <= found.upper_bound


def test_a_second_frame_finds_the_same(scene: Scene) -> None:
    _, answer = scene.world.step(scene.state, scene.poses, workers=2)
    assert len(answer.pairs) == len(CASES)
    assert answer.certified
    for case in CASES:
        found = answer[names_of(case)]
        first = scene.pair(case)
        assert found.distance == pytest.approx(first.distance, rel=0.0, abs=ALONE), case
        assert found.lower_bound <= first.upper_bound, case
        assert first.lower_bound <= found.upper_bound, case


@each
def test_the_distance_is_what_mujoco_expects(scene: Scene, case: Case) -> None:
    found = scene.pair(case)
    assert found.certified
    assert found.upper_bound - found.lower_bound <= APART
    if case.distance is not None:
        assert found.distance == pytest.approx(case.distance, rel=0.0, abs=case.off)
        least, greatest = found.lower_bound - ALONE, found.upper_bound + ALONE
        assert (least <= case.distance <= greatest) == (case.name not in FEW_DIGITS | STOPPED_EARLY)
        assert case.name not in STOPPED_EARLY or case.distance > greatest
    if case.contacts == 0:
        assert found.distance >= 0.0
    elif case.contacts is not None:
        assert found.upper_bound < 0.0
    assert found.lower_bound > case.beyond
    assert found.upper_bound < case.below


@each
def test_direction_and_place_are_what_mujoco_expects(scene: Scene, case: Case) -> None:
    found = scene.pair(case)
    if case.clipped:
        assert case.direction is not None
        normal = np.array(case.direction) / np.linalg.norm(case.direction)
        a, b = corners(scene, case)
        # another translation that parts them, and a longer one than the proven least
        assert (a @ normal).max() - (b @ normal).min() > -found.lower_bound + ALONE
    elif case.direction is not None:
        assert found.normal == pytest.approx(case.direction, rel=0.0, abs=case.turn)
    if case.middle is not None:
        middle = 0.5 * (found.point_a + found.point_b) - scene.shifts[case.name]
        least, greatest = np.array(case.middle)
        assert (middle >= least - case.turn).all()
        assert (middle <= greatest + case.turn).all()


def corners(scene: Scene, case: Case) -> list[np.ndarray]:
    """World coordinates of the corners of both."""
    placed = zip((case.a, case.b), names_of(case), strict=True)
    poses = [(body.vertex_points, scene.poses[name]) for body, name in placed]
    return [points @ pose[:3, :3].T + pose[:3, 3] for points, pose in poses]


@of_each(WITH_CORNERS)
def test_boxes_and_meshes_against_all_their_separating_axes(scene: Scene, case: Case) -> None:
    true = signed_distance(*corners(scene, case))
    found = scene.pair(case)
    assert found.distance == pytest.approx(true, rel=0.0, abs=FLAT)
    assert found.lower_bound <= true + FLAT
