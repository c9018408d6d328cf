"""The ``[track]`` table: how a pair is tracked, and over which times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, NamedTuple

from standoff.scene.errors import SceneError
from standoff.scene.feedbacks import feedback_facts, feedback_text, read_feedback
from standoff.scene.reader import Table, shown
from standoff.tracking.choices import (
    DEPTHS,
    INTEGRATORS,
    LAWS,
    PREDICTORS,
    REALISATIONS,
    SATURATIONS,
    SOLVES,
    SWITCHINGS,
)
from standoff.tracking.feedback import Feedback
from standoff.tracking.options import Variants

SAMPLES = "samples"
"""Value of ``step`` that makes every pose sample a frame, at its own uneven time."""

DEFAULT_STEP = 1e-3
"""Frame spacing without pose samples [s]: the rate of the paper's simulations and of haptics."""

PAPER_ONLY = ("feedback", "realisation", "switching", "saturation", "solve")
"""Settings that the paper's law has and the predictor-corrector has not."""


@dataclass(frozen=True)
class TrackSettings:
    """How a pair is tracked.

    The defaults are part of the scene format: a scene keeps its meaning when the library's own
    defaults change.

    Attributes
    ----------
    law, predictor, integrator, tolerance
        As `standoff.Tracker` takes them.
    gain : float or None
        Feedback gain K of the paper's law [1/s]; None: one over the longest step.
    feedback : Feedback or None
        Of the paper's law, in place of `gain`; None: linear with `gain`.
    realisation, switching, solve
        Of the paper's law, as `standoff.Tracker` takes them.
    saturation : str or None
        The same; None: the one that goes with the switching.
    depth : "global" or "local"
        Which depth is followed in penetration, as `standoff.Tracker` takes it.
    deadline : int or None
        Most evaluations a step; None: no limit.
    step : float or "samples" or None
        Time from frame to frame [s]; None: the samples' own times if there are any.
    start, duration : float or None
        The times that are tracked [s]; None: as far as the motions are known.
    """

    law: str = "predictor-corrector"
    predictor: str = "feedforward-2"
    integrator: str = "heun"
    gain: float | None = None
    feedback: Feedback | None = None
    realisation: str = "evaluated"
    saturation: str | None = None
    switching: str = "multipliers"
    solve: str = "ranked"
    tolerance: float = 1e-10
    depth: str = "global"
    deadline: int | None = None
    step: float | str | None = None
    start: float | None = None
    duration: float | None = None

    def overridden(self, given: Mapping[str, object]) -> TrackSettings:
        """Return these settings with those of `given` that are not None put in their place.

        A given gain takes the place of the feedback as well, and a feedback, written as a scene's
        table, that of the gain.

        Raises
        ------
        SceneError
            If a given one would be refused in a scene as well, or does not go with the others.
            Its key is then the name alone, and no file is named, since the value did not come
            from one.
        """
        table = Table({name: value for name, value in given.items() if value is not None})
        settings = read_settings(table, self)
        check_together(settings, table)
        return settings

    def facts(self) -> dict[str, Any]:
        """Return the settings as plain data that JSON can hold, named as in a scene."""
        facts = {field.name: getattr(self, field.name) for field in fields(self)}
        feedback = None if self.feedback is None else feedback_facts(self.feedback)
        return facts | {"feedback": feedback}


NAMES: tuple[str, ...] = tuple(field.name for field in fields(TrackSettings))


def read_settings(
    table: Table, usual: TrackSettings | None = None, beside: Sequence[str] = ()
) -> TrackSettings:
    """Return the settings that a ``[track]`` table, or a pair's own table, describes.

    Parameters
    ----------
    table : Table
    usual : TrackSettings, optional
        What holds where the table says nothing; the format's defaults if not given.
    beside : sequence of str
        Keys of the table that are no settings.

    Raises
    ------
    SceneError
        At an unknown key or name, a number that is not above zero, or a feedback that is
        refused. Whether the settings go together is for `check_together`.
    """
    table.expect(*beside, *NAMES)
    usual = usual or TrackSettings()
    table.only_one(("gain", "feedback"))
    return TrackSettings(
        law=table.choice("law", list(LAWS), usual.law),
        predictor=table.choice("predictor", list(PREDICTORS), usual.predictor),
        integrator=table.choice("integrator", list(INTEGRATORS), usual.integrator),
        gain=_optional_positive(table, "gain", None if "feedback" in table else usual.gain),
        feedback=_feedback(table, None if "gain" in table else usual.feedback),
        realisation=table.choice("realisation", list(REALISATIONS), usual.realisation),
        saturation=_saturation(table, usual.saturation),
        switching=table.choice("switching", list(SWITCHINGS), usual.switching),
        solve=table.choice("solve", list(SOLVES), usual.solve),
        tolerance=table.positive("tolerance", usual.tolerance),
        depth=table.choice("depth", list(DEPTHS), usual.depth),
        deadline=table.count("deadline", 1) if "deadline" in table else usual.deadline,
        step=_step(table, usual.step),
        start=table.number("start") if "start" in table else usual.start,
        duration=_optional_positive(table, "duration", usual.duration),
    )


def _optional_positive(table: Table, key: str, usual: float | None) -> float | None:
    return table.positive(key) if key in table else usual


def _step(table: Table, usual: float | str | None) -> float | str | None:
    if "step" not in table:
        return usual
    if table.number_or_word("step", SAMPLES) is None:
        return SAMPLES
    return table.positive("step")


def _feedback(table: Table, usual: Feedback | None) -> Feedback | None:
    return read_feedback(table.table("feedback")) if "feedback" in table else usual


def _saturation(table: Table, usual: str | None) -> str | None:
    return table.choice("saturation", list(SATURATIONS)) if "saturation" in table else usual


def check_together(settings: TrackSettings, *tables: Table) -> None:
    """Refuse settings that do not go together.

    Parameters
    ----------
    settings : TrackSettings
    *tables : Table
        Where they came from, those first whose values stand over the others'. The error names
        the key in the first that has one of those at odds.

    Raises
    ------
    SceneError
        Settings of the paper's law with another law, or a saturation that the switching cannot
        work with.
    """
    conflict = _conflict(settings)
    if conflict is None:
        return
    for table in tables:
        for key in conflict.keys:
            if key in table:
                raise table.error(conflict.problem, key)
    raise SceneError(conflict.problem, key=conflict.keys[0])


class _Conflict(NamedTuple):
    """Keys that do not go together, and why."""

    keys: tuple[str, ...]
    problem: str


def _conflict(settings: TrackSettings) -> _Conflict | None:
    try:
        variants = Variants.of(
            settings.realisation, settings.saturation, settings.switching, settings.solve
        )
    except ValueError as error:
        return _Conflict(("saturation", "switching"), str(error))
    if settings.law == "paper":
        return None
    feedback = None if settings.feedback is None else feedback_text(settings.feedback)
    usual = {"feedback": None, **asdict(Variants())}
    used = {"feedback": feedback, **asdict(variants)}
    for name in PAPER_ONLY:
        if used[name] != usual[name]:
            return _Conflict(
                (name, "law"),
                f"{name} = {shown(used[name])} is of the paper's law, and law is "
                f"'{settings.law}': take law = \"paper\", or leave {name} out",
            )
    return None
