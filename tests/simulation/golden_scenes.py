"""Scenes whose traces are stored, and the file that stores them.

Run ``python tests/simulation/golden_scenes.py`` to write ``golden.npz`` anew: only where a change
of the operator's answers is meant. Each scene is one that does not multiply roundoff by much, so
that another machine's roundoff stays below 1e-12: bounces, slides and rolls, no tumbling.
"""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path
from typing import NamedTuple

import llvmlite.binding as llvm
import numpy as np
from numba.core import config

import standoff as so
from standoff import simulation as sim
from standoff.kernels.compiler.machine import source_digest, system
from standoff.kernels.dynamics import arrays as K

FILE = Path(__file__).parent / "golden.npz"
FLOOR = so.shapes.halfspace()
RECORDS = 25
"""Recorded states of each run, the first not counted."""


def build() -> str:
    """What decides every bit: the kernels' sources and compiler, the system and the processor."""
    features = ",".join(sorted(k for k, on in llvm.get_host_cpu_features().items() if on))
    numba = [str(config.OPT), str(config.CPU_NAME), str(config.CPU_FEATURES), config.ENABLE_AVX]
    said = [source_digest(), system(), llvm.get_host_cpu_name(), features, np.__version__, *numba]
    return hashlib.sha256(" ".join(map(str, said)).encode()).hexdigest()


def bounce(tracker: str) -> tuple[sim.Operator, int, bool]:
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=0.2, friction=0.3, slip_speed=0.05, depth=4e-3
    )
    ball = sim.RigidBody.free(
        so.shapes.sphere(0.1),
        density=1000.0,
        pose=so.Pose(np.eye(3), [0.0, 0.0, 0.12]),
        twist=so.Twist([0.3, 0.0, -1.0], [0.0, -2.0, 0.0]),
    )
    system = sim.System([sim.RigidBody.fixed(FLOOR), ball], contact)
    return sim.Operator(system, 2e-5, tracker=tracker), 2500, False


def pressed(tracker: str) -> tuple[sim.Operator, int, bool]:
    contact = sim.HuntCrossley(stiffness=2e4, damping=0.3, friction=0.3, slip_speed=0.5, depth=0.02)
    lower = sim.RigidBody.fixed(so.shapes.ellipsoid([0.4, 0.3, 0.2]))
    upper = sim.RigidBody.free(
        so.shapes.ellipsoid([0.15, 0.2, 0.1]),
        density=1000.0,
        pose=so.Pose.exp([0.3, -0.2, 0.4], [0.03, 0.02, 0.3]),
        twist=so.Twist([0.3, 0.2, 0.0], [1.0, -2.0, 0.5]),
    )
    operator = sim.Operator(sim.System([lower, upper], contact), 1e-4, "rk4", tracker)
    return operator, 250, True


def sliding(tracker: str) -> tuple[sim.Operator, int, bool]:
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=1.0, friction=0.4, slip_speed=5e-3, depth=1e-3
    )
    box = sim.RigidBody.free(
        so.shapes.box(0.3, 0.3, 0.1),
        density=1000.0,
        pose=so.Pose(np.eye(3), [0.0, 0.0, 0.0499]),
        twist=so.Twist([0.3, 0.1, 0.0], [0.0, 0.0, 0.5]),
    )
    system = sim.System([sim.RigidBody.fixed(FLOOR), box], contact)
    return sim.Operator(system, 5e-5, tracker=tracker), 1000, True


def edge(tracker: str) -> tuple[sim.Operator, int, bool]:
    """A ball passes from the face of a driven lens over its edge."""
    contact = sim.HuntCrossley(stiffness=1e6, damping=0.2, depth=4e-3)
    lens = sim.RigidBody.driven(
        so.shapes.lens(0.5, 0.225), so.motion.ConstantTwist(so.Pose.identity(), spin())
    )
    ball = sim.RigidBody.free(
        so.shapes.sphere(0.05),
        density=1000.0,
        pose=so.Pose(np.eye(3), [0.33, 0.004, 0.0]),
        twist=so.Twist([-0.4, 0.5, 0.1], [0.0, 0.0, 0.0]),
    )
    return sim.Operator(sim.System([lens, ball], contact), 5e-5, tracker=tracker), 1000, False


def spin() -> so.Twist:
    return so.Twist([0.0, 0.0, 0.0], [0.0, 0.0, -1.0])


SCENES = {
    f"{make.__name__}-{tracker}": (make, tracker)
    for make in (bounce, pressed, sliding, edge)
    for tracker in ("beside", "inside")
}


ENERGIES = ("kinetic", "potential", "stored", "dissipated", "supplied")
"""That stored traces have; convex bodies share no springs, and their states' header says so."""


class Trace(NamedTuple):
    """(n, k) arrays of a run's records, and a digest of every bit of them and of the trackers."""

    bodies: np.ndarray
    energies: np.ndarray
    forces: np.ndarray
    spots: np.ndarray
    digest: str


def trace(name: str) -> Trace:
    make, tracker = SCENES[name]
    operator, ticks, overlap = make(tracker)
    run = operator.run(operator.start(allow_overlap=overlap), ticks, every=ticks // RECORDS)
    end = K.STATE_HEADER + K.N_BODY * len(operator.system.bodies)
    energies = np.stack([getattr(run.energy, name) for name in ENERGIES], axis=1)
    bits = run.states.tobytes() + energies.tobytes() + run.forces.tobytes()
    digest = hashlib.sha256(bits).hexdigest()
    return Trace(run.states[:, :end], energies, run.forces[:, 0], run.spots, digest)


def main() -> None:
    found = {name: trace(name) for name in SCENES}
    if sys.argv[1:] == ["digests"]:
        print("\n".join(f"{name} {kept.digest}" for name, kept in found.items()))
        return
    arrays = {
        f"{name} {part}": array
        for name, kept in found.items()
        for part, array in kept._asdict().items()
    }
    np.savez_compressed(FILE, build=np.array(build()), **arrays)
    print(f"{FILE.name}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
