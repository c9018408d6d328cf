"""One call that works for every public function and constructor, argument by argument.

Tests put other values in place of single arguments. Where a call has been left out it says why.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

import standoff as so
from standoff import c_interface, control, devices, geometry, motion, servo, simulation
from standoff.geometry import Line

MODULES: dict[str, ModuleType] = {
    "standoff": so,
    "standoff.shapes": so.shapes,
    "standoff.bodies": so.bodies,
    "standoff.impact": so.impact,
    "standoff.points": so.points,
    "standoff.voronoi": so.voronoi,
    "standoff.geometry": geometry,
    "standoff.motion": motion,
    "standoff.control": control,
    "standoff.simulation": simulation,
    "standoff.devices": devices,
    "standoff.servo": servo,
    "standoff.c_interface": c_interface,
}
NOT_CALLED = {
    **dict.fromkeys(("Surface", "Curve"), "abstract, or made by static methods"),
    **dict.fromkeys(("Body", "Boundary"), "made by static methods"),
    **dict.fromkeys(("Apex", "Edge", "Face"), "plain records, checked by `Body.from_brep`"),
    "view": "opens a port; tests/view tries it",
    **dict.fromkeys(("build_library", "save_pair"), "write files; tests/c_interface tries them"),
    "FrameBuffer": "made from a tracker and a state, which need compiled kernels and check nothing",
    "Answers": "made by trackers",
    "read_step": "needs OpenCASCADE; tests/cad tries it",
    "decomposition": "needs CoACD; tests/bodies/test_meshes.py tries it",
    **dict.fromkeys(("Decomposition", "Fit"), "made by decomposition"),
    "PatchBounds": "made by surfaces",
    "step_growth": "takes a tracker and levels, which check theirs; tests/control tries it",
    "Design": "takes a function by position, and any names; tests/design tries it",
    "Distances": "made by distances",
    "ServoReport": "made by servos",
    "TrackerState": "made by trackers, which check the states that they are given",
    "TrackerStates": "made by trackers, which check the states that they are given",
}
"""Public names with parameters that are not tried, and why."""

SPHERE, BOX = so.shapes.sphere(0.5), so.shapes.box(1.0, 1.0, 1.0)
DISC = so.shapes.planar_loop([geometry.ConicArc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])])
HOME, AWAY = np.eye(4), so.Pose(np.eye(3), [3.0, 0.0, 0.0])
PLACED = {"pose_a": HOME, "pose_b": AWAY}
PLANE = geometry.Plane.through(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
DIAGONAL = Line([0.0, 0.0], [1.0, 1.0])
PCURVE = geometry.pcurve_of(DIAGONAL, PLANE)
KNOTS = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
NET = [[[0.0, 0.0, 0.0], [0.0, 1.0, 0.1]], [[1.0, 0.0, 0.1], [1.0, 1.0, 0.5]]]
MERIDIAN = Line([1.0, 0.0, -1.0], [2.0, 0.0, 1.0])
CHART = {"linear": np.eye(3), "shift": np.zeros(3), "domain": (-1.0, 1.0, -1.0, 1.0)}
RIGHT_ANGLES = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}
WINDING = {"rate": 1.0, "phase": 0.1, "orientation": "fixed"}
AXES = [1.0, 2.0, 3.0]
LOOP = [Line([0, 0], [1, 0]), Line([1, 0], [0, 1]), Line([0, 1], [0, 0])]
TRIANGLE = so.shapes.planar_loop(LOOP)

SHAPES: dict[str, dict[str, Any]] = {
    "box": {"size": AXES, "rounding": 0.1},
    "cap": {"radius": 1.0, "offset": 0.1, "rounding": 0.1},
    "capsule": {"radius": 1.0, "length": 2.0, "rounding": 0.1},
    "cone": {"radius": 1.0, "height": 2.0, "rounding": 0.1},
    "cylinder": {"radius": 1.0, "height": 2.0, "rounding": 0.1},
    "egg": {"radius": 1.0, "length": 3.0, "taper": 0.3, "rounding": 0.1},
    "ellipsoid": {"semi_axes": AXES, "rounding": 0.1},
    "gore": {"radius": 1.0, "height": 3.0, "patches": 4, "rounding": 0.1},
    "halfspace": {"normal": [0.0, 1.0, 1.0], "offset": 0.1, "rounding": 0.1},
    "hull_of_revolution": {"curve": MERIDIAN, "rounding": 0.1},
    "lens": {"radius": 1.0, "offset": 0.4, "rounding": 0.1},
    "planar_loop": {"curves": LOOP, "rounding": 0.1},
    "point": {"rounding": 0.1},
    "polygon": {"vertices": RIGHT_ANGLES["vertices"][:3], "rounding": 0.1},
    "polytope": {**RIGHT_ANGLES, "rounding": 0.1},
    "rounded_polytope": {**RIGHT_ANGLES, "rounding": 0.01},
    "segment": {"length": 1.0, "rounding": 0.1},
    "sphere": {"radius": 1.0, "rounding": 0.1},
    "sphere_atlas": {"linear": np.eye(3), "centre": np.zeros(3)},
    "spindle": {"radius": 1.0, "length": 3.0, "patches": 3, "rounding": 0.1},
    "superellipsoid": {"semi_axes": AXES, "exponents": [0.5, 0.5], "rounding": 0.1},
}

GEOMETRY: dict[str, dict[str, Any]] = {
    "BezierPatch": {"control_points": NET, "weights": [[1.0, 1.0], [1.0, 2.0]]},
    **dict.fromkeys(("Cone", "Cylinder", "Plane", "Sphere"), CHART),
    "SuperellipsoidPole": {**CHART, "e1": 0.5, "e2": 0.5},
    "SuperellipsoidSide": {**CHART, "e1": 0.5, "e2": 0.5},
    "ConicArc": {"centre": [0, 0], "a": [1, 0], "b": [0, 1], "first": 0.0, "last": 1.0},
    "Extrusion": {"profile": DIAGONAL, "direction": [0, 0, 1], "first": 0.0, "last": 1.0},
    "FormulaCurve": {
        "x": "a*cos(t)",
        "y": "sin(t)",
        "z": "0",
        "first": 0.0,
        "last": 1.0,
        "parameters": {"a": 2.0},
    },
    "FormulaSurface": {
        "x": "a*u",
        "y": "v",
        "z": "u**2 + v**2",
        "domain": [0, 1, 0, 1],
        "parameters": {"a": 2.0},
    },
    "Line": {"p": [0.0, 0.0], "q": [1.0, 1.0]},
    "NurbsCurve": {"control_points": [[0, 0], [1, 0], [1, 1]], "knots": KNOTS, "weights": [1] * 3},
    "NurbsPcurve": {"control_points": [[0, 0], [1, 0], [1, 1]], "knots": KNOTS, "weights": [1] * 3},
    "NurbsSurface": {
        "control_points": NET,
        "weights": [[1.0, 1.0], [1.0, 2.0]],
        "knots_u": [0, 0, 1, 1],
        "knots_v": [0, 0, 1, 1],
    },
    "Pcurve": {"kind": PCURVE.kind, "matrix": PCURVE.matrix},
    "RationalBezier": {"control_points": [[0, 0], [1, 0], [1, 1]], "weights": [1.0, 1.0, 2.0]},
    "Revolution": {"profile": MERIDIAN, "first": 0.0, "last": 1.0},
    "SurfaceCurve": {
        "surface": PLANE,
        "pcurve": PCURVE,
        "first": 0.0,
        "last": 1.0,
        "others": [(PLANE, PCURVE)],
    },
    "Plane.through": {"origin": [0, 0, 0], "along_u": [1, 0, 0], "along_v": [0, 1, 0]},
    "SurfaceCurve.isoline": {"surface": geometry.BezierPatch(NET), "u": 0.5},
    "Torus": {"major": 2.0, "minor": 1.0, "u0": 0.0, "u1": 1.0, "v0": 0.0, "v1": 1.0},
    "ellipsoid_octants": dict(zip("abc", AXES, strict=True)),
    "ellipsoid_patches": dict(zip("abc", AXES, strict=True)),
    "pcurve_of": {"curve": DIAGONAL, "surface": PLANE},
}

MOTION: dict[str, dict[str, Any]] = {
    "Bounded": {
        "path": motion.Fixed(HOME),
        "speed": 0.0,
        "acceleration": 0.0,
        "angular_speed": 0.0,
        "angular_acceleration": 0.0,
        "breaks": [0.5],
    },
    "Carried": {"carrier": motion.Fixed(HOME), "within": motion.Fixed(HOME)},
    "ConstantTwist": {"pose": HOME, "twist": so.Twist.zero()},
    "Fixed": {"pose": HOME},
    "Helix": {"radius": 1.0, "pitch": 0.5, "centre": [0, 0, 0], "axis": [0, 0, 1], **WINDING},
    "Offset": {"path": motion.Fixed(HOME), "pose": HOME},
    "Pose": {"rotation": np.eye(3), "translation": [0.0, 0.0, 0.0]},
    "PoseFunction": {
        "pose": motion.Fixed(HOME).pose,
        "twist": None,
        "step": 1e-3,
        "start": 0.0,
        "end": 1.0,
    },
    "PoseSamples": {"times": [0.0, 1.0], "poses": [HOME, AWAY]},
    "Poses": {"rotations": [np.eye(3)] * 2, "translations": np.zeros((2, 3))},
    "Poses.from_wxyz": {
        "quaternions": [[1.0, 0, 0, 0]] * 2,
        "translations": [[0.0, 0.0, 0.0]] * 2,
    },
    "Poses.from_xyzw": {
        "quaternions": [[0.0, 0, 0, 1]] * 2,
        "translations": [[0.0, 0.0, 0.0]] * 2,
    },
    "Poses.of": {"poses": [HOME, AWAY]},
    "Screw": {
        "pose": HOME,
        "axis": [0, 0, 1],
        "point": [1, 0, 0],
        "angular_rate": 1.0,
        "pitch": 0.1,
    },
    "Spiral": {"radius": 1.0, "growth": 0.1, "centre": [0.0, 0.0], **WINDING},
    "Twist": {"v": [1.0, 0.0, 0.0], "omega": [0.0, 0.0, 1.0], "frame": "world"},
    "Pose.exp": {"rotation_vector": [0.0, 0.0, 1.0], "translation": [0.0, 0.0, 0.0]},
    "Pose.from_wxyz": {"quaternion": [1.0, 0, 0, 0], "translation": [0.0, 0.0, 0.0]},
    "Pose.from_xyzw": {"quaternion": [0.0, 0, 0, 1], "translation": [0.0, 0.0, 0.0]},
    "Pose.nearest": {"value": HOME},
    "Pose.of": {"value": HOME},
    "Twist.between": {"first": HOME, "second": AWAY, "duration": 1.0},
    "Twist.of": {"value": np.zeros(6)},
    "read_pose_samples": {"file": "no_such_file.tum"},
}


BODIES: dict[str, dict[str, Any]] = {
    "Body.from_brep": {
        "vertices": [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]],
        "faces": [],
        "dimension": 3,
        "edges": [so.bodies.Edge(Line([0, 0, -1], [0, 0, 1]), 0, 1)],
        "rounding": 0.1,
        "tolerance": 1e-9,
        "convexity_tolerance": 1e-6,
    },
    "Body.from_points": {
        "points": RIGHT_ANGLES["vertices"],
        "tolerance": 1e-3,
        "rounding": 0.1,
        "name": "hull",
    },
    "Body.from_mesh": {
        "mesh": (RIGHT_ANGLES["vertices"], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
        "hull": False,
        "tolerance": 1e-3,
        "rounding": 0.1,
        "name": "mesh",
    },
    "Body.from_patches": {
        "patches": geometry.ellipsoid_octants(1.0, 2.0, 3.0),
        "tolerance": 1e-9,
        "convexity_tolerance": 1e-6,
        "rounding": 0.1,
    },
    "max_gain": {"integrator": "heun", "dt": 1e-3},
}
"""Not of `standoff.shapes`, but they check like its shapes."""

CONTROL: dict[str, dict[str, Any]] = {
    "euler_min_gain": {"error": 1e-3, "acceleration": 0.1, "dt": 1e-3},
    "growth_factor": {"integrator": "heun", "z": -0.5},
    "growth_polynomial": {"integrator": "heun"},
    "least_curvature": {"body": SPHERE},
    "least_eigenvalue": {"curvature_a": 1.0, "curvature_b": 2.0, "distance": 0.1},
    "min_gain": {
        "a": SPHERE,
        "b": SPHERE,
        "error": 1e-3,
        "speed": 0.1,
        "spin": 0.1,
        "distance": (0.1, 1.0),
    },
    "principal_curvatures": {"surface": geometry.Sphere(**CHART), "u": 0.1, "v": 0.2},
    "reach": {"body": BOX},
    "sampled_roots": {"integrator": "heun", "feedback": so.feedback.Linear(1.0), "dt": 1e-3},
    "stability_limit": {"integrator": "heun"},
    "steady_error": {"integrator": "heun", "gain": 1.0, "dt": 1e-3, "acceleration": 0.1},
    "witness_speeds": {
        "curvature_a": 1.0,
        "curvature_b": 2.0,
        "distance": (0.1, 1.0),
        "speed": 1.0,
        "spin": 0.1,
    },
}


SAMPLING = {
    "period": 1e-3,
    "device_damping": 1.0,
    "device_rotational_damping": 1e-3,
    "delay": 1,
    "velocity_time_constant": 1e-3,
}
MECHANISM = {
    "mass": 0.1,
    "damping": 1.0,
    "rotational_inertia": 1e-4,
    "rotational_damping": 1e-3,
}
ARM = {**MECHANISM, "stiffness": 100.0, "rotational_stiffness": 1.0}
WEIGHED = {"mass": 1.0, "centre": np.zeros(3), "inertia": np.eye(3)}
# The functions of a system by its own equations: named, so that it can be stored.


def _place(theta: Any) -> list[so.Pose]:
    return [HOME, so.Pose(np.eye(3), [0.0, 0.0, 1.0 + theta[0]])]


def _jacobian(theta: Any) -> list[Any]:
    return [np.zeros((6, 1)), np.eye(6)[:, 2:3]]


def _mass(theta: Any) -> list[list[float]]:
    return [[2.0]]


def _no_force(theta: Any, rate: Any) -> list[float]:
    return [0.0]


SLIDING: dict[str, Any] = {
    "bodies": [BOX, SPHERE],
    "place": _place,
    "jacobian": _jacobian,
    "mass": _mass,
    "coriolis": _no_force,
    "field": _no_force,
    "contact": simulation.HuntCrossley(stiffness=1e3),
    "pairs": [(0, 1)],
    "drive": None,
}
COUPLER = simulation.VirtualCoupler(stiffness=1.0, damping=0.1, max_force=1.0, max_age=1.0)
HEAVY = simulation.RigidBody.free(SPHERE, mass=1.0, pose=AWAY)

SIMULATION: dict[str, dict[str, Any]] = {
    "DeviceLimits": {"max_force": 5.0, "max_torque": 0.1, "workspace": 0.2},
    "DeviceReadings": {"readings": [None]},
    "DeviceReadings.along": {"path": motion.Fixed(HOME), "count": 3, "period": 1e-3},
    "Disturbances": {"script": {3: "nan"}, "drop_out": 0.1, "malformed": 0.1, "seed": 1},
    "Encoder": {
        "position_step": 1e-5,
        "angle_step": 1e-3,
        "velocities": True,
        "velocity_time_constant": 1e-3,
    },
    "HumanArm": ARM,
    "Mechanism": MECHANISM,
    "PassivityController": {
        "max_damping": 1.0,
        "max_rotational_damping": 1e-3,
        "max_tool_damping": 1.0,
        "max_tool_rotational_damping": 1e-3,
        "tolerance": 1e-6,
    },
    "Sampling": SAMPLING,
    "ScriptedHand": {
        "path": motion.Fixed(HOME),
        "arm": simulation.HumanArm(**ARM),
    },
    "SimulatedDevice": {
        "mechanism": simulation.Mechanism(**MECHANISM),
        "hand": None,
        "period": 1e-3,
        "pose": HOME,
        "encoder": None,
        "delay": 1,
        "limits": None,
        "disturbances": None,
    },
    "VirtualCoupler": {
        "stiffness": 100.0,
        "damping": 0.1,
        "rotational_stiffness": 0.1,
        "rotational_damping": 1e-4,
        "max_force": 5.0,
        "max_torque": 0.1,
        "max_force_rate": 1e3,
        "max_torque_rate": 1e3,
        "engage_time": 0.1,
        "max_age": 0.01,
        "sampling": simulation.Sampling(**SAMPLING),
        "controller": None,
    },
    "HuntCrossley": {
        "stiffness": 1e4,
        "damping": 0.1,
        "friction": 0.3,
        "slip_speed": 0.1,
        "depth": 1e-3,
    },
    "RigidBody.free": {
        "body": SPHERE,
        "density": None,
        "mass": 1.0,
        "inertia": np.eye(3),
        "centre": [0.0, 0.0, 0.0],
        "pose": AWAY,
        "twist": so.Twist.zero(),
    },
    "RigidBody.fixed": {"body": BOX, "pose": HOME},
    "RigidBody.driven": {"body": BOX, "path": motion.Fixed(HOME)},
    "System": {
        "bodies": [simulation.RigidBody.fixed(BOX), HEAVY],
        "contact": simulation.HuntCrossley(stiffness=1e3),
        "pairs": [(0, 1)],
        "gravity": [0.0, 0.0, -9.81],
        "coupler": COUPLER,
        "tool": 1,
    },
    "GeneralisedSystem": SLIDING,
    "solve": {
        "system": simulation.GeneralisedSystem(**SLIDING),
        "theta": [0.5],
        "rate": [0.0],
        "duration": 1e-3,
        "method": "RK23",
        "tolerance": 1e-3,
        "max_step": 0.1,  # a duration may be replaced by 1 s
        "allow_overlap": False,
    },
    "Operator": {
        "system": simulation.System(
            [simulation.RigidBody.fixed(BOX), HEAVY], simulation.HuntCrossley(stiffness=1e3)
        ),
        "dt": 1e-3,
        "method": "rk4",
        "tracker": "inside",
        "gain": 100.0,
    },
    "Wrench": {"force": AXES, "torque": AXES},
    "largest_stiffness": {
        "damping": 0.1,
        "device_damping": 1.0,
        "sampling": simulation.Sampling(**SAMPLING),
    },
    "required_damping": {
        "stiffness": 100.0,
        "damping": 0.1,
        "sampling": simulation.Sampling(**SAMPLING),
    },
    "required_damping_of": {"position_to_force": lambda z: 100.0 / z, "period": 1e-3, "angles": 64},
    "mass_properties": {"body": SPHERE, "density": 2.0, "tolerance": 1e-6},
    "MassProperties": {**WEIGHED, "volume": 1.0},
    "MassProperties.of": WEIGHED,
}

LEASH = simulation.System(
    [simulation.RigidBody.fixed(BOX), HEAVY],
    simulation.HuntCrossley(stiffness=1e3),
    coupler=COUPLER,
    tool=1,
)

DEVICES: dict[str, dict[str, Any]] = {
    "Inverse3": {
        "url": "ws://localhost:10001",
        "device_id": "049D",
        "period": 1e-3,
        "placement": HOME,
    },
    "PointerDevice": {"pose": HOME},
    "Polled": {
        "device": simulation.SimulatedDevice(
            simulation.Mechanism(mass=0.1, damping=1.0), period=1e-3
        ),
        "period": 1e-3,
        "stamped": False,
    },
    "Trace": {"path": motion.Fixed(HOME), "start": 0.0, "end": 1.0, "there_and_back": True},
}

SERVO: dict[str, dict[str, Any]] = {
    "Servo": {
        "operator": simulation.Operator(LEASH, dt=1e-3),
        "state": None,
        "device": None,
        "rate": 1000.0,
        "seconds": 1.0,
        "max_age": 0.1,
        "real_time": True,
        "log_ticks": 10,
    },
}


class Call(NamedTuple):
    """A public name, what it names, and arguments with which it works."""

    name: str
    public: Callable[..., Any]
    arguments: dict[str, Any]


def calls() -> list[Call]:
    """Return every call of this table."""
    tables = (
        (so.shapes, SHAPES),
        (geometry, GEOMETRY),
        (motion, MOTION),
        (so, BODIES),
        (control, CONTROL),
        (simulation, SIMULATION),
        (devices, DEVICES),
        (servo, SERVO),
    )
    found = []
    for module, table in tables:
        for name, arguments in table.items():
            public: Any = module
            for part in name.split("."):
                public = getattr(public, part)
            found.append(Call(f"{module.__name__.split('.')[-1]}.{name}", public, arguments))
    return found


def pair_calls() -> list[Call]:
    """Return the calls that ask about a pair of bodies, or run it."""
    pair = {"a": SPHERE, "b": BOX}
    posed = {**pair, **PLACED}
    moving = motion.ConstantTwist(AWAY, so.Twist([-1.0, 0.0, 0.0], np.zeros(3)))
    moved = {**pair, "path_a": HOME, "path_b": moving, "duration": 0.01}
    law = so.PaperLaw(tolerance=1e-9, gain=100.0, feedforward=False)
    along = {name: moved[name] for name in ("path_a", "path_b", "duration")}
    tables: dict[str, tuple[ModuleType, dict[str, Any]]] = {
        "PaperLaw": (so, {"tolerance": 1e-9, "gain": 100.0, "deadline": 40}),
        "PredictorCorrector": (so, {"tolerance": 1e-9, "deadline": 40}),
        "Tracker": (so, {**pair, "dt": 1e-3, "law": law}),
        "World": (so, {"bodies": {"ball": SPHERE, "box": BOX}, "within": 0.5, "dt": 1e-3}),
        "Solid": (so, {"boundary": BOX, "volume": 1.0, "area": 6.0, "relative": 1e-6}),
        "compound": (so, {"pieces": {"ball": SPHERE, "box": (BOX, AWAY)}}),
        "PointTracker": (so, {"body": DISC, "dt": 1e-3, "law": so.PaperLaw()}),
        "distance": (so, posed),
        "distances": (so, {**pair, "poses_a": np.eye(4), "poses_b": np.eye(4)[None], "workers": 1}),
        "open_recording": (so, {"path": "no_such_file.parquet"}),
        "plot": (so, {**pair, "answer": so.distance(*posed.values()), "view": (20.0, 30.0)}),
        "pair_system": (
            so.tracking,
            {**posed, "place_a": (so.Feature("vertex", 0), ()), "place_b": (("face", 0), (0, 0))},
        ),
        "record_point": (
            so.points,
            {
                "tracker": so.PointTracker(DISC),
                "path": motion.Fixed(so.Pose(np.eye(3), [2.0, 0.0, 0.0])),
                "times": [0.0, 1e-3],
            },
        ),
        "track": (so, {"tracker": so.Tracker(SPHERE, BOX, 1e-3), **along}),
        "shape_gradient": (
            so,
            {"answer": so.distance(*posed.values()), "a": so.Design(so.shapes.sphere, radius=0.5)},
        ),
        "time_of_impact": (so, {**moved, "start": 0.0, "tolerance": 1e-9, "clearance": 0.0}),
        "voronoi_regions": (
            so,
            {"body": so.shapes.planar_loop(LOOP), "reach": 1.0, "tolerance": 1e-6},
        ),
        "witness_set": (
            so,
            {"proximity": so.distance(*posed.values()), "pose_a": HOME, "pose_b": AWAY},
        ),
        "basin": (
            control,
            {
                "tracker": so.Tracker(SPHERE, BOX),
                "pose_a": HOME,
                "pose_b": AWAY,
                "starts": [((("vertex", 0), ()), (("face", 0), (0.0, 0.0)))],
                "steps": 1,
            },
        ),
        "lyapunov_level": (control, {**posed, "directions": 4, "seed": 0}),
    }
    return [
        Call(f"{module.__name__.split('.')[-1]}.{name}", getattr(module, name), arguments)
        for name, (module, arguments) in tables.items()
    ]
