"""Proofs along the paths of random robots, held against samples by the package's own interpolation.

A robot of spheres is drawn of each package, with every kind of joint that it has. A path of every
kind is drawn for it, and a clearance a little above or below what samples of it keep. What is
between waypoints, kinematics and sums of velocities are Pinocchio's and MuJoCo's own; distances of
spheres are in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.robots.paths import FunctionPath
from standoff.robots.proof import PathProof, Verdict
from standoff.whole_files import write_whole

Array = NDArray[np.float64]
Draw = np.random.Generator

SAMPLES = 300
"""Of a path, and as many again around the nearest of them."""
ACCURACY = 1e-10
"""Of the judge's distances, length: roundoff of kinematics of some metres."""
ABOVE = (1e-5, 1e-4, 1e-3, 1e-2)
"""What is asked for above and below what the samples keep, length."""
FAR_BELOW = -0.05
"""The same, where bounds of motion alone may prove it."""

PATHS = ("waypoints", "function", "two velocities", "CubicSpline", "Pchip", "BSpline", "BPoly")
"""The last four are of robots whose configurations are plain numbers."""
OFTEN = (0.2, 0.1, 0.1, 0.15, 0.15, 0.15, 0.15)
OFTEN_TURNED = (0.7, 0.15, 0.15)
"""How often each is drawn; those of unit quaternions and (cos, sin) have the first three."""


class Part(NamedTuple):
    """Numbers of a velocity that belong together: of a shift, and of the turn that may carry it."""

    shift: slice
    turn: slice


class Drawn(NamedTuple):
    """A robot as its package has it.

    Attributes
    ----------
    kinds : tuple of str
        Of its joints.
    robot : Robot
    centres : callable
        From a configuration to the centres of all spheres (n, 3), in the order of the robot's.
    radii : (n,) array
    integrate, difference : callables
        The package's own.
    home : (nq,) array
    parts : tuple of Part
        Of ball, planar and free joints; all other numbers of a velocity stand for themselves.
    """

    kinds: tuple[str, ...]
    robot: so.Robot
    centres: Callable[[Array], Array]
    radii: Array
    integrate: Callable[[Array, Array], Array]
    difference: Callable[[Array, Array], Array]
    home: Array
    parts: tuple[Part, ...]

    def least(self, Q: Array) -> Array:
        """(m,): the least distance of the watched pairs at configurations."""
        names = {name: k for k, name in enumerate(self.robot.geoms.names)}
        pairs = np.array([[names[a], names[b]] for a, b in self.robot.pairs])
        at = np.array([self.centres(q) for q in Q])
        gaps = np.linalg.norm(at[:, pairs[:, 0]] - at[:, pairs[:, 1]], axis=2)
        found: Array = (gaps - self.radii[pairs].sum(axis=1)).min(axis=1)
        return found


def turned(rng: Draw) -> Array:
    """A unit quaternion, w last."""
    q = rng.normal(size=4)
    return np.asarray(q / np.linalg.norm(q))


def drawn_axis(rng: Draw) -> Array:
    if rng.random() < 0.5:
        return np.asarray(np.eye(3)[rng.integers(3)])
    axis = rng.normal(size=3)
    return np.asarray(axis / np.linalg.norm(axis))


# --- Pinocchio ----------------------------------------------------------------------------------

PINOCCHIO = (
    *("RX", "RevoluteUnaligned", "PY", "PrismaticUnaligned", "RUBZ", "RevoluteUnboundedUnaligned"),
    *("Spherical", "SphericalZYX", "Translation", "Planar", "FreeFlyer", "Mimic"),
)


