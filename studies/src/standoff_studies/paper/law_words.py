"""The law with which a number was measured, in words, from the record of the trackers."""

from __future__ import annotations

from typing import Any

from standoff.points import PointTracker
from standoff.recording import Recording
from standoff.simulation import Operator
from standoff.tracking import Tracker
from standoff.tracking.law_options import Law, options_of
from standoff.tracking.laws import PaperLaw

Ran = Tracker | PointTracker | Recording | Operator
"""Objects that keep a record of their law."""

NAMED = "as named"
"""For an option in which the trackers differ, so that the statement itself gives its value."""

WORDS: dict[str, dict[Any, str]] = {
    "solve": {
        "plain": "M as it is",
        "ranked": "M by the rank rule",
        "covariant": "M covariant, by the rank rule",
    },
    "switching": {
        "voronoi": "Voronoi tests",
        "multipliers": "switching by multipliers",
        "none": "no switching",
    },
    "saturation": {"zero": "saturation zeroed", "hold": "edges held"},
    "far_side": {"kept": "", "left": "faces left on the far side"},
    "reset": {"nearest": "resets by the pcurve", "foot": "resets to the foot point"},
    "restarts": {False: "no restarts", True: "restarts"},
    "feedforward": {True: "", False: "no feedforward"},
    "realisation": {"evaluated": "", "integrated": "Ψ integrated"},
}
"""Values of the paper's law, in this order; empty for those of Eq. (12) and Fig. 4."""

MOST_GAINS = 3
"""The greatest number of gains that are listed; with more, the statement gives its own."""

PRINTED = ("saturation", "reset", "restarts")
"""Options that the name ``as_printed`` implies."""

INTEGRATORS = {"euler": "Euler", "heun": "Heun", "rk4": "RK4"}


def law_words(*ran: Ran, told: str = "") -> str:
    """Return which law some trackers followed, with its options.

    Only their record is read, so a study whose law is replaced says so. Options that differ from
    tracker to tracker are "as named", that is, given by the statement.

    Parameters
    ----------
    *ran : Tracker, PointTracker, Recording or Operator
        At least one.
    told : str
        What no record contains, such as the start.
    """
    kinds: dict[type[Law], list[Ran]] = {}
    for one in ran:
        kinds.setdefault(type(law_of(one)), []).append(one)
    words = [_of_one_kind(own) for own in kinds.values()]
    return "; ".join([*words, *filter(None, [told])])


def law_of(ran: Ran) -> Law:
    """Return the law that a tracker or a recording has followed, resolved."""
    if isinstance(ran, Recording):
        return ran.info.law
    if isinstance(ran, Operator):
        return ran.laws[0].resolved(ran.dt)
    return ran.resolved_law if isinstance(ran, Tracker) else ran.law


def step_of(ran: Ran) -> float:
    """Return the frame time of a tracker or a recording [s]."""
    return float(ran.info.options["dt"]) if isinstance(ran, Recording) else ran.dt


def printed(law: Law) -> bool:
    """Is a law the system as printed, with any gain and integrator?"""
    if not isinstance(law, PaperLaw) or law.gain is None:
        return False
    options = {"integrator": law.integrator, "far_side": law.far_side}
    return law == PaperLaw.as_printed(gain=law.gain, **options)


def _of_one_kind(ran: list[Ran]) -> str:
    """The words for trackers whose laws are of the same class."""
    laws, steps = [law_of(one) for one in ran], {step_of(one) for one in ran}
    frame = f"{1e3 * steps.pop():g} ms" if len(steps) == 1 else f"frames {NAMED}"
    facts = [law.facts() for law in laws]
    values = {
        name: facts[0][name] if all(one[name] == facts[0][name] for one in facts) else NAMED
        for name in options_of(laws[0])
    }
    if not isinstance(laws[0], PaperLaw):
        words = ["the library's own law, so.PredictorCorrector", frame]
        return ", ".join([*words, *_others(laws[0], values)])
    as_printed = all(map(printed, laws))
    name = "so.PaperLaw.as_printed" if as_printed else "so.PaperLaw"
    integrator, _ = values.pop("integrator"), values.pop("gain")
    words = [
        INTEGRATORS.get(integrator, f"integrator {integrator}"),
        _gain([one["gain"] for one in facts], values.pop("feedback")),
        frame,
    ]
    if values["switching"] not in ("voronoi", NAMED):
        del values["reset"], values["far_side"]  # options of those tests only
    for option in [option for option in WORDS if option in values]:
        value = values.pop(option)
        if not (as_printed and option in PRINTED):
            words.append(_option(option, value))
    return f"{name}: " + ", ".join([*filter(None, words), *_others(laws[0], values)])


def _gain(gains: list[float], feedback: Any) -> str:
    """The gains of some laws, each once, or their feedback."""
    if feedback is not None:
        return f"feedback {feedback if feedback == NAMED else feedback['kind']}"
    different = sorted(set(gains))
    if len(different) > MOST_GAINS:
        return f"K {NAMED}"
    return f"K = {' or '.join(f'{gain:g}' for gain in different)}/s"


def _option(name: str, value: Any) -> str:
    """An option in words; a value without words by name."""
    return f"{name} {NAMED}" if value == NAMED else WORDS[name].get(value, f"{name}={value!r}")


def _others(law: Law, values: dict[str, Any]) -> list[str]:
    """The options that have no words, if they differ from the default."""
    defaults = {name: each.default for name, each in options_of(law).items()}
    return [
        f"{name} {NAMED}" if value == NAMED else f"{name}={value!r}"
        for name, value in values.items()
        if value != defaults[name]
    ]
