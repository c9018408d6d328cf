"""Robots among solids that need not be convex: rows, proofs of paths and of boxes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ring
from robots.path_oracle import drawn_judged, least_distances
from robots.test_certify_boxes import judge as judge_box
from robots.test_certify_paths import judge, straight
from robots.trees import robot_of
from standoff.robots import Robot
from standoff.robots.certify_tolerances import BRACKET
from standoff.robots.proof import Verdict
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

mujoco = pytest.importorskip("mujoco")

MODEL = """
<mujoco><worldbody>
  <body name="rod" pos="0 0 0">
    <joint name="slide" type="slide" axis="0 0 1"/>
    <joint name="turn" type="hinge" axis="0 1 0" pos="0.1 0 0"/>
    <geom name="tip" type="sphere" size="0.1" pos="0.02 0 0.1"/>
  </body>
</worldbody></mujoco>
"""


def turn(vector: list[float]) -> np.ndarray:
    return Rotation.from_rotvec(vector).as_matrix()


@cache
def hoop() -> so.Solid:
    return ring(0.3, 0.05)


TURNED = so.Pose(turn([0.3, 0.2, 0.0]), [0.05, 0.02, 0.1])


def robot(**obstacles: object) -> Robot:
    return Robot.from_mujoco(mujoco.MjModel.from_xml_string(MODEL), obstacles=obstacles)


def test_random_paths_among_rings() -> None:
    rng = np.random.default_rng(30)
    verdicts = []
    for _ in range(16):
        judged = drawn_judged(rng, int(rng.integers(1, 5)), rings=2)
        n = int(rng.integers(2, 4))
        points = rng.uniform(-1.0, 1.0, judged.robot.nq) + rng.uniform(
            -0.5, 0.5, (n, judged.robot.nq)
        )
        times = np.cumsum(rng.uniform(0.1, 2.0, n))
        at = straight(points, times)
        own = least_distances(judged, at(np.linspace(times[0], times[-1], 200)))
        if own[0].min() <= 0.0:
            continue
        clearance = max(0.0, own.min() + rng.choice([-0.02, -1e-3, 1e-3]))
        proof = judged.robot.certify(points, clearance, times=times)
        judge(judged, proof, at)
        verdicts.append(proof.verdict)
    assert verdicts.count(Verdict.PROVEN) > 3
    assert verdicts.count(Verdict.VIOLATED) > 3


def test_random_boxes_among_rings() -> None:
    rng = np.random.default_rng(31)
    verdicts = set()
    for width in (0.02, 0.1, 0.4):
        judged = drawn_judged(rng, 2, rings=2)
        q = rng.uniform(-1.0, 1.0, 2)
        proof = judged.robot.certify_box(q - width, q + width, 1e-3, max_boxes=100, whole=True)
        judge_box(judged, proof, rng)
        verdicts.add(proof.verdict)
    assert len(verdicts) > 1


@pytest.mark.parametrize(("off", "proven"), [(0.0, True), (0.148, True), (0.152, False)])
def test_through_a_ring(off: float, proven: bool) -> None:
    """A ball goes through a ring, whose hull it would meet; nearest at the middle of the way."""
    place = np.eye(4)
    place[0, 3] = off
    ball = so.shapes.sphere(0.1)
    made = robot_of(
        [2],
        [-1],
        [place],
        [[0.0, 0.0, 1.0]],
        [(0, ball, np.eye(4))],
        fixed={"ring": (hoop(), np.eye(4))},
    )
    path = made.certify([[-1.0], [1.0]], 1e-3)
    box = made.certify_box([-1.0], [1.0], 1e-3)
    assert bool(path) is bool(box) is proven
    least = 0.15 - off
    if proven:
        assert 1e-3 < path.proven <= least + 1e-12
        assert 1e-3 < box.proven <= least + 1e-12
        return
    # as near as the clearance where hypot(0.3 - off, z) = 0.151
    early = 0.5 - 0.5 * np.sqrt(0.151**2 - (0.3 - off) ** 2)
    assert path.verdict is box.verdict is Verdict.VIOLATED
    assert early - BRACKET <= path.time <= early
    assert early <= path.latest
    assert np.isclose(path.witness.upper_bound, path.witness.distance, atol=1e-9)


def test_what_is_apart_along_one_normal_meets_across_it() -> None:
    """A ball beside the wall of a ring, which slides along the wall and meets the next: along the
    normal in the middle nothing moves."""
    place = np.eye(4)
    place[0, 3] = 0.1
    made = robot_of(
        [2],
        [-1],
        [place],
        [[0.0, 1.0, 0.0]],
        [(0, so.shapes.sphere(0.1), np.eye(4))],
        fixed={"ring": (hoop(), np.eye(4))},
    )
    # 0.25 - 0.1 from the axis the ball meets the tube
    meets = np.sqrt(0.15**2 - 0.1**2)
    box = made.certify_box([-0.2], [0.2], 1e-4, whole=True)
    assert box.verdict is Verdict.VIOLATED
    assert 0.99 * meets / 0.2 < box.free < meets / 0.2
    path = made.certify([[-0.2], [-0.1], [0.0], [0.1], [0.2]], 1e-4)
    assert (path.verdict, path.time) == (Verdict.VIOLATED, 0.0)
    assert made.certify([[-0.1], [-0.05], [0.0], [0.05], [0.1]], 1e-4)


def test_links_of_a_chain_come_apart_only_through_each_other() -> None:
    """Interlocked rings, moved within their play, and pulled until they meet."""
    across = turn([np.pi / 2, 0.0, 0.0])
    place = np.eye(4)
    place[:3, :3], place[0, 3] = across, 0.3
    made = robot_of(
        [2],
        [-1],
        [np.eye(4)],
        [[1.0, 0.0, 0.0]],
        [(0, hoop(), place)],
        fixed={"ring": (hoop(), np.eye(4))},
    )
    # the circles are 0.3 - |x| apart: less both minor radii
    assert made.certify([[-0.15], [0.15]], 0.01)
    pulled = made.certify([[0.0], [1.0]], 0.01)
    assert pulled.verdict is Verdict.VIOLATED
    assert 0.19 - BRACKET <= pulled.time <= 0.19 <= pulled.latest < 0.191


def test_rows_beside_a_ring_are_derivatives() -> None:
    made = robot(hoop=(hoop(), TURNED))
    q, v, h = np.array([0.1, 0.3]), np.array([0.4, -0.7]), 1e-6
    rows = made.distances(q)
    ahead, behind = (made.distances(q + s * h * v).distance[0] for s in (1.0, -1.0))
    assert rows.names == [("tip", "hoop")]
    assert rows.status[0] is Status.CONVERGED
    assert rows.smooth[0]
    assert rows.jacobian[0] @ v == pytest.approx((ahead - behind) / (2.0 * h), rel=1e-6)
    _, stepped = made.step(made.start(q), q + 1e-3 * v)
    again = made.clearance(q + 1e-3 * v)
    assert stepped.distance[0] == pytest.approx(again.distance, abs=1e-9)
    both = made.clearances([q, q + 0.1]).distance
    assert both[0] == pytest.approx(rows.distance[0], abs=1e-9)
    assert made.report().geoms[-1].became == "given"


def test_a_ball_on_the_axis_has_no_derivative_by_turns() -> None:
    """Every point of the ring is as near: only the way along the normal counts."""
    made = robot(hoop=(hoop(), so.Pose(np.eye(3), [0.02, 0.0, 0.1])))
    flag = made.clearance([0.0, 0.0])
    assert flag.status is Status.CONTINUUM
    assert flag.smoothness is Smoothness.PARTIAL
    assert not flag.smooth


def test_inside_a_solids_material_is_below_the_wall() -> None:
    made = robot(
        block=(so.Solid(so.shapes.box((2.0, 2.0, 2.0))), so.Pose(np.eye(3), [0.5, 0.0, 0.0]))
    )
    q, v, h = np.array([0.0, 0.0]), np.array([0.3, 0.5]), 1e-6
    rows = made.distances(q)
    one = made.clearance(q)
    assert rows.status[0] is one.status is Status.CONTAINED
    # the nearest wall is at x = -0.5: the ball reaches to 0.02 - 0.1
    assert rows.distance[0] == one.distance == pytest.approx(-0.42, abs=1e-9)
    assert rows.upper_bound[0] == one.upper_bound == pytest.approx(-0.42, abs=1e-9)
    assert -np.inf < one.lower_bound == rows.lower_bound[0] <= -0.62
    assert np.allclose(one.normal, [1.0, 0.0, 0.0])
    assert rows.clearance == -np.inf
    near = made.distances(q, within=0.1)
    assert near.distance[0] == pytest.approx(-0.42, abs=1e-9)
    ahead, behind = (made.distances(q + s * h * v).distance[0] for s in (1.0, -1.0))
    assert rows.jacobian[0] @ v == pytest.approx((ahead - behind) / (2.0 * h), abs=1e-8)
    proof = made.certify([q, q + 0.01], 0.0)
    assert (proof.verdict, proof.time, proof.latest) == (Verdict.VIOLATED, 0.0, 0.0)
    assert proof.witness.upper_bound < 0.0


def test_a_mesh_may_stand_for_a_solid() -> None:
    cube = """<mujoco><asset><mesh name="cube"
      vertex="0 0 0  .2 0 0  0 .2 0  .2 .2 0  0 0 .2  .2 0 .2  0 .2 .2  .2 .2 .2"/></asset>
      <worldbody><geom name="floor" type="plane" size="1 1 1"/><body pos="0 0 1"><freejoint/>
      <geom name="part" type="mesh" mesh="cube"/></body></worldbody></mujoco>"""
    made = Robot.from_mujoco(mujoco.MjModel.from_xml_string(cube), meshes={"part": hoop()})
    q = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    part = next(geom for geom in made.report().geoms if geom.name == "part")
    assert part.became == "given"
    low = made.poses(q)[made.geoms.names.index("part")][2, 3] - 0.05
    assert made.clearance(q).distance == pytest.approx(low, abs=1e-9)


def test_a_robot_among_solids_is_shown() -> None:
    pytest.importorskip("viser")
    made = robot(hoop=(hoop(), TURNED))
    path = [[0.0, 0.0], [0.1, 0.2]]
    with made.view(path, proof=made.certify(path), open=False) as page:
        course = page.stage.player.recording
        for k in (0, 50, 100):
            q = np.array(path[1]) * course.time[k]
            assert course.distance[k] == pytest.approx(made.clearance(q).distance, abs=1e-9)
        assert course.time[100] == 1.0
        assert page.stage.live.answer["tip", "hoop"].status is Status.CONVERGED


def test_what_takes_no_solids_says_so() -> None:
    pytest.importorskip("casadi")
    made = robot(hoop=(hoop(), TURNED))
    with pytest.raises(so.StandoffError, match="CasADi takes convex bodies alone, and 'hoop'"):
        so.robots.casadi_distance(made, [("tip", "hoop")])
    with pytest.raises(TypeError, match="with a Body, a Solid or a Compound"):
        robot(hoop=("hoop", TURNED))
