"""What Fig. 7 states, and what was measured."""

from __future__ import annotations

import math

import numpy as np

from standoff_studies.paper.figure import Statement, measured_by, own_statement
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.simulation_a import gains
from standoff_studies.paper.simulation_a.run import SETTLED, Run
from standoff_studies.paper.simulation_a.setting import STEP
from standoff_studies.paper.unaided import Part, unaided

STATED = (75, 10)
"""The paper's steps to the steady state at K = 100 and 1000 1/s."""

LEVELS = (1e-2, 3e-3, 2e-3, 1.2e-3, 1e-3)
"""Cosines below which the steps are counted: within the levels that fit, and next to them."""

TOLD = "from Fig. 6's wrong start if not told otherwise"
"""What the record of the trackers does not contain."""

ABOUT = 0.15
"""Fraction by which a number may differ from the paper's "about 75" or "about 10" steps."""


def statements(slow: Run, fast: Run) -> tuple[Statement, ...]:
    """Fig. 7's statements, for the runs at K = 100 and K = 1000 1/s."""
    made = (
        _steps(slow, STATED[0]),
        _steps(fast, STATED[1]),
        _as_cosines(slow, fast),
        _monotone(slow, fast),
        _stated_range(),
        _upper_end(),
        _lower_end(),
        _theory(),
        _starts(),
        _slowness(),
        _without_feedforward(),
    )
    both = slow.recording, fast.recording
    by = law_words(*both, told=TOLD)
    return (*measured_by(by, made), unaided([Part.of(one) for one in both], by))


def _steps(made: Run, stated: int) -> Statement:
    steps = made.steps
    return Statement(
        "Fig. 7",
        f"K = {made.gain:g} 1/s: about {stated} steps to the steady state",
        f"{steps} steps until both errors stay below {SETTLED:g} of their first; linear theory "
        f"{int(gains.predicted_steps(made.gain))}",
        steps is not None and abs(steps - stated) <= ABOUT * stated,
    )


def fitting_levels(slow: Run, fast: Run) -> tuple[float, float]:
    """The levels of the cosines at which both counts are `ABOUT` the paper's: above the first
    number, up to the second; there are none if the first is greater."""
    ends = [
        made.levels_between(math.ceil((1.0 - ABOUT) * of), math.floor((1.0 + ABOUT) * of))
        for made, of in zip((slow, fast), STATED, strict=True)
    ]
    return max(low for low, _ in ends), min(high for _, high in ends)


def _as_cosines(slow: Run, fast: Run) -> Statement:
    """The paper normalises by the lengths of ΔR and of the tangent, and gives no level."""
    low, high = fitting_levels(slow, fast)
    told = ", ".join(
        f"{slow.steps_below(level)} and {fast.steps_below(level)} below {level:g}"
        for level in LEVELS
    )
    return Statement(
        "Fig. 7",
        "errors as cosines: about 75 steps at K = 100 1/s and about 10 at K = 1000 1/s",
        f"both counts are within {ABOUT:.0%} of the paper's at every level from {low:.4f} to "
        f"{high:.4f}; steps until both cosines stay below a level: {told}",
        None if low < high else False,
        "the paper does not name the level; its start and patch are not ours",
    )


def _monotone(slow: Run, fast: Run) -> Statement:
    tried = gains.settling()
    last = float(tried.gain[int(np.argmin(tried.monotone)) - 1])
    return Statement(
        "Fig. 7",
        "the errors decay monotonically",
        f"from this start no error grows in any step at any tried K from {gains.GAINS[0]:g} up to "
        f"{last:g} 1/s; of all starts on the patch at {_monotone_share(1000.0):.1%} with "
        f"K = 1000 1/s, {_monotone_share(1500.0):.1%} with 1500",
        slow.monotone and fast.monotone,
        "In theory a step multiplies errors by 1 − Kh + (Kh)²/2 ≥ 0.5, so they never change sign; "
        "the rest is the second order of large errors, which couples them.",
    )


def _monotone_share(gain: float) -> float:
    return float(gains.trials().monotone[gains.TRIED_GAINS.index(int(gain))].mean())


def _stated_range() -> Statement:
    made = gains.settling()
    low, high = gains.STATED
    within = (made.gain >= low) & (made.gain <= high)
    settled = np.isfinite(made.steps[within])
    return Statement(
        "Fig. 7",
        f"by experiment K from {low:g} to {high:g} 1/s is stable at 1 kHz",
        f"stable here: from the start of Fig. 6 both errors fall below {SETTLED:g} of their first "
        f"and stay there. So they do at {settled.sum()} of {within.sum()} gains in that range",
        bool(settled.all()),
        "That judges the inside of the range; its two ends are judged below.",
    )


