"""What closes planes that cross, what is over a plane, and what turns about one axis: it proves
what is true, and nothing that is false."""

import numpy as np
import pytest
from benchmarks import fits
from scipy.spatial.transform import Rotation
from test_spatial_search import negative_tolerance

from families.solid_shapes import bolt, bracket, peg, ring, tube
from standoff.geometry import Line, Revolution
from standoff.solids import Solid
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.points import signed_distances
from standoff.tracking.status import Status

PROVEN = (Status.CONVERGED, Status.CONTINUUM)
LINKS, SOME_GAPS = "link through link", (1e-6, 1e-2, 1.0)
OFF = (0.0, 1e-9, 1e-6, 1e-3, 2e-2)


def claimed(a: Solid, b: Solid, turn: np.ndarray, move: np.ndarray, beyond: float) -> float:
    return negative_tolerance(a, b, np.concatenate([turn.ravel(), move]), beyond)


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("names", [(bolt, bolt), (bolt, bracket), (bracket, bracket)])
def test_planes_at_small_gaps(names, gap, rng) -> None:
    """Faces whose planes cross beside each other: the distance is that of points on both, and no
    greater one is claimed."""
    a, b = names[0](), names[1]()
    for _ in range(4):
        turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
        move = rng.normal(size=3)
        move *= (a.size + b.size) / np.linalg.norm(move)
        for _ in range(6):
            answer = spatial_distance(a, b, None, (turn, move))
            move = move + (gap - answer.distance) * answer.normal
        answer = spatial_distance(a, b, None, (turn, move))
        if answer.status not in PROVEN:
            continue
        apart = np.linalg.norm(answer.point_b - answer.point_a)
        assert apart == pytest.approx(answer.distance, abs=1e-12)
        beyond = max(2e-6 * answer.distance, 1e-9 * a.size)
        assert claimed(a, b, turn, move, beyond) <= answer.distance + 1e-12


@pytest.mark.parametrize("off", OFF)
def test_circles_about_nearly_one_axis(off) -> None:
    """A rim above a wider one: the least is where the shift brings them together, and the cone
    about the axis closes the whole circle."""
    a, b = tube(0.5, 0.8, -0.6, 0.6), peg(0.3, 0.7, 1.2)
    turn, move = np.eye(3), np.array([off, 0.0, 0.0])
    answer = spatial_distance(a, b, None, (turn, move))
    true = np.hypot(0.2 - off, 0.1)
    assert answer.status in PROVEN
    assert answer.distance == pytest.approx(true, abs=1e-12)
    assert answer.lower_bound <= true <= answer.upper_bound + 1e-14
    assert answer.counts.boxes < 20_000
    assert claimed(a, b, turn, move, 2e-6) <= true + 1e-12


@pytest.mark.parametrize("off", OFF)
def test_rings_on_each_other(off) -> None:
    """Two equal tori, one above the other and moved aside: where the shift is across the spoke, the
    tubes' centres stay nearest, else they are farther by its square."""
    a = ring(1.2, 0.3)
    turn, move = np.eye(3), np.array([off, 0.0, 1.0])
    answer = spatial_distance(a, a, None, (turn, move))
    assert answer.status in PROVEN
    # centre circles that cross above each other are 1 apart there; equal ones everywhere
    assert answer.distance == pytest.approx(0.4, abs=1e-12)
    assert claimed(a, a, turn, move, 2e-6) <= 0.4 + 1e-12


def test_a_tilted_rim_over_a_plane() -> None:
    """What is over a plane is closed by heights: the rim's lowest point, whose foot is on the
    face, or on its edge where it is beside it."""
    base, pin = peg(1.0, -1.0, 0.0), peg(0.2, 0.5, 1.0)
    for tilt in (1e-9, 1e-4, 0.3):
        c, s = np.cos(tilt), np.sin(tilt)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        lowest = turn @ [0.2, 0.0, 0.5]
        answer = spatial_distance(base, pin, None, (turn, np.zeros(3)))
        assert answer.status in PROVEN
        assert answer.distance == pytest.approx(lowest[2], abs=1e-12)
        beside = np.array([1.1 - lowest[0], 0.0, 0.0])
        answer = spatial_distance(base, pin, None, (turn, beside))
        points = [turn @ [0.2 * np.cos(t), 0.2 * np.sin(t), 0.5] for t in np.linspace(0, 6.3, 4001)]
        spots = np.array(points) + beside
        out = np.maximum(np.hypot(spots[:, 0], spots[:, 1]) - 1.0, 0.0)
        least = np.hypot(out, spots[:, 2]).min()
        assert answer.lower_bound <= least
        assert answer.distance == pytest.approx(least, abs=1e-5)


@pytest.mark.parametrize(
    "kind",
    ["pin", "bush", "bearing", "plug in a blind hole", "taper", LINKS, "O-ring on a bend"],
)
def test_fits_and_rings_on_tubes(kind) -> None:
    """In closed form: flush or not, aside or tilted by any amount; nothing beyond it is claimed."""
    every = [case for case in fits.cases(SOME_GAPS) if case.kind == kind]
    assert len(every) >= 9
    for k, case in enumerate(every[::2]):
        answer = spatial_distance(case.a, case.b, None, (case.turn, case.move))
        assert fits.holds(case, answer), (case.what, answer)
        assert answer.counts.boxes < 8_000, case.what
        if k % 3 == 0:
            beyond = max(1e-3 * case.true, 1e-9)
            assert claimed(case.a, case.b, case.turn, case.move, beyond) <= case.true + 1e-12


@pytest.mark.parametrize("aside", [0.0, 0.3, 0.99])
def test_turned_lines_close_as_cylinders_do(aside) -> None:
    """A shaft in its bore, of straight lines that are turned."""

    def turned(inner: float, outer: float, low: float, high: float) -> Solid:
        corners = np.array([[inner, low], [outer, low], [outer, high], [inner, high]])
        ends = [(r, 0.0, h) for r, h in corners]
        lines = [Line(p, q) for p, q in zip(ends, ends[1:] + ends[:1], strict=True)]
        return Solid.from_patches([Revolution(line) for line in lines], name="turned")

    a, b = turned(1.7, 2.0, 0.0, 4.0), turned(2.1, 2.6, -1.0, 5.0)
    move = np.array([0.06 * aside, 0.08 * aside, 0.0])
    answer = spatial_distance(a, b, None, (np.eye(3), move))
    true = 0.1 * (1.0 - aside)
    assert answer.status in PROVEN
    assert answer.lower_bound <= true <= answer.upper_bound + 1e-14
    assert answer.counts.boxes < 8_000
    assert claimed(a, b, np.eye(3), move, 1e-4) <= true + 1e-12


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-3, 0.2])
def test_points_inside_a_ring_and_a_pin(off) -> None:
    """Near the middle of a tube, from where all round is as near: seen from either side."""
    link = next(case.a for case in fits.cases(SOME_GAPS) if case.kind == LINKS)
    for solid, x, radius in ((link, fits.BEND, 0.4), (peg(0.5, -3.0, 3.0), 0.0, 0.5)):
        told, true = signed_distances(solid, np.array([[x + off, 0.0, 0.0]])), radius - off
        assert told.converged[0]
        assert told.lower_bound[0] - 1e-14 <= -true <= told.upper_bound[0] + 1e-14
        assert told.evaluations[0] < 3_000