def pinocchio_joint(pin: Any, kind: str, rng: Draw) -> Any:
    axis = drawn_axis(rng)
    if kind == "Mimic":  # it is made one later
        kind = "RY" if rng.random() < 0.5 else "PX"
    if kind == "RevoluteUnboundedUnaligned":  # which has no other way to an axis
        link = '<link name="a"/><link name="b"/>'
        ends = f'<parent link="a"/><child link="b"/><axis xyz="{text(axis)}"/>'
        joint = f'<joint name="j" type="continuous">{ends}</joint>'
        return pin.buildModelFromXML(f'<robot name="r">{link}{joint}</robot>').joints[1]
    made = getattr(pin, f"JointModel{kind}")
    return made(axis) if "Unaligned" in kind else made()


def drawn_pinocchio(rng: Draw, kinds: tuple[str, ...]) -> Drawn:
    import coal
    import pinocchio as pin

    model, geometry, at = pin.Model(), pin.GeometryModel(), 0
    balls: list[tuple[int, Array, float]] = []

    def placed(size: float) -> Any:
        return pin.SE3(pin.Quaternion(turned(rng)), rng.uniform(-size, size, 3))

    for k, kind in enumerate(kinds):
        at = model.addJoint(at, pinocchio_joint(pin, kind, rng), placed(0.4), f"j{k}")
        balls.append((at, rng.uniform(-0.3, 0.3, 3), rng.uniform(0.02, 0.1)))
    balls += [(0, rng.uniform(-0.9, 0.9, 3), rng.uniform(0.02, 0.1)) for _ in range(3)]
    for k, kind in enumerate(kinds, 1):
        masters = [j for j, other in enumerate(kinds, 1) if other in ("RX", "PY") and j < k]
        if kind == "Mimic" and masters:
            ratio = float(rng.choice([-1.5, 0.0, 0.5, 2.0]))
            model = pin.transformJointIntoMimic(model, masters[-1], k, ratio, float(rng.normal()))
    for k, (joint, centre, radius) in enumerate(balls):
        place = pin.SE3(np.eye(3), centre)
        geometry.addGeometryObject(pin.GeometryObject(f"g{k}", joint, place, coal.Sphere(radius)))
    geometry.addAllCollisionPairs()
    robot = so.Robot.from_pinocchio(model, geometry)
    return _by_pinocchio(kinds, robot, model, balls, lambda q: q, slice(None), slice(None))


def _by_pinocchio(
    kinds: tuple[str, ...],
    robot: so.Robot,
    model: Any,
    balls: list[tuple[int, Array, float]],
    whole: Callable[[Array], Array],
    own_q: Any,
    own_v: Any,
) -> Drawn:
    """A robot judged by Pinocchio's model of all its joints: ``whole`` makes its configuration of
    the robot's, of whose numbers it has those at ``own_q`` and ``own_v``."""
    import pinocchio as pin

    data, parts = model.createData(), []
    at_v = np.full(model.nv, -1)
    at_v[own_v] = np.arange(robot.nv)
    for j in range(1, model.njoints):
        v, count = int(model.idx_vs[j]), int(model.nvs[j])
        kind = model.joints[j].shortname().removeprefix("JointModel")
        linear = {"Planar": 2, "FreeFlyer": 3, "Spherical": 0}.get(kind)
        if linear is not None:
            v = int(at_v[v])
            parts.append(Part(slice(v, v + linear), slice(v + linear, v + count)))

    def centres(q: Array) -> Array:
        pin.forwardKinematics(model, data, whole(q))
        return np.array([data.oMi[j].act(centre) for j, centre, _ in balls])

    def integrate(q: Array, v: Array) -> Array:
        way = np.zeros(model.nv)
        way[own_v] = v
        return np.asarray(pin.integrate(model, whole(q), way)[own_q])

    return Drawn(
        kinds,
        robot,
        centres,
        np.array([radius for *_, radius in balls]),
        integrate,
        lambda q, r: np.asarray(pin.difference(model, whole(q), whole(r))[own_v]),
        np.asarray(pin.neutral(model)[own_q]),
        tuple(parts),
    )


def text(numbers: Any) -> str:
    return " ".join(f"{x:.17g}" for x in np.ravel(numbers))


# --- URDF ---------------------------------------------------------------------------------------