def _upper_end() -> Statement:
    made, high = gains.settling(), gains.STATED[1]
    settled = made.gain[np.isfinite(made.steps)]
    steps = dict(zip(made.gain.tolist(), made.steps.tolist(), strict=True))
    return Statement(
        "Fig. 7",
        f"by experiment {high:g} 1/s is the upper limit of a stable K at 1 kHz",
        f"not met: from the start of Fig. 6 the errors settle up to {settled[-1]:g} 1/s, the last "
        f"gain tried, there in {steps[settled[-1]]:.0f} steps; of {gains.GRID**2} starts all over "
        f"the patch {gains.settled_share(high):.1%} settle at {high:g} 1/s and "
        f"{gains.settled_share(1900.0):.1%} at 1900",
        None if settled[-1] > high else True,
        "Such a limit depends on the patch and the starts, and the paper gives neither.",
    )


def _lower_end() -> Statement:
    made, low = gains.settling(), gains.STATED[0]
    steps = dict(zip(made.gain.tolist(), made.steps.tolist(), strict=True))
    least = made.gain[np.isfinite(made.steps)][0]
    return Statement(
        "Fig. 7",
        f"by experiment {low:g} 1/s is the lower limit of a stable K at 1 kHz",
        f"not met: from the start of Fig. 6 the errors settle at {low:g} 1/s after "
        f"{steps[low]:.0f} steps, {steps[low] * STEP:.1f} s, and at {least:g} 1/s, the least gain "
        f"tried, after {steps[least]:.0f}; at {low:g} 1/s a run from the right start stays below "
        f"{gains.steady().forward[0]:.0e} [length²]",
        None if least < low else True,
        "With the feedforward Ψ' = −KΨ decays for every K > 0; the paper does not say what is too "
        "slow.",
    )


def _theory() -> Statement:
    limit = gains.small_error_limit()
    return own_statement(
        "Fig. 7",
        f"stable here: an error of {gains.SMALL:g} in the parameters does not grow, the point at "
        f"rest; its growth a step, measured at K = {gains.NEAR[0]:g} and {gains.NEAR[1]:g} 1/s, "
        f"reaches 1 at {limit:.1f} 1/s. Linear theory: K h < 2 for Heun's method, "
        f"K < {gains.LIMIT:g} 1/s at 1 kHz, and so.Tracker refuses more",
    )


def _starts() -> Statement:
    trials = gains.trials()
    failed = trials.steps < 0
    home, of = gains.rescued()
    worst = failed.mean(axis=1).max()
    return own_statement(
        "Fig. 7",
        f"stable here: every one of {gains.GRID**2} starts on the patch settles; so it is up to "
        f"K = {gains.greatest_for_all():g} 1/s, above that up to {worst:.1%} of the starts fail "
        f"({trials.indefinite.sum()} of {of} failures after H lost positive definiteness at a "
        f"stage); the tracker's safeguards bring {home} of those {of} home",
        "Heun's trial stage goes (Kh − 1) times the error beyond the minimum: from far away it "
        "leaves the region where H is positive definite. So a limit found by experiment from "
        "large errors is below 2000, as the paper's 1500 is.",
    )


def _slowness() -> Statement:
    made = gains.settling()
    steps = dict(zip(made.gain.tolist(), made.steps.tolist(), strict=True))
    steady = gains.steady()
    swell = steady.forward[-1] / steady.forward[steady.gain.tolist().index(1000.0)]
    return own_statement(
        "Fig. 7",
        f"above K = 1000 1/s more gain is slower: {steps[1000.0]:.0f} steps at 1000 1/s, "
        f"{steps[1500.0]:.0f} at 1500, {steps[1900.0]:.0f} at 1900, {steps[1990.0]:.0f} at 1990; "
        f"and the steady error at {steady.gain[-1]:g} 1/s is {swell:.0f} times that at 1000",
        "1 − Kh + (Kh)²/2 is least, 0.5, at Kh = 1 and back at 1 for Kh = 2; the steady error "
        "grows as 1/(1 − Kh/2).",
    )


def _without_feedforward() -> Statement:
    steady = gains.steady()
    first = float(np.abs(gains.first_errors()).max())
    low, mid = steady.without[0], float(steady.without[steady.gain.tolist().index(100.0)])
    need = gains.greatest_feedforward() / (SETTLED * first)
    return own_statement(
        "Fig. 7",
        f"without the feedforward the errors stay at b/K: {mid:.3f} [length²] at K = 100 1/s "
        f"(max|b|/K = {gains.greatest_feedforward() / 100.0:.3f}), {low:.2f} at 0.5; below "
        f"{SETTLED:g} of the first error, {SETTLED * first:.4f} [length²], takes K above "
        f"{need:.0f} 1/s",
        "This is the lower limit that the motion sets: K ≥ max|b|/Ψ for a tolerance Ψ.",
    )
