"""Answers as plain data, as JSON, and on one line."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.bodies.features import Feature
from standoff.bodies.tolerances import SHOWN_ROUNDOFF
from standoff.wording import printable_json


class PlainData:
    """A base of answers: they travel as dictionaries of plain data, and as JSON."""

    __slots__ = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data: numbers, texts, lists and dictionaries of these.

        Features are texts such as ``"face 2"``, a status its name, arrays lists. The numbers are
        the same to the last bit, but that no zero has a sign; NaN stays NaN.
        """
        raise NotImplementedError

    def to_json(self, indent: int | None = None) -> str:
        """Return `as_dict` as strict JSON; NaN and the infinities, which JSON lacks, are null.

        Parameters
        ----------
        indent : int, optional
            Spaces that a level is indented by; everything on one line if not given.
        """
        return json_text(self.as_dict(), indent)


def plain(value: Any) -> Any:
    """Return numbers, texts, lists and dictionaries for what an answer is made of."""
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Feature):
        return str(value)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, float):
        return value + 0.0  # turns -0.0 into 0.0
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def json_text(facts: Mapping[str, Any], indent: int | None = None) -> str:
    """Return strict JSON; NaN and the infinities are null, control characters escapes."""
    finite = _finite(plain(facts))
    return printable_json(json.dumps(finite, indent=indent, ensure_ascii=False, allow_nan=False))


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def without_roundoff(values: ArrayLike, size: float) -> NDArray[np.float64]:
    """Return numbers as they are shown: those that are roundoff beside a size are zero.

    Parameters
    ----------
    values : array_like
        Lengths, or parts of a unit vector.
    size : float
        Of what they belong to, in their unit; 1 of a unit vector.
    """
    numbers = np.array(values, dtype=np.float64)
    return np.where(np.abs(numbers) <= SHOWN_ROUNDOFF * size, 0.0, numbers)
