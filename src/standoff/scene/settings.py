"""The ``[track]`` table: the law with its options, and the times that are tracked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any

from standoff.checks.names import one_of
from standoff.scene.errors import SceneError
from standoff.scene.reader import SceneTable
from standoff.tracking.feedback import Feedback, GainMatrix
from standoff.tracking.feedback_facts import KINDS
from standoff.tracking.law_options import (
    Choice,
    Law,
    OfFeedback,
    Option,
    Positive,
    Whole,
    YesNo,
    options_of,
)
from standoff.tracking.laws import DEFAULT_LAW, LAWS, OptionsConflict, every_option, laws_with

SAMPLES = "samples"
"""Value of ``step`` that makes every pose sample a frame, at its own uneven time."""

DEFAULT_STEP = 1e-3
"""Frame spacing without pose samples [s]: the rate of the paper's simulations and of haptics."""

TIMES = ("step", "start", "duration")

OF_SOLIDS = ("minima",)
"""Keys that only pairs with a solid have."""

NAMES: tuple[str, ...] = ("law", *every_option(), *OF_SOLIDS, *TIMES)
"""Every key of the table: the law's name, the options of all laws and of solids, and the times."""


@dataclass(frozen=True)
class TrackSettings:
    """How a pair is tracked, and over which times.

    Attributes
    ----------
    law : PredictorCorrector or PaperLaw
    step : float or "samples" or None
        Time from frame to frame [s]; None: the samples' own times if there are any.
    start, duration : float or None
        The times that are tracked [s]; None: as far as the motions are known.
    minima : float or None
        Of a pair with a solid that need not be convex: the length below which all local minima of
        the distance are kept.
    """

    law: Law = DEFAULT_LAW
    step: float | str | None = None
    start: float | None = None
    duration: float | None = None
    minima: float | None = None

    def overridden(self, given: Mapping[str, object]) -> TrackSettings:
        """Return these settings with those of `given` that are not None put in their place.

        Raises SceneError if a value would also be refused in a scene, or does not go with the
        others. Its key is then just the name, and no file is named, since the value did not come
        from one.

        Parameters
        ----------
        given : mapping
            Keys and values of a ``[track]`` table. Another ``law`` takes over the options that it
            has too; a gain takes the place of the feedback, and a feedback that of the gain.
        """
        table = SceneTable({name: value for name, value in given.items() if value is not None})
        return read_settings(table, usual=self)

    def facts(self) -> dict[str, Any]:
        """Return the settings as plain data that JSON can hold, named as in a scene."""
        return self.law.facts() | {name: getattr(self, name) for name in (*OF_SOLIDS, *TIMES)}


def read_settings(
    *tables: SceneTable, usual: TrackSettings | None = None, beside: Sequence[str] = ()
) -> TrackSettings:
    """Return the settings that a ``[track]`` table describes, or a pair's own table over it.

    Raises SceneError: at an unknown key or name, a value that its option does not take, an option
    that the law does not have, or options that do not go together. The error names the first
    table's key.

    Parameters
    ----------
    *tables : Table
        In order of precedence: values of the first win over those of the others.
    usual : TrackSettings, optional
        What holds where no table says anything; the library's defaults if not given.
    beside : sequence of str
        Keys of the first table that are not settings.
    """
    usual = usual or TrackSettings()
    for table, more in zip(tables, (beside, *[()] * len(tables)), strict=False):
        table.expect(*more, *NAMES)
    others = {name: getattr(usual, name) for name in (*OF_SOLIDS, *TIMES)}
    for table in reversed(tables):
        others |= _times(table) | _of_solids(table)
    return TrackSettings(_law(tables, usual.law), **others)


def _times(table: SceneTable) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if "step" in table:
        word = table.number_or_word("step", SAMPLES) is None
        found["step"] = SAMPLES if word else table.positive("step")
    if "start" in table:
        found["start"] = table.number("start")
    if "duration" in table:
        found["duration"] = table.positive("duration")
    return found


def _of_solids(table: SceneTable) -> dict[str, Any]:
    return {name: table.positive(name) for name in OF_SOLIDS if name in table}


def _law(tables: Sequence[SceneTable], usual: Law) -> Law:
    """The law that the first table to name one names, with the options of all that it has.

    Options of other laws are refused, but not those below a table that puts its law in place.
    """
    kind, named = type(usual), len(tables)
    for k, table in reversed(list(enumerate(tables))):
        if "law" in table:
            kind, named = LAWS[table.choice("law", list(LAWS))], k
    known = options_of(kind)
    found = {name: getattr(usual, name) for name in options_of(usual) if name in known}
    for k, table in reversed(list(enumerate(tables))):
        for group in kind.only_one:
            if table.only_one(group):
                found |= dict.fromkeys(group)
        for name, each in every_option().items():
            if name not in table:
                continue
            if name in known:
                found[name] = _value(table, each)
            elif k <= named:
                raise _not_of(kind, table, name)
    return _made(kind, found, tables)


def _made(kind: type[Law], options: dict[str, Any], tables: Sequence[SceneTable]) -> Law:
    """The law; what does not go together is reported for the first table that says it."""
    try:
        return kind(**options)
    except OptionsConflict as error:
        for table in tables:
            for name in error.options:
                if name in table:
                    raise table.error(str(error), name) from error
        raise SceneError(str(error), key=error.options[0]) from error


def _value(table: SceneTable, option: Option) -> Any:
    """What a table says of an option; its law checks it once more."""
    name = option.name
    match option.kind:
        case Choice(names):
            return table.choice(name, list(names))
        case Positive(infinite):
            return table.positive(name, infinite=infinite)
        case Whole():
            return table.count(name, 1)
        case YesNo():
            return table.true_or_false(name)
        case OfFeedback():
            return read_feedback(table.table(name))


def _not_of(law: type[Law], table: SceneTable, name: str) -> SceneError:
    others = one_of(other.name for other in laws_with(name))
    fix = f"leave it out, or take law = {others}"
    return table.error(f"is an option of the law {others}, and law is '{law.name}': {fix}", name)


# ``feedback = { kind = "pi", ... }`` of a ``[track]`` table: one of `standoff.feedback`.

ERRORS = 4
"""Projection errors of two faces, and so gains of a matrix's diagonal: of (u, v) and (r, s)."""


def read_feedback(table: SceneTable) -> Feedback:
    """Return the feedback that a table describes: its ``kind``, and its class's fields as keys.

    Raises SceneError: at an unknown kind or key, a number that is missing or not above zero, and
    what the feedback refuses.
    """
    kind = KINDS[table.choice("kind", list(KINDS))]
    if kind is GainMatrix:
        table.expect("kind", "gains")
        gains = _gains(table)
        return table.build(lambda: GainMatrix(gains), "gains")
    takes: Any = kind
    every = fields(takes)
    table.expect("kind", *(each.name for each in every))
    names = [each.name for each in every if each.default is MISSING or each.name in table]
    numbers = {name: table.positive(name) for name in names}
    return table.build(lambda: kind(**numbers))


def _gains(table: SceneTable) -> Any:
    value = table.required("gains", "gains = [100.0, 100.0, 100.0, 100.0]")
    if isinstance(value, list) and any(isinstance(row, list) for row in value):
        return table.matrix("gains", [(ERRORS, ERRORS)])
    return table.vector("gains", ERRORS)
