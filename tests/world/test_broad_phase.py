"""Bounds of boxes, ways and the tree, each by itself, against an adversary or brute force."""

import itertools

import numpy as np
import pytest
from scattered import SHAPES, poses_of
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from standoff.kernels.entries import world as kernels
from standoff.kernels.world import arrays as W
from standoff.world import broad_phase
from standoff.world.packed import packed_pieces
from standoff.world.pieces import CompoundPiece

FLOOR = so.shapes.halfspace((0.0, 0.6, 0.8), offset=-0.4)


def placed(pieces, poses, before=None):
    """The kernel's rows of pieces at poses."""
    frame = broad_phase.empty_placed(len(pieces.owners))
    old = frame.placed.copy() if before is None else before
    boxes = np.zeros((len(pieces.owners), 6))
    assert kernels.place(pieces[:], poses, boxes, old, frame[:])[0] == -1
    return frame


def drawn_piece(rng: np.random.Generator, shape: so.Body) -> CompoundPiece:
    """Some with a placement, some far from the origin of their body, or very large or small."""
    pose = poses_of(rng, 1, 10.0 ** rng.uniform(-2, 3))[0] if rng.random() < 0.5 else np.eye(4)
    scale = 10.0 ** rng.uniform(-3, 3)
    body = shape if shape is FLOOR else shape.transformed(scale * np.eye(3))
    return CompoundPiece(body, so.Pose.of(pose))


def test_boxes_bound_the_distance_from_below(rng: np.random.Generator) -> None:
    tight = 0
    for _ in range(draws(250)):
        a, b = (drawn_piece(rng, SHAPES[rng.integers(len(SHAPES))]) for _ in range(2))
        if rng.random() < 0.2:
            a = drawn_piece(rng, FLOOR)
        size = b.body.size + (a.body.size if a.body.bounded else 0.0)
        poses = poses_of(rng, 2, size * 10.0 ** rng.uniform(-1, 1))
        pieces = packed_pieces([[a], [b]])
        frame = placed(pieces, poses)
        bound = kernels.apart_by_boxes(pieces[:], frame.placed, 0, 1)
        at = frame.placed[:, W.P_ROTATION : W.P_SHIFT + 3]
        true = so.distance(a.body, b.body, *((x[:9].reshape(3, 3), x[9:]) for x in at))
        assert bound <= true.upper_bound, (a, b, poses, bound, true)
        tight += bound > true.distance - 0.5 * size
    assert tight > draws(125)


def test_a_point_of_a_piece_goes_no_farther_than_its_travel(rng: np.random.Generator) -> None:
    for _ in range(draws(200)):
        piece = drawn_piece(rng, SHAPES[rng.integers(6)])
        pieces = packed_pieces([[piece]])
        size = piece.body.size
        poses = poses_of(rng, 1, size)
        frame = placed(pieces, poses)
        start = frame.placed.copy()
        total = 0.0
        for _ in range(5):
            turn = Rotation.from_rotvec(rng.normal(size=3) * 10.0 ** rng.uniform(-9, 0.5))
            poses = poses.copy()
            poses[0, :3, :3] = turn.as_matrix() @ poses[0, :3, :3]
            poses[0, :3, 3] += size * rng.normal(size=3) * 10.0 ** rng.uniform(-12, 0)
            before = frame.placed
            frame = placed(pieces, poses, before)
            spots = support_points(piece.body, rng)
            ways = [
                np.linalg.norm(world_points(frame.placed, spots) - world_points(x, spots), axis=1)
                for x in (before, start)
            ]
            way = frame.placed[0, W.P_TRAVEL] - before[0, W.P_TRAVEL]
            assert ways[0].max() <= way
            # the same bound by angle and axis, of which no part is lost but roundoff
            centre = pieces.facts[:, W.F_CENTRE : W.F_CENTRE + 3]
            moved = world_points(frame.placed, centre) - world_points(before, centre)
            turned = 2.0 * np.sin(turn.magnitude() / 2.0) * pieces.facts[0, W.F_REACH]
            least = np.linalg.norm(moved) + turned
            assert way <= 1.5 * least + 1e-12 * (size + np.abs(frame.placed[0, :12]).max())
            assert ways[1].max() <= frame.placed[0, W.P_TRAVEL]
            total += way
        same = placed(pieces, poses, frame.placed)
        assert same.placed[0, W.P_TRAVEL] == frame.placed[0, W.P_TRAVEL]
        assert same.still[0] == 1


def support_points(body: so.Body, rng: np.random.Generator) -> np.ndarray:
    """Corners of the body's box, in its frame: no point of its core is farther out."""
    from standoff.kernels.body import layout as L

    corners = np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
    centre = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    return centre + corners * body.reals[L.BOX_HALF : L.BOX_HALF + 3]


def world_points(rows: np.ndarray, points: np.ndarray) -> np.ndarray:
    turn = rows[0, W.P_ROTATION : W.P_SHIFT].reshape(3, 3)
    return points @ turn.T + rows[0, W.P_SHIFT : W.P_SHIFT + 3]


