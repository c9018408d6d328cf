"""The pairs of the study of convergence: their bodies, motions and starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import product

import numpy as np

from standoff.bodies import Body, shapes
from standoff.motion import ConstantTwist, Fixed, Path, Pose, Spiral, Twist
from standoff.tracking import distance
from standoff.typing import Array
from standoff_studies.paper.bodies import leaf, lens_of_patches, planar_body
from standoff_studies.paper.convergence.lenses import PARAMETRISATIONS, Lens, lens
from standoff_studies.paper.pair_simulation import AT_POINT, Place, Start
from standoff_studies.paper.simulation_a import setting
from standoff_studies.paper.simulation_b import run as simulation_b
from standoff_studies.paper.simulation_c import run as simulation_c
from standoff_studies.paper.simulation_d.runs import HELIX, TRIED
from standoff_studies.paper.simulation_e.runs import PATH_A, PATH_B, SEMI_AXES

DRAWN = 10
"""Drawn pairs: stretched lenses of patches at random poses."""

SEED_OF_PAIRS = 7

STRETCHED = (0.6, 1.2)
"""Range of a drawn lens's factors along its axes."""

GAPS = (0.4, 1.0)
"""Range of a drawn pair's distance [length]: the lenses are about as large."""

SPEED, SPIN = 0.2, 0.3
"""Motion of a body for which none is given: along the gap's tangent plane [length/s], and about a
random axis [rad/s]. In the longest run, 0.62 s, it moves by at most 0.4, less than the gap."""

HARDER = 3
"""Pairs of lenses at each speed, and at each ratio of curvatures."""

RATES = (1.0, 3.0, 10.0, 30.0)
"""Rates at which the second body of a pair turns about its own centre [rad/s]."""

RATIOS = (1.0, 10.0, 100.0, 1000.0)
"""Greatest curvature of the ellipsoid of which a lens's faces are, over its least."""

CLEARANCE = 0.3
"""Between the balls round both bodies of a turning pair [length]: they never meet."""

OUTSIDE = 2.5
"""Time at which simulation B's spiral starts here: its point is outside then [s]."""


@dataclass(frozen=True, eq=False)
class Pair:
    """Two bodies, A at rest at the identity pose, and how starts are drawn.

    Attributes
    ----------
    name : str
    a, b : Body
    path : Path
        Of B; ``motion="rest"`` uses its first pose.
    draw : callable
        Takes a random generator, and returns a place on A and one on B.
    grid : tuple
        The places of a pair whose starts are not drawn.
    """

    name: str
    a: Body
    b: Body
    path: Path
    draw: Callable[[np.random.Generator], Start]
    grid: tuple[Start, ...] = ()

    def path_of(self, motion: str) -> Path:
        """Return B's path, at rest or moving."""
        return self.path if motion == "moving" else Fixed(self.path.pose(0.0))


def on_a_face(faces: int, rng: np.random.Generator) -> Place:
    """Draw a face of four sides, and parameters on it."""
    face = int(rng.integers(faces))
    u, v = rng.uniform(size=2).tolist()
    return ("face", face), (u, v)


def on_a_curve(curves: int, rng: np.random.Generator) -> Place:
    """Draw a curve of a planar body with parameters from 0 to 1, and its parameter."""
    return ("edge", int(rng.integers(curves))), (float(rng.uniform()),)


def on_a_lens(one: Lens, home: Body, feature: tuple[str, int], at: tuple[float, ...]) -> Place:
    """Return a place on the patches (`home`), in the parameters of a lens."""
    if one.parametrisation == "patches":
        return feature, at
    point = home.face_parts[feature[1]].charts[0].jet(*at)[0]
    return feature, one.place(feature[1], point)


