"""Random worlds: bodies of the soak's shapes, rules, horizons, and wild motions of all.

Seed and number determine a world, and in it a few *chapters*: after some frames bodies leave or
enter, or the horizon changes, and a new world of the same bodies goes on from the last state.
"""

from __future__ import annotations

import itertools
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.errors import BodyError
from standoff.typing import Array
from standoff_studies.soak.cases import drawer_of
from standoff_studies.soak.known_gaps import lattice_drawer, scaled
from standoff_studies.soak.motions import random_rotation, stream
from standoff_studies.soak.shapes import Made, made
from standoff_studies.soak.world_motions import Flight, drawn_flight

Rng = np.random.Generator

WORLDS = 6
"""Stream of a seed's random numbers."""

PER_DRAWER = 16
"""Worlds that share two drawers of shapes, since making a body takes longer than moving it."""

FEWEST, MOST = 2, 60
"""Bodies of a world."""

CROWD, TRACKED = 9, 14
"""Most bodies of a world where all are in one place, and of one without a horizon: every pair takes
a cold query in every frame."""

FAMILIES = {"spread": 0.5, "huge": 0.2, "one place": 0.1, "planar": 0.1, "far out": 0.1}

FAR_OUT = 1e6
"""Length from the origin, of the bodies of some worlds."""


class Part(NamedTuple):
    """A piece of a body: its name, empty where it is the only one, and its pose (4, 4) there."""

    name: str
    made: Made
    pose: Array


class Chapter(NamedTuple):
    """A world and its frames.

    Attributes
    ----------
    world : World
    parts : list of list of Part
        Of each body.
    counted : (k, 2) array of int
        The bodies of each pair that counts, worked out without the world.
    horizons : (k,) array
        Of these pairs.
    minima : float
        -inf where they are not asked for.
    flight : Flight
        Of all bodies.
    """

    world: so.World
    parts: list[list[Part]]
    counted: NDArray[np.int64]
    horizons: Array
    minima: float
    flight: Flight


class Cast(NamedTuple):
    """The bodies that may take part, and how they are placed at first."""

    bodies: list[so.Body | so.world.Compound]
    parts: list[list[Part]]
    size: float
    poses: Array
    planar: bool
    crowded: bool


def draw_world(seed: int, number: int, frames: int) -> list[Chapter]:
    """The chapters of a world, which have that many frames together."""
    rng = stream(seed, WORLDS, number)
    cast = _drawn_cast(rng, seed, number)
    count = int(rng.integers(1, 4)) if frames >= 9 else 1
    lengths = np.diff(np.linspace(0, frames, count + 1).astype(int)).tolist()
    poses = cast.poses
    chapters: list[Chapter] = []
    for length in lengths:
        playing = np.flatnonzero(rng.random(len(cast.bodies)) < 0.85) if chapters else None
        if playing is None or len(playing) < FEWEST:
            playing = np.arange(len(cast.bodies))
        chapter = _drawn_chapter(rng, cast, playing, poses[playing], length)
        poses = poses.copy()
        poses[playing] = chapter.flight.poses[-1]
        chapters.append(chapter)
    return chapters


@lru_cache(maxsize=2)
def _drawer(seed: int, number: int) -> tuple[Made, ...]:
    return drawer_of(seed, 2 * number) + drawer_of(seed, 2 * number + 1)


@lru_cache(maxsize=4)
def _huge(seed: int, number: int) -> Made:
    """A body a thousand times as large as small ones."""
    rng = stream(seed, WORLDS + 1, number)
    for one in rng.permutation(len(_drawer(seed, number))).tolist():
        shape = _drawer(seed, number)[one].shape
        if _drawer(seed, number)[one].body.bounded and shape.kind != "point":
            try:
                return made(scaled(shape, 10.0 ** rng.uniform(2.0, 3.0)))
            except BodyError:
                continue
    return _drawer(seed, number)[0]


