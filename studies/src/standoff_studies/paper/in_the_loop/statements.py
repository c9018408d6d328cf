"""What Fig. 5 says, and what the run measures."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from standoff import simulation as sim
from standoff.bodies.features import feature_of
from standoff.typing import Array
from standoff_studies.paper.figure import Statement, measured_by, own_statement
from standoff_studies.paper.in_the_loop.run import (
    BALL,
    CONTACT,
    GAINS,
    PERIOD,
    Runs,
    dragged,
    exact_distances,
    operator,
)
from standoff_studies.paper.law_words import law_words

CLOSE = 1e-6
"""Greatest error of the law's distance that counts as tracked [m]: a thousandth of the depth."""

ROUND = 1e-3
"""Fraction by which a step of force may exceed what explains it: chords are shorter than curves."""


class Steps(NamedTuple):
    """Steps of the contact's force from record to record, and an upper bound for each [N]."""

    taken: Array
    explained: Array


def all_statements(runs: Runs) -> tuple[Statement, ...]:
    """Return every statement of the figure."""
    parts = (_features(runs), _one_state(runs), _smooth(runs), _energy(runs), _beside(runs))
    by = law_words(runs.operator, told="inside the operator")
    return measured_by(by, (*parts, _gains(), _cost(runs)))


def kinds_touched(runs: Runs) -> list[str]:
    """Return the lens's features in contact, in order, as "face 0" and so on."""
    touching = runs.inside.spots[:, 0] > 0
    names = [str(feature_of(runs.lens, int(k))) for k in runs.answers.mode[touching, 0]]
    return [name for k, name in enumerate(names) if k == 0 or name != names[k - 1]]


def force_steps(runs: Runs) -> Steps:
    """Return steps of the contact's force, and what explains them: stiffness, damping and motion.

    A ball's force is k d^1.5 (1 + 1.5 c d') along its normal, with friction. Along the normal it
    changes by its derivative by depth times the change of the certified depth, plus its derivative
    by the rate times the change of the rate; across it, by the force over the remaining radius,
    times the displacement, since this is how fast the normal turns at edges and vertices, where it
    turns fastest. Friction follows the force, and turns with the slip.
    """
    run = runs.inside
    v, depth = run.velocities(1), np.maximum(0.0, -runs.exact)
    moved = np.linalg.norm(np.diff(run.positions(1), axis=0), axis=1)
    deeper, pressed = np.maximum(depth[1:], depth[:-1]), np.abs(np.diff(depth))
    turn = moved / (BALL - deeper)
    speed = np.linalg.norm(v, axis=1)
    changed = np.linalg.norm(np.diff(v, axis=0), axis=1) + turn * np.maximum(speed[1:], speed[:-1])
    spring = CONTACT.stiffness * deeper**1.5
    gain = 1.0 + 1.5 * CONTACT.damping * (pressed / PERIOD + changed)
    along = 1.5 * CONTACT.stiffness * np.sqrt(deeper) * gain * pressed
    along += 1.5 * CONTACT.damping * spring * changed
    across = spring * gain * turn
    grip = CONTACT.friction * (along + spring * gain * (turn + changed / CONTACT.slip_speed))
    taken = np.linalg.norm(np.diff(run.forces[:, 0], axis=0), axis=1)
    return Steps(taken, along + across + grip)


def grown(run: sim.SystemRun) -> float:
    """Return the greatest excess of stored and dissipated contact energy over the energy put in, as
    a fraction of the hand's greatest work. A spring held over a tick adds K/2 |Δx|².
    """
    coupler, system = run.coupler, run.system
    assert coupler is not None
    assert system.coupler is not None
    way = np.diff(coupler.handle_positions, axis=0, prepend=np.nan)
    squares = np.nan_to_num(np.sum(way * way, axis=1))
    came = coupler.energy.device + 0.5 * system.coupler.stiffness * np.cumsum(squares)
    held = run.energy.mechanical + run.energy.dissipated + coupler.stored
    return float((held - held[0] - came).max() / np.abs(coupler.energy.device).max())


