"""Answers as plain data and as JSON, and numbers as they are shown."""

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
    """A base class of answers, which can be turned into dictionaries of plain data and JSON."""

    __slots__ = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data: numbers, strings, lists and dictionaries of these.

        Features become strings such as ``"face 2"``, a status its name, arrays lists. The numbers
        are the same to the last bit, except that a zero loses its sign; NaN stays NaN.
        """
        raise NotImplementedError

    def to_json(self, indent: int | None = None) -> str:
        """Return `as_dict` as strict JSON; NaN and infinities, which JSON does not have, are null.

        Parameters
        ----------
        indent : int, optional
            Spaces of indentation per level; everything on one line if not given.
        """
        return json_text(self.as_dict(), indent)


def plain(value: Any) -> Any:
    """Return the parts of an answer as numbers, strings, lists and dictionaries."""
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
    """Return strict JSON; NaN and infinities become null, control characters escapes."""
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
    """Return numbers as they are shown: those that are roundoff relative to a size are zero.

    Parameters
    ----------
    values : array_like
        Lengths, or components of a unit vector.
    size : float
        Size of what they belong to, in their unit; 1 for a unit vector.
    """
    numbers = np.array(values, dtype=np.float64)
    return np.where(np.abs(numbers) <= SHOWN_ROUNDOFF * size, 0.0, numbers)
