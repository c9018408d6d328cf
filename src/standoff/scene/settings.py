"""The ``[track]`` table: how a pair is tracked, and over which times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

from standoff.scene.reader import Table
from standoff.tracking.options import INTEGRATORS, LAWS, PREDICTORS

SAMPLES = "samples"
"""Value of ``step`` that makes every pose sample a frame, at its own uneven time."""

DEFAULT_STEP = 1e-3
"""Frame spacing without pose samples [s]: the rate of the paper's simulations and of haptics."""


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
    step : float or "samples" or None
        Time from frame to frame [s]; None: the samples' own times if there are any.
    start, duration : float or None
        The times that are tracked [s]; None: as far as the motions are known.
    """

    law: str = "predictor-corrector"
    predictor: str = "feedforward-2"
    integrator: str = "heun"
    gain: float | None = None
    tolerance: float = 1e-10
    step: float | str | None = None
    start: float | None = None
    duration: float | None = None

    def overridden(self, given: Mapping[str, object]) -> TrackSettings:
        """Return these settings with those of `given` that are not None put in their place.

        Raises
        ------
        SceneError
            If a given one would be refused in a scene as well. Its key is then the name alone,
            and no file is named, since the value did not come from one.
        """
        chosen = {name: value for name, value in given.items() if value is not None}
        checked = read_settings(Table(chosen))
        return replace(self, **{name: getattr(checked, name) for name in chosen})


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
        At an unknown key, law, predictor or integrator, or a number that is not above zero.
    """
    table.expect(*beside, *NAMES)
    usual = usual or TrackSettings()
    return TrackSettings(
        law=table.choice("law", list(LAWS), usual.law),
        predictor=table.choice("predictor", list(PREDICTORS), usual.predictor),
        integrator=table.choice("integrator", list(INTEGRATORS), usual.integrator),
        gain=_optional_positive(table, "gain", usual.gain),
        tolerance=table.positive("tolerance", usual.tolerance),
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