URDF = (
    *("revolute", "continuous", "prismatic", "planar", "floating"),
    *("mimics before", "mimics behind", "mimics a mimic", "mimics endlessly"),
)
LIMIT = '<limit lower="-100" upper="100" effort="1" velocity="1"/>'


def drawn_urdf(rng: Draw, kinds: tuple[str, ...]) -> Drawn:
    """A file of a chain of joints; those that mimic follow a hinge or slide, or an endless hinge,
    whose names come before theirs, or behind them in Pinocchio's order."""
    import pinocchio as pin

    made = [("m", "revolute" if rng.random() < 0.5 else "prismatic"), ("e", "continuous")]
    mimics: dict[str, tuple[str, float, float]] = {}
    for k, kind in enumerate(kinds):
        ratio, offset = float(rng.choice([-1.5, 0.0, 0.5, 2.0])), float(rng.normal())
        name = f"z{k}" if kind == "mimics before" else f"a{k}"
        if not kind.startswith("mimics"):
            made.append((name, kind))
            continue
        made.append((name, "revolute" if rng.random() < 0.5 else "prismatic"))
        mimics[name] = ("m", ratio, offset)
        if kind == "mimics a mimic":
            made.append((f"{name}m", "continuous" if rng.random() < 0.5 else "revolute"))
            mimics[f"{name}m"] = (name, 0.5, 0.2)
        if kind == "mimics endlessly":
            made[-1] = name, "continuous" if rng.random() < 0.5 else "revolute"
            mimics[name] = ("e", float(rng.choice([-1.0, 0.0, 2.0])), offset)
    return _of_urdf(rng, pin, kinds, [made[k] for k in rng.permutation(len(made))], mimics)


def _of_urdf(
    rng: Draw,
    pin: Any,
    kinds: tuple[str, ...],
    made: list[tuple[str, str]],
    mimics: dict[str, tuple[str, float, float]],
) -> Drawn:
    import tempfile
    from pathlib import Path

    parts: list[str] = []
    balls: list[tuple[str, Array, float]] = []

    def link(name: str, joint: str, size: float) -> None:
        balls.append((joint, rng.uniform(-size, size, 3), rng.uniform(0.02, 0.1)))
        shape = f'<geometry><sphere radius="{balls[-1][2]:.17g}"/></geometry>'
        origin = f'<origin xyz="{text(balls[-1][1])}"/>'
        parts.append(f'<link name="{name}"><collision>{origin}{shape}</collision></link>')

    link("base", "universe", 0.9)
    link("post", "universe", 0.9)
    parts.append('<joint name="p" type="fixed"><parent link="base"/><child link="post"/></joint>')
    above = ["base"] * (len(made) + 1)
    for k, (name, kind) in enumerate(made):
        link(f"l{k}", name, 0.3)
        parent = above[k] if rng.random() < 0.7 else "base"
        axis = np.array([0.0, 0.0, 1.0]) if kind == "planar" else drawn_axis(rng)
        follows = mimics.get(name)
        mimic = (
            f'<mimic joint="{follows[0]}" multiplier="{follows[1]}" offset="{follows[2]:.17g}"/>'
            if follows
            else ""
        )
        parts.append(
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="l{k}"/>'
            f'<origin xyz="{text(rng.uniform(-0.4, 0.4, 3))}" rpy="{text(rng.normal(size=3))}"/>'
            f'<axis xyz="{text(axis)}"/>{LIMIT}{mimic}</joint>'
        )
        above[k + 1] = f"l{k}"
    written = f'<robot name="drawn">{"".join(parts)}</robot>'
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drawn.urdf"
        write_whole({path: lambda file: file.write(written.encode())})
        robot = so.Robot.from_urdf(path, mimic=True)
    model = pin.buildModelFromXML(written)
    by_name = {link: k for k, link in enumerate(robot.geoms.links)}
    links = ["base", "post", *(f"l{k}" for k in range(len(made)))]
    order = sorted(range(len(balls)), key=lambda k: by_name[links[k]])
    placed = [(model.getJointId(joint), centre, radius) for joint, centre, radius in balls]
    placed[1] = 0, placed[1][1], placed[1][2]
    return _by_pinocchio(
        kinds, robot, model, [placed[k] for k in order], *_following(model, mimics)
    )


