"""One step of the whole operator, by any of five methods.

Euler, Heun, midpoint and the classical method of order four are those of the paper's law, each
stage of which uses only the stage before. The semi-implicit one is for stiff contact: momenta by
the forces at the start, then poses by the new momenta.
"""

from standoff.kernels.algebra.rigid import read_rotation
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import (
    FREE,
    I_INSIDE,
    I_METHOD,
    R_GIVEN,
    R_LOST,
    R_SHARED,
    S_GIVEN,
    S_LOST,
    S_SHARED,
    X_ROTATION,
    body_rates,
    body_row,
    kind_of,
    n_bodies,
    n_pairs,
    n_rates,
    pair_rates,
)
from standoff.kernels.dynamics.crossing import exchange
from standoff.kernels.dynamics.rigid_body import (
    along_rates,
    orthonormal,
    put,
    stand,
    step_semi_implicit,
)
from standoff.kernels.dynamics.system import drive, renew_rates, stage_of
from standoff.kernels.paper.integrators import NAMES, NODES, STAGES, WEIGHTS

SEMI_IMPLICIT = len(NAMES)
METHODS = (*NAMES, "semi-implicit")


@kernel
def place_bodies(system, state, s, rates, drives, row, scratch):
    """The bodies at a stage, a time s along their rates; those driven, by a row of the table."""
    for body in range(n_bodies(system)):
        o = body_row(body)
        if kind_of(system, body) == FREE:
            along_rates(state, o, s, rates, body_rates(body), scratch.stage, o)
        else:
            stand(state, o, scratch.stage, o)
    drive(system, drives, row, scratch.stage)


@kernel
def step_explicit(system, state, h, drives, tick, work, scratch):
    """A step of a Runge-Kutta method: its rates, weighted, into `total`; those of its first stage
    into `first`.
    """
    method = system.layout[I_METHOD]
    count = n_rates(system)
    for k in range(count):
        scratch.rates[k], scratch.total[k] = 0.0, 0.0
    for stage in range(STAGES[method]):
        c = NODES[method, stage]
        s = c * h
        # half ticks are the only nodes between
        place_bodies(system, state, s, scratch.rates, drives, 2 * tick + int(2.0 * c), scratch)
        held = stage > 0 and not system.layout[I_INSIDE]
        stage_of(system, state, s, held, scratch.rates, work, scratch)
        for k in range(count):
            if stage == 0:
                scratch.first[k] = scratch.rates[k]
            scratch.total[k] += WEIGHTS[method, stage] * scratch.rates[k]
    for body in range(n_bodies(system)):
        if kind_of(system, body) == FREE:
            o = body_row(body)
            along_rates(state, o, h, scratch.total, body_rates(body), scratch.stage, o)


@kernel
def step_stiff(system, state, h, drives, tick, work, scratch):
    """The semi-implicit step; the tracker's rates are those of the start with the new twists."""
    count = n_rates(system)
    for k in range(count):
        scratch.rates[k] = 0.0
    place_bodies(system, state, 0.0, scratch.rates, drives, 2 * tick, scratch)
    stage_of(system, state, 0.0, False, scratch.rates, work, scratch)
    for k in range(count):
        scratch.total[k], scratch.first[k] = scratch.rates[k], scratch.rates[k]
    for body in range(n_bodies(system)):
        if kind_of(system, body) == FREE:
            o = body_row(body)
            step_semi_implicit(
                system, body, state, o, h, scratch.rates, body_rates(body), scratch.stage
            )
    if system.layout[I_INSIDE]:
        for pair in range(n_pairs(system)):
            renew_rates(system, pair, state, scratch.total, work, scratch)


@kernel
def step_bodies(system, state, h, drives, tick, work, scratch):
    """One tick of bodies and energies, in place; the tracker's rates are left in the scratch."""
    if system.layout[I_METHOD] == SEMI_IMPLICIT:
        step_stiff(system, state, h, drives, tick, work, scratch)
    else:
        step_explicit(system, state, h, drives, tick, work, scratch)
    drive(system, drives, 2 * tick + 2, scratch.stage)
    exchange(scratch.stage, state, scratch.ways, system)
    for body in range(n_bodies(system)):
        if kind_of(system, body) == FREE:
            o = body_row(body)
            put(orthonormal(read_rotation(state, o + X_ROTATION)), state, o + X_ROTATION)
    state[S_LOST] += h * scratch.total[R_LOST]
    state[S_GIVEN] += h * scratch.total[R_GIVEN]
    state[S_SHARED] += h * scratch.total[R_SHARED]


@kernel
def change_of(system, pair, h, rates):
    """A pair's parameters times h of their rates."""
    o = pair_rates(system, pair)
    return h * rates[o], h * rates[o + 1], h * rates[o + 2], h * rates[o + 3]
