"""Formulas evaluated on Taylor series: bounds of all their derivatives over boxes at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.formulas.programs import ENCLOSED, ProgramText
from standoff.geometry.intervals import Interval
from standoff.geometry.series import SERIES_FUNCTIONS, Series


class SeriesProgram:
    """Expressions in u and v, or in t, as a program over series."""

    def __init__(self, expressions: Sequence[Any], variables: tuple[str, ...]) -> None:
        lines, outputs = ProgramText(ENCLOSED).body(expressions)
        text = [f"def series({', '.join(variables)}):", *lines, f"return [{', '.join(outputs)}]"]
        namespace: dict[str, Any] = dict(SERIES_FUNCTIONS)
        exec("\n    ".join(text), namespace)
        self._series = namespace["series"]
        self.length = sum(map(len, text))

    def __call__(self, *sides: Interval, order: int) -> list[Series]:
        """One series per expression over boxes with these sides (n,)."""
        variables = [Series.variable(side, axis, order) for axis, side in enumerate(sides)]
        with np.errstate(all="ignore"):
            found = self._series(*variables)
        return [s if isinstance(s, Series) else variables[0] * 0.0 + s for s in found]


@lru_cache(maxsize=64)
def series_program(formula: Formula) -> SeriesProgram:
    """The series program of a formula's coordinates."""
    return SeriesProgram(formula.expressions, formula.variables)
