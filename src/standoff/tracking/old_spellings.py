"""What 0.1 had of a law's options beside the tracker's, calls and attributes: refused, and spelt
anew."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ParamSpec, TypeVar

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.errors import StandoffTypeError
from standoff.real_numbers import shown
from standoff.tracking.law_options import Law, options_of
from standoff.tracking.laws import LAWS, PYTHON, PaperLaw, PredictorCorrector, every_option

P = ParamSpec("P")
R = TypeVar("R")

OPTIONS = tuple(every_option())
POSITIONAL = ("law", "predictor", "integrator", "gain", "tolerance")
"""The law's part of a tracker's arguments in 0.1, in their order."""

ATTRIBUTES = {name: f"law.{name}" for name in OPTIONS} | {"variants": "law"}
"""What trackers and a scene's settings had as attributes in 0.1, and where that is now."""

SIMULATE = ("a", "b", "path_a", "path_b", "duration", "dt")


def takes_a_law(
    new: str, before: Sequence[str], positional: Sequence[str] = POSITIONAL
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate what takes a law, so that 0.1's options beside it are told their new spelling.

    Parameters
    ----------
    new : str
        The call as it is to be written, with ``{law}`` for the law.
    before : sequence of str
        Its arguments before the law, ``self`` included.
    positional : sequence of str
        Those of 0.1 from the law on, that could be given by position.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            given = dict(zip((*before, *positional), args, strict=False)) | kwargs
            law = spelt_anew(given)
            if law:
                raise StandoffTypeError(
                    f"The options are the law's: write {new.format(law=law)}.", "law"
                )
            return function(*args, **kwargs)

        return checked

    return decorate


def takes_a_tracker(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate ``simulate``, so that the bodies of 0.1 are told to come in a tracker."""

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        named: Mapping[str, Any] = kwargs
        if (args and isinstance(args[0], Body)) or not named.keys().isdisjoint({"a", "b", "dt"}):
            given = {**dict(zip(SIMULATE, args, strict=False)), **named}
            dt = f", {shown(given['dt'])}" if "dt" in given else ""
            law = spelt_anew(given)
            tracker = f"so.Tracker(a, b{dt}{f', law={law}' if law else ''})"
            raise StandoffTypeError(
                "The pair, the frame time and the law are the tracker's: write "
                f"so.simulate({tracker}, path_a, path_b, duration).",
                "tracker",
            )
        return function(*args, **kwargs)

    return checked


def takes_places(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate ``start_from``, so that 0.1's features and parameters are told to come in pairs."""

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        # self and the poses come first; there a feature alone was followed by its parameters
        alone = any(
            isinstance(x, Feature) or (isinstance(x, tuple | list) and x and isinstance(x[0], str))
            for x in args[3:5]
        )
        named: Mapping[str, Any] = kwargs
        if alone or any(name.startswith(("feature_", "parameters_")) for name in named):
            raise StandoffTypeError(
                "A feature and its parameters are one place: write start_from(pose_a, pose_b, "
                "(feature_a, parameters_a), (feature_b, parameters_b)), or p.place_a and "
                "p.place_b of an answer p.",
                "place_a",
            )
        return function(*args, **kwargs)

    return checked


def spelt_anew(given: Mapping[str, Any]) -> str:
    """Return the law that 0.1's arguments describe, as it is written now; "" where they do not.

    What had no effect, such as a gain of the predictor-corrector, is left out.
    """
    options = {name: given[name] for name in OPTIONS if name in given}
    law = given.get("law", PredictorCorrector.name)
    if not options and not isinstance(law, str):
        return ""
    if not options and "law" not in given:
        return ""
    if isinstance(law, Law):
        usual = {n: each.default for n, each in options_of(law).items()}
        options = {n: getattr(law, n) for n in usual if getattr(law, n) != usual[n]} | options
        law = law.name
    if law not in LAWS:
        return " or ".join(f"{name}(...)" for name in PYTHON.values())
    if LAWS[law] is PaperLaw and options.pop("predictor", "") == "none":
        options["feedforward"] = False
    known = options_of(LAWS[law])
    told = [f"{name}={_python(x)}" for name, x in options.items() if name in known]
    return f"{PYTHON[LAWS[law]]}({', '.join(told)})"


def _python(value: Any) -> str:
    of_library = type(value).__module__ == "standoff.tracking.feedback"
    return f"so.feedback.{shown(value)}" if of_library else shown(value)