@pytest.mark.parametrize("n", [1, 2, 3, 50, 300])
@pytest.mark.parametrize("spread", [0.0, 0.3, 6.0])
def test_the_tree_finds_every_pair_of_boxes(
    rng: np.random.Generator, n: int, spread: float
) -> None:
    """Of bodies in one place as well, and with one huge body among small ones."""
    shapes = [SHAPES[rng.integers(len(SHAPES))] for _ in range(n)]
    shapes[0] = so.shapes.box((30.0, 30.0, 0.1))
    pieces = packed_pieces([[CompoundPiece(shape, so.Pose.identity())] for shape in shapes])
    world = so.World({f"b{k}": shape for k, shape in enumerate(shapes)}, within=0.2)
    poses = poses_of(rng, n, spread)
    search = world.model.search
    frame = placed(pieces, poses)
    tree = broad_phase.first_tree(search, frame)
    frame.sought[:] = 1
    table = broad_phase.table_of(
        search,
        frame,
        tree,
        broad_phase.PairTable(np.empty((0, W.N_INTS), np.int64), np.empty((0, W.N_KNOWN))),
    )
    found = {tuple(pair) for pair in table.ints[:, [W.I_A, W.I_B]].tolist()}
    low, high = tree.boxes[:, :3], tree.boxes[:, 3:]
    for i, j in itertools.combinations(range(n), 2):
        gap = np.linalg.norm(np.maximum(0.0, np.maximum(low[j] - high[i], low[i] - high[j])))
        assert ((i, j) in found) == (gap <= search.reach), (i, j, gap)
    assert len(found) == len(table.ints)


def test_pairs_stay_found_as_pieces_leave_their_boxes(rng: np.random.Generator) -> None:
    """The table after many small searches against one search of everything."""
    world = so.World({f"b{k}": SHAPES[k % 6] for k in range(60)}, within=0.3)
    poses = poses_of(rng, 60, 2.0)
    speed = rng.normal(size=(60, 3)) * rng.choice([0.0, 0.1, 1.0], size=(60, 1))
    state = world.start(poses)
    refits = 0
    for _ in range(60):
        poses = poses.copy()
        poses[:, :3, 3] += 0.02 * speed
        speed = np.where(np.abs(poses[:, :3, 3]) > 2.0, -speed, speed)
        state, answer = world.step(state, poses)
        refits = max(refits, state.tree.refits)
        fresh = world.distances(poses)
        assert answer.pairs.names == fresh.pairs.names
        assert answer.pairs.distance == pytest.approx(fresh.pairs.distance, abs=1e-9)
    assert refits > 5


def test_pieces_in_their_padded_boxes_are_not_sought(rng: np.random.Generator) -> None:
    """A padded box lasts for some frames at the speed of the last."""
    world = so.World({f"b{k}": SHAPES[k % 6] for k in range(60)}, within=0.3)
    poses, speed = poses_of(rng, 60, 2.0), 0.02 * rng.normal(size=(60, 3))
    state, sought = world.start(poses), 0
    for _ in range(40):
        poses = poses.copy()
        poses[:, :3, 3] += speed
        state, answer = world.step(state, poses)
        assert answer.counts.resting == 0
        sought += answer.counts.sought
    assert 0 < sought < 0.3 * 40 * 60


def test_a_half_space_that_has_turned_hides_no_other_motion() -> None:
    world = so.World({"plane": so.shapes.halfspace(), "ball": so.shapes.sphere(0.5)}, within=0.5)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 2, 3] = 10.0
    state = world.start(poses)
    poses[0, :3, :3] = so.Pose.exp((0.01, 0.0, 0.0)).rotation
    state, _ = world.step(state, poses)
    poses[1, 2, 3] = 0.4
    state, answer = world.step(state, poses)
    assert answer["plane", "ball"].distance < 0.0


def test_planar_bodies_overlap_in_the_plane_alone() -> None:
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (0.5, 0), (0, 0.5))])
    world = so.World({"a": disc, "two": so.compound({"near": disc, "off": disc})}, within=0.5)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 0.6
    state = world.start(poses)
    poses[1, 0, 3] = 0.59
    assert world.step(state, poses)[1]["a", "two"].lower_bound <= -0.41 + 1e-9


def test_a_short_way_after_a_long_one_is_not_lost() -> None:
    """The sum of two travels may have no digit left for it: A has been far away, B creeps."""
    ball = so.shapes.sphere(0.5)
    world = so.World({"a": ball, "b": ball}, within=1.0)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 2.0 + 3e-4
    state = world.start(poses)
    for x in (1e12, 0.0, 0.0):
        poses[0, 0, 3] = x
        state, _ = world.step(state, poses)
    for _ in range(60):
        poses[1, 0, 3] -= 1e-5
        state, answer = world.step(state, poses)
        true = so.distance(ball, ball, *poses).distance
        assert answer.clearance <= min(true, 1.0) + 1e-12
        if abs(true - 1.0) > 1e-9:
            assert answer["a", "b"].far == (true > 1.0)