def _features(runs: Runs) -> Statement:
    names = kinds_touched(runs)
    seen = {name.split()[0] for name in names}
    return Statement(
        "Fig. 5",
        "the tool is felt through the coupler as it rides over face, edge and vertex",
        f"in contact: {', '.join(names)}; no fault, no limit",
        seen == {"face", "edge", "vertex"}
        and runs.coupler.counts.faults + runs.coupler.counts.force_limits == 0,
    )


def _one_state(runs: Runs) -> Statement:
    error = float(np.abs(runs.exact - runs.inside.distances[:, 0]).max())
    cores = float((runs.inside.distances[:, 0] + BALL).min())
    return Statement(
        "Fig. 5",
        "tracker and dynamics are integrated together; the poses of a stage are known to nobody "
        "before",
        f"the law's distance is off the certified one by {1e9 * error:.0f} nm at most",
        error < CLOSE and cores > 0.0,
        "The ball is a point swept by a radius: the witness points of lens and point stay "
        f"{1e3 * cores:.1f} mm apart or more, where the printed law has its full rank, in contact "
        "too.",
    )


def _smooth(runs: Runs) -> Statement:
    steps = force_steps(runs)
    touching = steps.explained > 0.0
    part = float((steps.taken[touching] / steps.explained[touching]).max())
    mode = runs.answers.mode[:, 0]
    switched = np.flatnonzero((np.diff(mode) != 0.0) & (runs.inside.spots[1:, 0] > 0))
    return Statement(
        "Fig. 5",
        "forces are rendered without jumps where the closest features change",
        f"largest step of force {steps.taken.max():.3f} N, {part:.2f} of what stiffness, damping "
        f"and motion explain; at the {len(switched)} switches in contact "
        f"{steps.taken[switched].max(initial=0.0):.3f} N",
        part <= 1.0 + ROUND and len(switched) >= 3,
    )


def _energy(runs: Runs) -> Statement:
    part, least = grown(runs.inside), float(runs.coupler.energy.least.min())
    return own_statement(
        "Fig. 5",
        f"what is held and was lost in contact passes what came in by {part:.0e} of the hand's "
        f"work at most; the observer of the coupler's ports never falls below {least:.0e} J",
    )


def _beside(runs: Runs) -> Statement:
    apart = np.linalg.norm(runs.inside.positions(1) - runs.beside.positions(1), axis=1)
    return own_statement(
        "Fig. 5",
        "with a certified tracker beside the operator, whose forces are held over a tick, the tool "
        f"goes elsewhere by {1e6 * apart.max():.1f} µm at most",
    )


@cache
def by_gain() -> dict[str, Array]:
    """Return the greatest errors of the law's distance by its gain [1/s, m], and force [N]."""
    errors, forces = [], []
    for gain in GAINS:
        made = dragged(operator(gain=gain))
        errors.append(float(np.abs(exact_distances(made) - made.distances[:, 0]).max()))
        forces.append(float(np.linalg.norm(made.forces[:, 0], axis=1).max()))
    return {
        "gain_per_s": np.array(GAINS),
        "greatest_error_m": np.array(errors),
        "greatest_force_n": np.array(forces),
    }


def _gains() -> Statement:
    made = by_gain()
    told = ", ".join(
        f"{1e9 * e:.0f} nm at {k:g}/s" for k, e in zip(GAINS, made["greatest_error_m"], strict=True)
    )
    return Statement(
        "Fig. 5",
        "a very low gain suffices",
        f"greatest error of the law's distance: {told}",
        bool((made["greatest_error_m"] < CLOSE).all()),
    )


def _cost(runs: Runs) -> Statement:
    inside, beside = (runs.microseconds[name] for name in ("inside", "beside"))
    return Statement(
        "Fig. 5",
        "the loop runs at 1 kHz",
        f"a tick of coupler, dynamics, contact and tracker takes {inside:.0f} µs with the law "
        f"inside, {beside:.0f} µs beside",
        inside < 1e6 * PERIOD,
        "Timed as this page was made; without the device, which is simulated in Python.",
    )
