"""The pair cases of MuJoCo's own tests of its collision of convex geoms, as Standoff's bodies.

The numbers (sizes, poses, expected values, tolerances) are those of the 48 tests of
``test/engine/engine_collision_gjk_test.cc`` of MuJoCo (Apache-2.0; its version of commit
6c5f8a345167, as older ones have fewer), in the order of that file.
"""

from dataclasses import dataclass, field

import numpy as np
from mujoco_poses import POSES
from scipy.spatial.transform import Rotation

import standoff as so

TOLERANCE = 1e-6
"""kTolerance of MuJoCo's file: length, and no unit for directions."""

DIRECTION = 1e-5
"""No unit. What MuJoCo's file gives directions of boxes that are tilted by 1e-6 rad."""

DIGITS = 1e-4
"""Length. Where MuJoCo's file has only four digits of the distance."""

Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Case:
    """Two bodies at two poses, and what MuJoCo's test expects of them.

    Attributes
    ----------
    a, b : Body
    poses : pair of (4, 4) arrays
    distance : float, optional
        Signed, to within ``off``; not every test has one.
    contacts : int, optional
        How many contact points MuJoCo makes: none if the bodies are apart or touch, and some only
        if they overlap. (How many is a choice of its clipping, and not a property of the pair.)
    beyond : float
        The pair is farther apart than this.
    below : float
        And nearer than this.
    direction : (3,), optional
        From A to B, to within ``turn``.
    clipped : bool
        The direction is the normal of the face to which MuJoCo clips its contact points, and not
        that of the least depth, which the certificate proves: along it the bodies are deeper.
    middle : pair of (3,), optional
        Least and greatest place of the middle of the two witness points: the contact that MuJoCo
        expects, or the box about all of them where it expects several.
    """

    name: str
    a: so.Body
    b: so.Body
    poses: tuple[np.ndarray, np.ndarray] = field(repr=False)
    distance: float | None = None
    off: float = TOLERANCE
    contacts: int | None = None
    beyond: float = -np.inf
    below: float = np.inf
    direction: tuple[float, float, float] | None = None
    turn: float = TOLERANCE
    clipped: bool = False
    middle: Bounds | None = None

    @property
    def radius(self) -> float:
        """Of a ball about the case's origin that holds both bodies."""
        balls = zip(self.poses, (self.a, self.b), strict=True)
        return max(float(np.linalg.norm(pose[:3, 3])) + reach(body) for pose, body in balls)


SIZES: dict[so.Body, float] = {}
"""Radii of balls about the bodies' origins that hold them."""


def reach(body: so.Body) -> float:
    return SIZES[body]


def sized(body: so.Body, radius: float) -> so.Body:
    SIZES[body] = radius
    return body


def box(x: float, y: float, z: float) -> so.Body:
    """By half its lengths, as MuJoCo has them."""
    return sized(so.shapes.box(2 * x, 2 * y, 2 * z), float(np.hypot(np.hypot(x, y), z)))


def sphere(radius: float) -> so.Body:
    return sized(so.shapes.sphere(radius), radius)


def ellipsoid(x: float, y: float, z: float, margin: float = 0.0) -> so.Body:
    """With a ball of half MuJoCo's margin swept over it, as its support function does."""
    return sized(so.shapes.ellipsoid(x, y, z, rounding=margin / 2), max(x, y, z) + margin / 2)


def capsule(radius: float, half: float) -> so.Body:
    return sized(so.shapes.capsule(radius, 2 * half), radius + half)


def cylinder(radius: float, half: float) -> so.Body:
    return sized(so.shapes.cylinder(radius, 2 * half), float(np.hypot(radius, half)))


def mesh(vertices: np.ndarray, scale: tuple[float, float, float]) -> so.Body:
    """The hull of a mesh's vertices."""
    points = np.array(vertices) * scale
    return sized(so.Body.from_points(points), float(np.linalg.norm(points, axis=1).max()))