def _lens_and_point(parametrisation: str) -> Pair:
    one, home = lens(parametrisation), lens_of_patches()
    name = f"D: lens and point, {PARAMETRISATIONS[parametrisation]}"
    return Pair(
        name,
        one.body,
        shapes.point(),
        HELIX,
        lambda rng: (on_a_lens(one, home, *on_a_face(3, rng)), AT_POINT),
    )


def _grid(parametrisation: str) -> Pair:
    """D with the 75 starts of simulation D's grid on the patches, at the same points in space."""
    one, home = lens(parametrisation), lens_of_patches()
    grid = tuple(
        (on_a_lens(one, home, ("face", face), (u, v)), AT_POINT)
        for face, u, v in product(range(3), TRIED, TRIED)
    )
    return replace(_lens_and_point(parametrisation), grid=grid)


def _two_lenses(parametrisation: str) -> Pair:
    by = np.diag(SEMI_AXES)
    one, other = lens(parametrisation), lens(parametrisation, by)
    home, home_b = lens_of_patches(), lens_of_patches().transformed(by)
    assert (PATH_A.pose(0.0).translation == 0.0).all(), "A is at home"

    def draw(rng: np.random.Generator) -> Start:
        # the order in which the study has always drawn: both faces, then both places
        (k, m), (at, at_b) = rng.integers(3, size=2).tolist(), rng.uniform(size=(2, 2)).tolist()
        return (
            on_a_lens(one, home, ("face", k), tuple(at)),
            on_a_lens(other, home_b, ("face", m), tuple(at_b)),
        )

    name = f"E: two lenses, {PARAMETRISATIONS[parametrisation]}"
    return Pair(name, one.body, other.body, PATH_B, draw)


def _apart(a: Body, b: Body, turn: Array, way: Array, gap: float, rng: np.random.Generator) -> Path:
    """Place B at a distance from A, and let it drift along the gap and rotate.

    B is first placed far away along `way`, and then moved back along the normal: the supporting
    planes keep their witness points, so that the gap is exact.
    """
    far = Pose(turn, 6.0 * way / np.linalg.norm(way))
    found = distance(a, b, Pose.identity(), far)
    shift = far.translation - (found.distance - gap) * found.normal
    drift = np.cross(found.normal, rng.normal(size=3))
    axis = rng.normal(size=3)
    twist = Twist(SPEED * drift / np.linalg.norm(drift), SPIN * axis / np.linalg.norm(axis))
    return ConstantTwist(Pose(turn, shift), twist)


def _random_turn(rng: np.random.Generator) -> Array:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q if np.linalg.det(q) > 0.0 else -q)


def _drawn(number: int) -> Pair:
    rng = np.random.default_rng([SEED_OF_PAIRS, number])
    a, b = (lens_of_patches().transformed(np.diag(rng.uniform(*STRETCHED, 3))) for _ in range(2))
    return set_apart(f"drawn pair {number}", a, b, rng)


def set_apart(name: str, a: Body, b: Body, rng: np.random.Generator) -> Pair:
    """Draw a place of B beside A, both of patches with three faces, and its motion."""
    way, gap = rng.normal(size=3), float(rng.uniform(*GAPS))
    return _of_lenses(name, a, b, _apart(a, b, _random_turn(rng), way, gap, rng))


def _turning(number: int, rate: float) -> Pair:
    """A drawn pair farther apart, B turning about its centre."""
    rng = np.random.default_rng([SEED_OF_PAIRS, number])
    a, b = (lens_of_patches().transformed(np.diag(rng.uniform(*STRETCHED, 3))) for _ in range(2))
    way, axis = (x / np.linalg.norm(x) for x in rng.normal(size=(2, 3)))
    reach = sum(np.linalg.norm(body.vertex_points, axis=1).max() for body in (a, b))
    pose = Pose(_random_turn(rng), (reach + CLEARANCE) * way)
    return _of_lenses(
        f"turning pair {number}", a, b, ConstantTwist(pose, Twist(np.zeros(3), rate * axis))
    )