def _following(
    model: Any, mimics: dict[str, tuple[str, float, float]]
) -> tuple[Callable[[Array], Array], Any, Any]:
    """How a whole configuration follows, by the names of joints, link by link of the chain."""
    free = [j for j in range(1, model.njoints) if model.names[j] not in mimics]
    own_q, own_v = (
        np.array([at[j] + k for j in free for k in range(n[j])])
        for at, n in ((model.idx_qs, model.nqs), (model.idx_vs, model.nvs))
    )

    def whole(q: Array) -> Array:
        found = np.zeros(model.nq)
        found[own_q] = q

        def number(name: str) -> float:
            if name in mimics:
                master, ratio, offset = mimics[name]
                return ratio * number(master) + offset
            j = model.getJointId(name)
            at = int(model.idx_qs[j])
            angle = np.arctan2(found[at + 1], found[at]) if model.nqs[j] == 2 else found[at]
            return float(angle)

        for name in mimics:
            j = model.getJointId(name)
            at, x = int(model.idx_qs[j]), number(name)
            found[at : at + model.nqs[j]] = x if model.nqs[j] == 1 else (np.cos(x), np.sin(x))
        return found

    return whole, own_q, own_v


# --- MuJoCo -------------------------------------------------------------------------------------

MUJOCO = ("hinge", "slide", "ball", "free", "hinge and slide", "two hinges")


def drawn_mujoco(rng: Draw, kinds: tuple[str, ...]) -> Drawn:
    import mujoco

    radii: list[float] = []

    def ball(size: float) -> str:
        radii.append(rng.uniform(0.02, 0.1))
        at = text(rng.uniform(-size, size, 3))
        return f'<geom name="g{len(radii)}" type="sphere" size="{radii[-1]:.17g}" pos="{at}"/>'

    def joint(kind: str) -> str:
        if kind == "free":
            return "<freejoint/>"
        axis = "" if kind == "ball" else f' axis="{text(drawn_axis(rng))}"'
        ref = "" if kind == "ball" else f' ref="{rng.normal():.17g}"'
        return f'<joint type="{kind}" pos="{text(rng.uniform(-0.1, 0.1, 3))}"{axis}{ref}/>'

    world, open_bodies = "".join(ball(0.9) for _ in range(3)), 0
    for kind in kinds:
        place = f'pos="{text(rng.uniform(-0.4, 0.4, 3))}" quat="{text(turned(rng))}"'
        if kind == "free":  # of the world alone
            world, open_bodies = world + "</body>" * open_bodies, 0
        several = {"hinge and slide": ("hinge", "slide"), "two hinges": ("hinge", "hinge")}
        world += f"<body {place}>" + "".join(joint(each) for each in several.get(kind, (kind,)))
        world, open_bodies = world + ball(0.3), open_bodies + 1
    world += "</body>" * open_bodies
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody>{world}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)

    def centres(q: Array) -> Array:
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        return np.array(data.geom_xpos)

    def integrate(q: Array, v: Array) -> Array:
        after = np.array(q)
        mujoco.mj_integratePos(model, after, v, 1.0)
        return after

    def difference(q: Array, r: Array) -> Array:
        way = np.zeros(model.nv)
        mujoco.mj_differentiatePos(model, way, 1.0, q, r)
        return way

    return Drawn(
        kinds,
        so.Robot.from_mujoco(model),
        centres,
        np.array([radii[int(model.geom(k).name[1:]) - 1] for k in range(model.ngeom)]),
        integrate,
        difference,
        np.array(model.qpos0),
        _mujoco_parts(model),
    )