CUBE = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
OUTLINE = ((1, 0), (0.309, 0.951), (-0.809, 0.588), (-0.809, -0.588), (0.309, -0.951))
PRISM = np.array([[x, y, z] for z in (0, 1) for x, y in OUTLINE])


def at(
    x: float, y: float, z: float, euler: tuple[float, ...] = (), quat: tuple[float, ...] = ()
) -> np.ndarray:
    """A pose: Euler angles about the moved x, y, z in degrees, or a quaternion (w, x, y, z)."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    if euler:
        pose[:3, :3] = Rotation.from_euler("XYZ", euler, degrees=True).as_matrix()
    if quat:
        pose[:3, :3] = Rotation.from_quat(np.roll(quat, -1)).as_matrix()
    return pose


def kept(name: str) -> tuple[np.ndarray, np.ndarray]:
    """The poses of a case that has both of them in full."""
    return POSES[name, "a"], POSES[name, "b"]


ORIGIN = at(0, 0, 0)
UP, DOWN, AHEAD = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)
UNIT, PLATE, SLAB = box(1, 1, 1), box(0.25, 0.25, 0.05), box(5, 5, 0.1)
DICE, SMALL_DICE, HALF = box(0.025, 0.025, 0.025), box(0.02, 0.02, 0.02), box(0.5, 0.5, 0.5)
BALLS = sphere(1), sphere(1), (at(-1.5, 0, 0), at(1.5, 0, 0))
PRISM_MESH, FLOOR = mesh(PRISM, (0.2, 0.2, 0.1)), box(3, 3, 0.01)
FLOOR_MESH, CUBE_MESH = mesh(CUBE, (1, 1, 0.01)), mesh(CUBE, (1, 1, 1))
ON_FLOOR = at(0, 0, -0.001), at(0, 0, -0.01)
STOOD = at(0, 0, 2), at(0, 0, 4.4, euler=(0, 90, 40))
EGGS = at(1.5, 0, -0.5), at(1.5, 0.5, 0.5)
KEY = at(0.000886189, -0.0303047, 0.0951303, quat=(0.98783, 0.155468, 0.00454524, 1.60038e-06))
FLIPPED = at(1.10164554, -0.11389316, 0.74, quat=(-0.348312918, 0, 0, 0.937378318))
TOUCH = 1.859913200000001376466229885409
THIN = (
    (0.00034820061482369245, 0.019185701921047401, 0.014761996202854564),
    (0.00077450133003519972, 0.0025775295554971048, 0.11492914732049458),
)
THIN_A = (-0.74676731632565674, -0.54847693475561099, 0.34742493665979629, 0.14424819130859953)
THIN_B = (-0.15188202895616157, 0.10063346892175809, 0.9465165498549476, -0.2662915227032579)
THIN_AT = (-0.020305467528193247, 0.0049531030526580233, -0.015700798986895168)


def stacked(name: str, body: so.Body, contacts: int, **expected: object) -> Case:
    """Two equal boxes at poses that the file has in full."""
    return Case(name, body, body, kept(name), contacts=contacts, **expected)  # type: ignore[arg-type]


CASES = (
    Case("SphereSphereDist", *BALLS, distance=1.0, off=0.0, middle=((0, 0, 0), (0, 0, 0))),
    Case("SphereSphereDistCutoff", *BALLS, beyond=0.999999),
    Case("SphereSphereNoDist", *BALLS, contacts=0),
    Case(
        "SphereSphereIntersect",
        *(sphere(3), sphere(3), (at(-1, 0, 0), at(3, 0, 0))),
        distance=-2.0,
        contacts=1,
        direction=AHEAD,
        middle=((1, 0, 0), (1, 0, 0)),
    ),
    Case(
        "BoxBoxDepth",
        *(box(2.5, 2.5, 2.5), UNIT, (at(-1, 0, 0), at(1.5, 0, 0))),
        distance=-1.0,
        contacts=1,
        direction=AHEAD,
    ),
    Case(
        "BoxBoxDepth2",
        *(SLAB, UNIT, (ORIGIN, POSES["BoxBoxDepth2", "b"])),
        distance=-0.033401579411886845,
        contacts=1,
        direction=UP,
    ),
    stacked("BoxBoxDepth3", PLATE, 1, distance=-0.003066, direction=DOWN),
    stacked("BoxBoxSize05", HALF, 4),
    stacked("BoxBoxSize05b", HALF, 4, direction=UP, turn=DIRECTION),
    stacked("BoxBoxSize05c", HALF, 4, direction=UP, turn=DIRECTION),
    Case("BoxBoxTouching", UNIT, UNIT, (at(0, 0, TOUCH), at(0, 2, TOUCH)), contacts=0),
    Case(
        "BoxBoxMultiCCD",
        *(UNIT, box(10, 10, 1), (at(0, 0, 1.9), ORIGIN)),
        distance=-0.1,
        contacts=4,
        direction=DOWN,
        middle=((-1, -1, 0.95), (1, 1, 0.95)),
    ),
    Case(
        "BoxBoxMultiCCD2",
        *(UNIT, box(10, 10, 1), (at(9.5, 9.5, 1.9), ORIGIN)),
        distance=-0.1,
        contacts=4,
        direction=DOWN,
        middle=((8.5, 8.5, 0.95), (10, 10, 0.95)),
    ),
    Case("BoxBoxMultiCCD3", SLAB, UNIT, (ORIGIN, POSES["BoxBoxMultiCCD3", "b"]), contacts=4),
    stacked("BoxBoxMultiCCD4", PLATE, 8, distance=-0.00060425119242707459, direction=DOWN),
    stacked(
        "BoxBoxMultiCCD5",
        *(PLATE, 8),
        distance=-0.0001077858631973211,
        direction=(0.00019065, -0.00008649, -1.0),
        clipped=True,
    ),
    Case(
        "BoxBoxMultiCCD6",
        *(box(0.5, 0.5, 0.1), box(0.1, 0.1, 0.1)),
        (at(0, 0, -0.1), POSES["BoxBoxMultiCCD6", "b"]),
        distance=-0.00009843,
        contacts=5,
        direction=(-0.0008879, -0.0004601, 0.9999994),
        clipped=True,
    ),
    stacked("BoxBoxMultiCCD7", PLATE, 8),
    stacked("BoxBoxMultiCCD8", PLATE, 4),
    stacked("BoxBoxMultiCCD9", DICE, 4),
    stacked("BoxBoxMultiCCD10", DICE, 4),
    stacked("BoxBoxMultiCCD11", DICE, 4),
    stacked("BoxBoxMultiCCD12", DICE, 4),
    stacked("BoxBoxMultiCCD13", SMALL_DICE, 4, direction=UP),
    stacked("BoxBoxMultiCCD14", SMALL_DICE, 4),
    Case(
        "BoxBoxMultiCCD15",
        *(box(0.5, 0.5, 0.1), DICE, (ORIGIN, POSES["BoxBoxMultiCCD15", "b"])),
        contacts=4,
    ),
    Case(
        "SmallBoxMesh",
        *(mesh(CUBE, (0.5, 0.5, 0.1)), mesh(CUBE, (0.1, 0.1, 0.1))),
        (at(0, 0, -0.099999999), at(0, 0, 0.1)),
        distance=0.0,
        contacts=1,
        direction=UP,
        middle=((-0.1, -0.1, 0), (0.1, 0.1, 0)),
    ),
    Case(
        "BoxMesh",
        *(PRISM_MESH, FLOOR, (at(0, 0, 0.157, euler=(0, -90, 0)), at(0, 0, -0.01))),
        contacts=4,
    ),
    Case("BoxMesh2", PRISM_MESH, FLOOR, ON_FLOOR, contacts=5),
    Case("BoxMeshPrune", PRISM_MESH, FLOOR, ON_FLOOR, contacts=4),
    Case("MeshMesh", FLOOR_MESH, PRISM_MESH, ON_FLOOR[::-1], contacts=5),
    Case("MeshMeshPrune", FLOOR_MESH, PRISM_MESH, ON_FLOOR[::-1], contacts=4),
    Case("BoxEdge", UNIT, UNIT, STOOD, contacts=2),
    stacked("BoxEdge2", UNIT, 2),
    stacked("BoxEdgeEdge", box(0.15, 1, 3), 2),
    Case("MeshEdge", CUBE_MESH, CUBE_MESH, STOOD, contacts=2),
    Case(
        "MeshEdge2",
        *(box(6, 6, 2), CUBE_MESH, (at(0, 0, -1), at(2, 0, 1, euler=(0, 5, 0)))),
        contacts=2,
    ),
    Case(
        "EllipsoidEllipsoidPenetrating",
        *(ellipsoid(0.1, 0.1, 0.1), ellipsoid(0.01, 0.02, 0.1), (at(0, 0, -0.1), KEY)),
        distance=-0.00022548856248122027,
        contacts=1,
    ),
    Case(
        "EllipsoidEllipsoid",
        *(ellipsoid(0.15, 0.3, 0.2), ellipsoid(0.1, 0.1, 0.15), EGGS),
        distance=0.7542,
        off=DIGITS,
    ),
    Case(
        "EllipsoidEllipsoidSlowConvergence",
        *(ellipsoid(0.05, 0.07, 0.15), ellipsoid(0.05, 0.07, 0.15)),
        kept("EllipsoidEllipsoidSlowConvergence"),
        distance=0.0,
        below=0.0,
    ),
    Case("BoxBox", UNIT, UNIT, (at(-1.5, 0.5, 0), at(1.5, 0, 0)), distance=1.0, off=0.0),
    Case(
        "BoxBoxLarge",
        *(box(50, 50, 0.25), box(0.1, 0.1, 0.1)),
        (at(0, 0, 0.25), POSES["BoxBoxLarge", "b"]),
        distance=-0.000754,
        contacts=4,
    ),
    Case(
        "LongBox",
        *(box(1, 1, 0.3), mesh(CUBE, (0.6, 0.03, 0.03))),
        (at(0, 0, -0.3), at(0, 0, 0.02, euler=(0, 0, 40))),
        distance=-0.01,
        contacts=1,
        direction=UP,
    ),
    Case(
        "ThinBoxSeparated",
        *(box(*THIN[0]), box(*THIN[1]), (at(0, 0, 0, quat=THIN_A), at(*THIN_AT, quat=THIN_B))),
        distance=0.011757469772747348,
    ),
    Case(
        "EllipsoidEllipsoidIntersect",
        *(ellipsoid(0.15, 0.3, 0.2, margin=15), ellipsoid(0.1, 0.1, 0.15, margin=15), EGGS),
        distance=-14.245732934582151,
        contacts=1,
    ),
    Case(
        "CapsuleCapsule",
        *(capsule(0.15, 0.3), capsule(0.1, 0.1), (at(-0.3, 0.2, -0.4), at(0.3, 0.2, 0.4))),
        distance=0.4711,
        off=DIGITS,
    ),
    Case(
        "CylinderBoxMargin",
        *(cylinder(0.2, 0.2), box(0.05, 0.05, 0.05), (ORIGIN, at(0, 0, 0.265))),
        beyond=0.0,
        below=0.1,
    ),
    Case(
        "BoxEdgeFlipped",
        *(box(0.65, 0.48, 0.04), box(0.1, 1.2, 1.4), (FLIPPED, at(1.4, 0, 1.425))),
        distance=1.3 - 1.907368,
        contacts=2,
        middle=((1.603684, -0.052973, 0.70), (1.603684, -0.052973, 0.78)),
    ),
)
