"""Take docs/images/live-simulation.png: the live page of a peg in its bush and a box in Chromium.

Run: python docs/images/make_live_simulation_picture.py [FILE].
Needs the extra `view`, playwright and Chromium.
"""

import numpy as np
from make_live_solids_picture import take, target
from make_peg_picture import turned

import standoff as so
from standoff import simulation as sim
from standoff.view.shown_simulation import Simulated
from standoff.view.simulation_page import SimulationPage

WINDOW = {"width": 1280, "height": 860}
NAMES = ("plate", "bush", "peg", "box")
STEEL = 7800.0  # kg/m³


def run() -> sim.SystemRun:
    """A peg that leans in its bush, both solids, and a box beside, on a plate; metres."""
    plate = so.shapes.box((0.32, 0.2, 0.02))
    box = so.shapes.box((0.06, 0.06, 0.06))
    bush = turned((0.03, 0.05), 0.0, 0.06, "bush")
    peg = turned((0.0285,), 0.0, 0.16, "peg")
    aside = [-0.06, 0.0, 0.0]
    bodies = [
        sim.RigidBody.fixed(plate, pose=so.Pose(np.eye(3), [0.0, 0.0, -0.01])),
        sim.RigidBody.fixed(bush, pose=so.Pose(np.eye(3), aside)),
        sim.RigidBody.free(peg, density=STEEL, pose=so.Pose(np.eye(3), [-0.0595, 0.0, 1e-4])),
        sim.RigidBody.free(box, density=STEEL, pose=so.Pose(np.eye(3), [0.09, 0.0, 0.0301])),
    ]  # fmt: skip
    law = sim.HuntCrossley(stiffness=5e6, damping=20.0, friction=0.3, slip_speed=0.02, depth=2e-4)
    pairs = [(0, 2), (1, 2), (0, 3)]
    gravity = (2.5, -0.8, -9.81)  # so that both lean
    operator = sim.Operator(sim.System(bodies, law, pairs, gravity), dt=5e-5)
    return operator.run(operator.start(), ticks=10_000, every=100, contacts=True)


def main() -> None:
    found = run()
    given = Simulated(found, "A peg in its bush, and a box", "m", NAMES)
    with SimulationPage(given) as page:
        page.seek(float(found.times[-1]))
        camera = (0.13, -0.44, 0.2), (0.055, 0.0, 0.04)
        take(page, target("live-simulation.png"), WINDOW, "Contacts", camera)


if __name__ == "__main__":
    main()