def _mujoco_parts(model: Any) -> tuple[Part, ...]:
    import mujoco

    parts = []
    for j, at in enumerate(model.jnt_dofadr.tolist()):
        if model.jnt_type[j] in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            shift = 3 if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE else 0
            parts.append(Part(slice(at, at + shift), slice(at + shift, at + shift + 3)))
    return tuple(parts)


PACKAGES = {
    "pinocchio": (PINOCCHIO, drawn_pinocchio),
    "mujoco": (MUJOCO, drawn_mujoco),
    "urdf": (URDF, drawn_urdf),
}


def drawn_robot(rng: Draw, package: str, first: str) -> Drawn:
    """A robot of a package, the first of whose one to three joints is of a kind."""
    known, made = PACKAGES[package]
    more = tuple(str(kind) for kind in rng.choice(known, int(rng.integers(0, 3))))
    kinds = (first, *more)
    return made(rng, ("RX", *kinds) if first == "Mimic" else kinds)


# --- paths --------------------------------------------------------------------------------------


class Way(NamedTuple):
    """A path: what `certify` is given, and the same as the judge has it."""

    given: Any
    times: Array | None
    span: tuple[float, float]
    at: Callable[[Array], Array]


def drawn_way(rng: Draw, drawn: Drawn, kind: str) -> Way:
    """A path of a kind for a robot."""
    nv = drawn.robot.nv
    begin = drawn.integrate(drawn.home, rng.uniform(-1.5, 1.5, nv))
    n = int(rng.integers(2, 6))
    times = np.cumsum(rng.uniform(0.2, 1.5, n)) - 1.0
    if kind in ("function", "two velocities"):
        return _moved(rng, drawn, begin, 1 if kind == "function" else 2)
    points = [begin]
    for _ in range(n - 1):
        points.append(drawn.integrate(points[-1], rng.uniform(-1.2, 1.2, nv)))
    if kind == "waypoints":
        return _waypoints(drawn, np.array(points), times)
    return _spline(rng, kind, np.array(points), times)


def _waypoints(drawn: Drawn, points: Array, times: Array) -> Way:
    points = np.array([drawn.robot.kinematics.check(point) for point in points])
    ways = [drawn.difference(a, b) for a, b in pairwise(points)]

    def at(moments: Array) -> Array:
        k = np.clip(np.searchsorted(times, moments, side="right") - 1, 0, len(ways) - 1)
        part = (moments - times[k]) / (times[k + 1] - times[k])
        return np.array(
            [drawn.integrate(points[i], s * ways[i]) for i, s in zip(k, part, strict=True)]
        )

    return Way(points, times, (times[0], times[-1]), at)


def _spline(rng: Draw, kind: str, points: Array, times: Array) -> Way:
    from scipy.interpolate import BPoly, BSpline, CubicSpline, PchipInterpolator

    made: Any
    if kind == "BSpline":  # with knots that are repeated
        inner = np.repeat(rng.uniform(times[0], times[-1], 2), rng.integers(1, 4, 2))
        knots = np.concatenate([[times[0]] * 4, np.sort(inner), [times[-1]] * 4])
        more = rng.uniform(-0.5, 0.5, (len(knots) - 4, points.shape[1]))
        made = BSpline(knots, points[0] + more, 3)
    elif kind == "BPoly":
        slopes = rng.uniform(-1.0, 1.0, points.shape)
        made = BPoly.from_derivatives(times, np.stack([points, slopes], axis=1))
    elif rng.random() < 0.5:
        made = {"CubicSpline": CubicSpline, "Pchip": PchipInterpolator}[kind](times, points)
    else:
        made = {"CubicSpline": CubicSpline, "Pchip": PchipInterpolator}[kind](
            times, points.T, axis=1
        )
        return Way(made, None, (times[0], times[-1]), lambda t: np.asarray(made(t)).T)
    return Way(made, None, (times[0], times[-1]), lambda t: np.asarray(made(t)))


