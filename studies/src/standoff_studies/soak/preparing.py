"""Compiling, or loading, everything that the soak's pairs call, before their clock starts."""

from __future__ import annotations

import numpy as np

from standoff.kernels.entries.preparing import prepare_all
from standoff_studies.soak.adversary import run_round
from standoff_studies.soak.cases import Case
from standoff_studies.soak.motions import Motion, Path
from standoff_studies.soak.running import run_case
from standoff_studies.soak.shapes import KINDS, Made, Shape, made

AWAY = 100.0
"""Distance between the origins of the pair: lengths are at most 10."""

OWN_MACHINE_CODE = "formula"
"""Kinds of bodies that compile their own machine code, a second or two in each process: that is not
part of the kernels, and counts as the pair's time."""


def compile_kernels() -> None:
    """Prepare all kernels: make a body of every kind, track and query a pair, and run a round."""
    prepare_all()
    rng = np.random.default_rng(0)
    bodies = [
        made(Shape(name, kind.draw(rng)))
        for name, kind in KINDS.items()
        if not name.startswith(OWN_MACHINE_CODE)
    ]
    bounded = [one for one in bodies if one.body.bounded]
    _run(bounded[-1], bounded[0])
    run_round(0, 0, 1)


def _run(a: Made, b: Made) -> None:
    still = np.eye(3).tolist()
    motion = Motion(Path(still, [0.0, 0.0, 0.0]), Path(still, [AWAY, 0.0, 0.0]), step=1e-3)
    case = Case(0, 0, "apart", a.shape, b.shape, motion, {}, 2)
    run_case(case, a, b, motion.frames(case.frames))
