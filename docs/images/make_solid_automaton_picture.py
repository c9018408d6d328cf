"""The picture of an automaton of solids: ``python docs/images/make_solid_automaton_picture.py``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from make_minima_picture import bridge

import standoff as so

HERE = Path(__file__).parent


def main() -> None:
    tracker = so.Tracker(bridge(), so.shapes.sphere(0.3), dt=0.0127, minima=0.75)
    start = so.Pose(np.eye(3), (0.2, 1.5, 0.5))
    across = so.motion.ConstantTwist(start, so.Twist((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    recording = so.track(tracker, so.Pose.identity(), across, 2.6)
    recording.automaton().plot().savefig(HERE / "solid-automaton.png", dpi=100)


if __name__ == "__main__":
    main()