def _drawn_cast(rng: Rng, seed: int, number: int) -> Cast:
    family = str(rng.choice(list(FAMILIES), p=list(FAMILIES.values())))
    drawer = _drawer(seed, number // PER_DRAWER)
    planar = family == "planar"
    if planar:
        drawer = tuple(c.made for c in lattice_drawer(seed, number // PER_DRAWER) if c.planar)
    bounded = [one for one in drawer if one.body.bounded]
    n = int(np.exp(rng.uniform(np.log(FEWEST), np.log(MOST + 1))))
    n = min(n, CROWD) if family == "one place" else n
    size = float(np.median([max(one.body.size, 1e-2) for one in bounded]))
    parts = [_drawn_parts(rng, bounded, planar) for _ in range(n)]
    unbounded = [one for one in drawer if not one.body.bounded]
    if unbounded and rng.random() < 0.5:
        parts[0] = [Part("", unbounded[0], np.eye(4))]
    if family == "huge":
        parts[-1] = [Part("", _huge(seed, number // PER_DRAWER), np.eye(4))]
    spread = 0.02 if family == "one place" else float(np.exp(rng.uniform(np.log(0.4), np.log(4))))
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, 3] = rng.uniform(-0.5, 0.5, (n, 3)) * spread * size * n ** (1.0 / 3.0)
    poses[:, :3, :3] = [random_rotation(rng) for _ in range(n)]
    if planar:
        poses[:, 2, 3] = 0.0
        turns = rng.uniform(-np.pi, np.pi, n)[:, None] * np.array([0.0, 0.0, 1.0])
        poses[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    if family == "far out":
        poses[:, :3, 3] += FAR_OUT * rng.choice([-1.0, 0.0, 1.0], 3)
    return Cast([_body(x) for x in parts], parts, size, poses, planar, family == "one place")


def _drawn_parts(rng: Rng, drawer: list[Made], planar: bool) -> list[Part]:
    """One piece, or the two to four of a compound."""
    if rng.random() < 0.75:
        return [Part("", drawer[int(rng.integers(len(drawer)))], np.eye(4))]
    found = []
    for k in range(int(rng.integers(2, 5))):
        one = drawer[int(rng.integers(len(drawer)))]
        pose = np.eye(4)
        if k and planar:
            pose[:2, 3] = rng.normal(size=2) * one.body.size
        elif k:
            pose[:3, :3] = random_rotation(rng)
            pose[:3, 3] = rng.normal(size=3) * (one.body.size + 0.1)
        found.append(Part(f"p{k}", one, pose))
    return found


def _body(parts: list[Part]) -> so.Body | so.world.Compound:
    if len(parts) == 1:
        return parts[0].made.body
    return so.compound(
        {part.name: (part.made.body, (part.pose[:3, :3], part.pose[:3, 3])) for part in parts}
    )


def _drawn_chapter(
    rng: Rng, cast: Cast, playing: NDArray[np.int64], poses: Array, frames: int
) -> Chapter:
    names = [f"b{k}" for k in playing.tolist()]
    n = len(names)
    fixed = rng.random(n) < rng.choice([0.0, 0.0, 0.2, 0.5])
    rules, allowed = _drawn_rules(rng, names)
    within = cast.size * 10.0 ** rng.uniform(-6.0, 0.5)
    if n <= TRACKED and rng.random() < 0.3:
        within = np.inf
    minima = cast.size * 10.0 ** rng.uniform(-3.0, 0.3) if rng.random() < 0.4 else None
    counted = [
        (i, j)
        for i, j in itertools.combinations(range(n), 2)
        if not (fixed[i] and fixed[j]) and allowed(names[i], names[j])
    ]
    horizons = np.full(len(counted), within)
    if counted and rng.random() < 0.3:
        margins: dict[tuple[str, str], float] = {}
        for k in rng.integers(0, len(counted), 3).tolist():
            i, j = counted[k]
            pair = (names[i], names[j]) if rng.random() < 0.5 else (names[j], names[i])
            margin = float(cast.size * 10.0 ** rng.uniform(-3.0, 0.7))
            horizons[k] = max(horizons[k], margin)
            margins[pair] = max(margin, margins.get(pair, 0.0))
        rules["margins"] = margins
    bodies = {name: cast.bodies[k] for name, k in zip(names, playing.tolist(), strict=True)}
    flight = drawn_flight(rng, poses, fixed, cast.size, frames, cast.planar)
    world = so.World(
        bodies,
        within=float(within),
        minima=minima,
        dt=float(flight.steps[0]),
        fixed={name: poses[k] for k, name in enumerate(names) if fixed[k]},
        **rules,
    )
    return Chapter(
        world,
        [cast.parts[k] for k in playing.tolist()],
        np.array(counted, dtype=np.int64).reshape(-1, 2),
        horizons,
        -np.inf if minima is None else float(minima),
        flight,
    )


def _drawn_rules(rng: Rng, names: list[str]) -> tuple[dict[str, Any], Any]:
    """The arguments, and by sets of names whether a pair is left by them."""
    rules: dict[str, Any] = {}
    out: set[frozenset[str]] = set()
    wanted: set[frozenset[str]] | None = None

    def some() -> list[str]:
        return [str(x) for x in rng.choice(names, int(rng.integers(1, len(names) + 1)), False)]

    def product(a: list[str], b: list[str]) -> set[frozenset[str]]:
        return {frozenset((x, y)) for x in a for y in b if x != y}

    groups = {"left": some(), "right": some()} if rng.random() < 0.4 else {}
    if groups:
        rules["groups"] = groups
    if rng.random() < 0.4:
        pairs = [tuple(str(x) for x in rng.choice(names, 2, False)) for _ in range(3)]
        rules["ignore"] = pairs
        out |= {frozenset(pair) for pair in pairs}
    if groups and rng.random() < 0.4:
        a, b = (str(x) for x in rng.choice(["left", "right"], 2))
        rules["ignore"] = [*rules.get("ignore", []), (a, b)]
        out |= product(groups[a], groups[b])
    elif groups and rng.random() < 0.5:
        rules["only"] = [("left", "right"), (names[0], "left")]
        wanted = product(groups["left"], groups["right"]) | product([names[0]], groups["left"])
    if rng.random() < 0.3:
        chain = names[:: int(rng.integers(1, 3))]
        rules["parents"] = dict(zip(chain[1:], chain[:-1], strict=True))
        out |= {frozenset(pair) for pair in rules["parents"].items()}

    def allowed(a: str, b: str) -> bool:
        pair = frozenset((a, b))
        return pair not in out and (wanted is None or pair in wanted)

    return rules, allowed
