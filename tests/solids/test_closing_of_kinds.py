"""What closes planes that cross, what is over a plane, and what turns about one axis: it proves
what is true, and nothing that is false."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_spatial_search import negative_tolerance

from families.solid_shapes import bolt, bracket, cup, peg, ring, taper_bore, taper_plug, tube
from standoff.solids import Solid
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.status import Status

PROVEN = (Status.CONVERGED, Status.CONTINUUM)
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


SLOPE = 0.05
FITS = {
    "pin": (lambda gap: (tube(3.0, 6.0, 0.0, 20.0), peg(3.0 - gap, 0.0, 20.0)), 1.0),
    "bush": (lambda gap: (tube(3.0, 6.0, 0.0, 20.0), tube(1.0, 3.0 - gap, 0.0, 20.0)), 1.0),
    "plug in a blind hole": (
        lambda gap: (cup(3.0, 6.0, 5.0, 20.0), peg(3.0 - gap, 7.0, 20.0)),
        1.0,
    ),
    "taper": (
        lambda gap: (
            taper_bore(SLOPE, -60.0, 6.0, 0.0, 20.0),
            taper_plug(SLOPE, gap / SLOPE - 60.0, 0.0, 20.0),
        ),
        np.cos(np.arctan(SLOPE)),
    ),
}
"""Of a gap along the radius: the parts, and the distance over it."""


@pytest.mark.parametrize("gap", [1.0, 0.1, 1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("name", FITS)
def test_coaxial_walls_whose_rims_are_in_one_plane(name, gap) -> None:
    """A pin flush with its bore, lifted a little, and moved aside."""
    (a, b), share = FITS[name][0](gap), FITS[name][1]
    places = [(0.0, 0.0), (0.0, 1e-6), (0.3 * gap, 0.0), (1e-9, 0.0)]
    for aside, lift in places if name != "taper" else places[:1]:
        move = np.array([0.6 * aside, 0.8 * aside, lift])
        answer = spatial_distance(a, b, None, (np.eye(3), move))
        true = (gap - aside) * share
        assert answer.status in PROVEN, (aside, lift, answer.status)
        assert answer.distance == pytest.approx(true, abs=1e-12)
        assert answer.lower_bound <= true + 1e-13
        assert answer.counts.boxes < 150_000, (aside, lift)
