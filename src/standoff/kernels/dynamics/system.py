"""The right-hand side of the whole operator: bodies, contacts and tracker parameters together."""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import scale
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import (
    B_DRIVEN,
    E_SLOWED,
    FREE,
    I_INSIDE,
    N_BODY,
    N_DRIVEN,
    N_LOAD,
    R_GIVEN,
    R_LOST,
    R_SHARED,
    R_TURN,
    S_EASED,
    body_ints,
    body_rates,
    body_row,
    eased_row,
    kind_of,
    n_bodies,
    n_rates,
    options_of,
    pair_rates,
    pair_row,
    shared_row,
)
from standoff.kernels.dynamics.coupled_tool import add_pull, coupled
from standoff.kernels.dynamics.eased_friction import begin_friction, ease_friction
from standoff.kernels.dynamics.forces import Witness, clear_touch, moving_pair, touch_pair
from standoff.kernels.dynamics.inside_law import (
    near_contact,
    place_ahead,
    stage_normal,
    stage_rates,
)
from standoff.kernels.dynamics.near_arrays import n_visited, visited
from standoff.kernels.dynamics.pair_motion import packed_pair, write_motion
from standoff.kernels.dynamics.rigid_body import power, write_rates
from standoff.kernels.dynamics.solid_pairs import is_of_solids, touch_solids
from standoff.kernels.state.arrays import (
    FAR,
    N_STATE,
    STATUS,
)
from standoff.kernels.state.state import read_four, read_state
from standoff.kernels.values import Motion


@kernel
def clear_loads(system, scratch):
    for k in range(N_LOAD * n_bodies(system)):
        scratch.loads[k] = 0.0
    for body in range(n_bodies(system)):
        scratch.loads[eased_row(system, body) + E_SLOWED] = 0.0
    scratch.loads[shared_row(system)] = 0.0


@kernel
def touch_tracked(system, pair, state, rows, first, scratch):
    """A pair's contact at the tracker's own answer, at the start of a tick; the power it loses.

    A pair beyond its horizon has none: its witness points are those of an earlier tick.
    """
    if state[pair_row(system, pair) + N_STATE + STATUS] == FAR:
        clear_touch(scratch, pair)
        return 0.0
    if is_of_solids(system, pair):
        return touch_solids(system, pair, state, rows, first, scratch)
    before = read_state(ahead(state, pair_row(system, pair)))
    write_motion(system, pair, rows, first, scratch.motion)
    pose, n = moving_pair(scratch.motion).pose, before.normal
    packed = packed_pair(system, pair)
    if system.layout[I_INSIDE] and not near_contact(packed, before):
        n = stage_normal(packed, pose, before.place, False, n)
    witness = Witness(before.place, pose, n)
    return touch_pair(system, packed, pair, witness, rows, first, scratch.motion, scratch)


@kernel
def touch_ahead(system, pair, state, s, rates, work, scratch):
    """A pair's contact at a stage, a time s along its rates; its new rates are written in their
    place. Returns the power that it loses.
    """
    before = read_state(ahead(state, pair_row(system, pair)))
    write_motion(system, pair, scratch.stage, body_row(0), scratch.motion)
    motion = moving_pair(scratch.motion)
    packed = packed_pair(system, pair)
    o = pair_rates(system, pair)
    place = place_ahead(packed, before.place, s, read_four(rates, o))
    near = near_contact(packed, before)
    n = stage_normal(packed, motion.pose, place, near, before.normal)
    options = options_of(system, pair)
    w = stage_rates(packed, motion, place, n, near, options, before.integrated, work)
    for k in range(4):
        rates[o + k] = w[k]
    witness = Witness(place, motion.pose, n)
    rows = scratch.stage
    return touch_pair(system, packed, pair, witness, rows, body_row(0), scratch.motion, scratch)


@kernel
def renew_rates(system, pair, state, rates, work, scratch):
    """A pair's rates at the start, but with the twists of the bodies in the scratch."""
    before = read_state(ahead(state, pair_row(system, pair)))
    write_motion(system, pair, scratch.stage, body_row(0), scratch.motion)
    renewed = moving_pair(scratch.motion)
    motion = Motion(before.motion.pose, renewed.v, renewed.w)
    packed = packed_pair(system, pair)
    near, n, kept = near_contact(packed, before), before.normal, before.integrated
    options = options_of(system, pair)
    w = stage_rates(packed, motion, before.place, n, near, options, kept, work)
    for k in range(4):
        rates[pair_rates(system, pair) + k] = w[k]


@kernel
def bodies_rates(system, s, lost, rates, scratch):
    """Rates of bodies and energies at a stage, a time s from the start, of the loads."""
    given = 0.0
    for body in range(n_bodies(system)):
        r, o = body_rates(body), body_row(body)
        turned = scale(s, read_vector(rates, r + R_TURN))
        write_rates(system, body, scratch.stage, o, turned, scratch.loads, rates, r)
        if kind_of(system, body) != FREE:
            given -= power(body, scratch.stage, o, scratch.loads)
    rates[R_LOST], rates[R_GIVEN] = lost, given
    rates[R_SHARED] = scratch.loads[shared_row(system)]


@kernel
def touch_pairs(system, state, s, rates, work, scratch):
    """The loads at a stage, of contacts and of a coupler; the power that contacts lose."""
    clear_loads(system, scratch)
    lost = 0.0
    for k in range(n_visited(system, scratch)):
        pair = visited(scratch, k)
        if system.layout[I_INSIDE]:
            lost += touch_ahead(system, pair, state, s, rates, work, scratch)
        else:
            lost += touch_tracked(system, pair, state, scratch.stage, body_row(0), scratch)
    if coupled(system):
        add_pull(system, state, scratch.stage, body_row(0), scratch.loads)
    return lost


@kernel
def copy_rates(system, rates, source, target):
    """Those of the pairs, which a stage that is loaded twice begins with."""
    for k in range(pair_rates(system, 0), n_rates(system)):
        rates[target + k] = rates[source + k]


@kernel
def load_stage(system, state, s, rates, work, scratch):
    """`touch_pairs` with as much of the friction as a step bears."""
    behind = n_rates(system)
    copy_rates(system, rates, 0, behind)
    begin_friction(system, scratch.loads)
    lost = touch_pairs(system, state, s, rates, work, scratch)
    if not ease_friction(system, scratch.loads):
        return lost
    state[S_EASED] += 1.0 if s == 0.0 else 0.0
    copy_rates(system, rates, behind, 0)
    return touch_pairs(system, state, s, rates, work, scratch)


@kernel
def stage_of(system, state, s, held, rates, work, scratch):
    """All rates at a stage, whose bodies stand in the scratch, a time s after the start. `held`:
    the loads stay those of the start, as a tracker beside the operator leaves them.
    """
    lost = rates[R_LOST]
    if not held:
        lost = load_stage(system, state, s, rates, work, scratch)
    bodies_rates(system, s, lost, rates, scratch)


@kernel
def drive(system, drives, row, rows):
    """Set the bodies that are driven to a row of their motions, (pose, v, w) each, world."""
    for body in range(n_bodies(system)):
        column = system.layout[body_ints(body) + B_DRIVEN]
        if column >= 0:
            for k in range(N_BODY):
                rows[body_row(body) + k] = drives.table[drives.width * row + N_DRIVEN * column + k]
