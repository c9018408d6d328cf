"""Parameters of a contact of two geoms, by MuJoCo's own rules.

MuJoCo gives its rules in ``XMLreference.html#body-geom`` and applies them inside ``mj_collision``,
which hands them out only with contacts of its own; a test compares the two.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.errors import of_extra
from standoff.robots.tolerances import LEAST_FRICTION
from standoff.typing import Array

with of_extra("MuJoCo", "mujoco"):
    import mujoco


class Mixed(NamedTuple):
    """Of one pair of geoms: numbers of a contact, and how near they are when it is made."""

    dim: int
    solref: Array
    solreffriction: Array
    solimp: Array
    friction: Array
    margin: float
    gap: float


def mixed(model: Any, i: int, j: int) -> Mixed:
    """The parameters of geoms i and j: of the model's ``<pair>`` if it has one for them."""
    found = _of_pair(model, i, j) or _of_geoms(model, i, j)
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        opt = model.opt
        found = found._replace(
            solref=np.array(opt.o_solref),
            solreffriction=np.array(opt.o_solref),
            solimp=np.array(opt.o_solimp),
            friction=np.array(opt.o_friction),
            margin=float(opt.o_margin),
        )
    return found._replace(friction=np.maximum(found.friction, LEAST_FRICTION))


def _of_pair(model: Any, i: int, j: int) -> Mixed | None:
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for k, pair in enumerate(pairs):
        if pair in ((i, j), (j, i)):
            return Mixed(
                int(model.pair_dim[k]),
                np.array(model.pair_solref[k]),
                np.array(model.pair_solreffriction[k]),
                np.array(model.pair_solimp[k]),
                np.array(model.pair_friction[k]),
                float(model.pair_margin[k]),
                float(model.pair_gap[k]),
            )
    return None


def _of_geoms(model: Any, i: int, j: int) -> Mixed:
    priority = model.geom_priority
    if priority[i] != priority[j]:
        leader = i if priority[i] > priority[j] else j
        dim, solref = model.geom_condim[leader], model.geom_solref[leader]
        solimp, friction = model.geom_solimp[leader], model.geom_friction[leader]
    else:
        part = _part(float(model.geom_solmix[i]), float(model.geom_solmix[j]))
        a, b = model.geom_solref[i], model.geom_solref[j]
        standard = a[0] > 0.0 and b[0] > 0.0
        solref = part * a + (1.0 - part) * b if standard else np.minimum(a, b)
        solimp = part * model.geom_solimp[i] + (1.0 - part) * model.geom_solimp[j]
        friction = np.maximum(model.geom_friction[i], model.geom_friction[j])
        dim = max(model.geom_condim[i], model.geom_condim[j])
    return Mixed(
        int(dim),
        np.array(solref),
        np.zeros(mujoco.mjNREF),
        np.array(solimp),
        np.asarray(friction)[[0, 0, 1, 2, 2]],
        float(model.geom_margin[i] + model.geom_margin[j]),
        float(model.geom_gap[i] + model.geom_gap[j]),
    )


def _part(a: float, b: float) -> float:
    """The part of the first in a mean by weights of which either may be zero."""
    if max(a, b) < mujoco.mjMINVAL:
        return 0.5
    a, b = (x if x >= mujoco.mjMINVAL else 0.0 for x in (a, b))
    return a / (a + b)