def _sharp(number: int, ratio: float) -> Pair:
    """A drawn pair whose lenses are stretched until their curvatures have a ratio.

    An ellipsoid's greatest curvature over its least is (a / c)³, of its longest and shortest axis.
    """
    rng = np.random.default_rng([SEED_OF_PAIRS, number])

    def drawn() -> Body:
        least = ratio ** (-1.0 / 3.0)
        axes = rng.permutation([1.0, float(rng.uniform(least, 1.0)), least])
        return lens_of_patches().transformed(np.diag(axes))

    return set_apart(f"sharp pair {number}", drawn(), drawn(), rng)


def _of_lenses(name: str, a: Body, b: Body, path: Path) -> Pair:
    return Pair(name, a, b, path, lambda rng: (on_a_face(3, rng), on_a_face(3, rng)))


def _vaults(*, alone: bool) -> Pair:
    vault = setting.vault()
    if alone:
        return Pair(
            "A: vault and point",
            vault,
            setting.point(),
            setting.PATH,
            lambda rng: (on_a_face(6, rng), AT_POINT),
        )
    rng = np.random.default_rng(SEED_OF_PAIRS)
    turn = Pose.exp((2.5, 0.4, 0.7)).rotation
    path = _apart(vault, vault, turn, np.array([0.3, -0.2, 1.0]), 0.5, rng)
    return Pair(
        "two vaults of A", vault, vault, path, lambda rng: (on_a_face(6, rng), on_a_face(6, rng))
    )


def _planar(*, alone: bool) -> Pair:
    body = planar_body()
    if not alone:
        path = simulation_c.MOTION
        return Pair(
            "C: two planar bodies",
            body,
            leaf(),
            path,
            lambda rng: (on_a_curve(3, rng), on_a_curve(3, rng)),
        )
    spiral, turned = simulation_b.motion(body), simulation_b.RATE * OUTSIDE
    growth = float(
        (np.hypot(*spiral.pose(1.0).translation[:2]) - simulation_b.RADIUS) / simulation_b.RATE
    )
    path = Spiral(simulation_b.RADIUS + growth * turned, growth, simulation_b.RATE, phase=turned)
    return Pair(
        "B: planar body and point",
        body,
        shapes.point(),
        path,
        lambda rng: (on_a_curve(3, rng), AT_POINT),
    )


TURNING = {rate: tuple(f"turning {k}, {rate:g}" for k in range(HARDER)) for rate in RATES}
SHARP = {ratio: tuple(f"sharp {k}, {ratio:g}" for k in range(HARDER)) for ratio in RATIOS}
"""Keys of the harder pairs, by rate and by ratio."""

MADE: dict[str, Callable[[], Pair]] = {
    **{f"D {key}": partial(_lens_and_point, key) for key in PARAMETRISATIONS},
    **{f"E {key}": partial(_two_lenses, key) for key in PARAMETRISATIONS},
    "A point": partial(_vaults, alone=True),
    "A vaults": partial(_vaults, alone=False),
    "B": partial(_planar, alone=True),
    "C": partial(_planar, alone=False),
    **{f"drawn {k}": partial(_drawn, k) for k in range(DRAWN)},
    **{
        name: partial(made, k, by)
        for made, keys in ((_turning, TURNING), (_sharp, SHARP))
        for by, names in keys.items()
        for k, name in enumerate(names)
    },
    **{f"D {key}, grid": partial(_grid, key) for key in PARAMETRISATIONS},
}
"""How each pair is made, by its key."""

LENSES = tuple(f"{which} {key}" for which in "DE" for key in PARAMETRISATIONS)
DRAWN_PAIRS = tuple(f"drawn {k}" for k in range(DRAWN))
GRIDS = tuple(f"D {key}, grid" for key in PARAMETRISATIONS)
"""Keys of some pairs."""


@cache
def pair(key: str) -> Pair:
    """Return a pair by its key."""
    return MADE[key]()