def _moved(rng: Draw, drawn: Drawn, begin: Array, count: int) -> Way:
    """A function: one velocity, or two one after the other, each as far as a sine goes."""
    nv, span = drawn.robot.nv, float(rng.uniform(0.5, 3.0))
    ways = [rng.uniform(-0.8, 0.8, nv) for _ in range(count)]
    rates = rng.uniform(0.5, 2.0, count)

    def one(time: float) -> Array:
        q = begin
        for way, rate in zip(ways, rates, strict=True):
            q = drawn.integrate(q, np.sin(rate * time) * way)
        return q

    if count == 1:
        speed, gain = np.abs(ways[0]) * rates[0], np.abs(ways[0]) * rates[0] ** 2
        given = FunctionPath(one, span, speed, gain if rng.random() < 0.5 else None)
    else:
        speed = sum(np.abs(way) * rate for way, rate in zip(ways, rates, strict=True))
        for part in drawn.parts:  # the second turns and carries the axes of the first
            first = [np.linalg.norm(ways[0][x]) * rates[0] for x in part]
            second = [np.linalg.norm(ways[1][x]) for x in part]
            speed[part.shift] = first[0] + second[0] * first[1] + second[0] * rates[1]
            speed[part.turn] = first[1] + second[1] * rates[1]
        given = FunctionPath(one, span, speed)
    return Way(given, None, (0.0, span), lambda t: np.array([one(x) for x in t.tolist()]))


# --- one case -----------------------------------------------------------------------------------


class Case(NamedTuple):
    """What came of one proof; ``wrong`` is empty where the samples agree."""

    package: str
    kinds: tuple[str, ...]
    path: str
    verdict: str
    wrong: str


def cases_of(seed: int, number: int) -> list[Case]:
    """Proofs along one path of one robot: of a clearance above and of one below what samples keep,
    and of one far below; fewer where the spheres overlap."""
    rng = np.random.default_rng((seed, number))
    package = list(PACKAGES)[number % len(PACKAGES)]
    known = PACKAGES[package][0]
    drawn = drawn_robot(rng, package, known[number // len(PACKAGES) % len(known)])
    plain = drawn.robot.nq == drawn.robot.nv
    kind = str(rng.choice(PATHS, p=OFTEN) if plain else rng.choice(PATHS[:3], p=OFTEN_TURNED))
    way = drawn_way(rng, drawn, kind)
    times = np.linspace(*way.span, SAMPLES)
    least = drawn.least(way.at(times))
    near = int(np.argmin(least))
    ends = times[max(near - 1, 0)], times[min(near + 1, SAMPLES - 1)]
    times = np.concatenate([times, np.linspace(*ends, SAMPLES)])
    least = np.concatenate([least, drawn.least(way.at(times[SAMPLES:]))])
    found = []
    for beside in (rng.choice(ABOVE), -rng.choice(ABOVE), FAR_BELOW):
        clearance = float(least.min() + beside)
        if clearance >= 0.0:
            proof = drawn.robot.certify(way.given, clearance, times=way.times)
            wrong = judged(proof, drawn, way, times, least)
            found.append(Case(package, drawn.kinds, kind, proof.verdict.name, wrong))
    return found


def judged(proof: PathProof, drawn: Drawn, way: Way, times: Array, least: Array) -> str:
    """What of a proof the samples contradict."""
    until = proof.end if proof.verdict is Verdict.PROVEN else proof.time
    before = least[times < until] if until < proof.end else least
    miss = proof.clearance - before.min(initial=np.inf)
    if miss > ACCURACY:
        return f"{proof.verdict.name} with samples {miss:.3g} nearer than {proof.clearance:.6g}"
    if proof.verdict is Verdict.PROVEN and proof.proven - least.min() > ACCURACY:
        return f"proven {proof.proven:.6g}, but samples are at {least.min():.6g}"
    if proof.verdict is Verdict.VIOLATED:
        there = float(drawn.least(way.at(np.array([proof.latest])))[0])
        if there > proof.clearance + ACCURACY:
            return f"VIOLATED, but {there:.6g} apart there for {proof.clearance:.6g}"
    return ""
