"""The errors that this library raises, as one tree: each has attributes that name what is at fault.

A `StandoffError` is a ValueError. Where another kind is customary (TypeError, RuntimeError), it is
that kind too.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from standoff.wording import printable


class StandoffError(ValueError):
    """A bad argument; the message names it, the offending value and the fix.

    Parameters
    ----------
    message : str
    argument : str
        The argument at fault, by its name in the function or class that was called; empty if it is
        not a single one.
    value : object
        What was given for it; None if there is no single value.
    """

    def __init__(self, message: str, argument: str = "", value: Any = None) -> None:
        # Messages repeat names and values of files, and end on terminals.
        super().__init__(printable(message, keep="\n"))
        self.argument = argument
        self.value = value


class StandoffTypeError(StandoffError, TypeError):
    """An argument of the wrong kind, such as a string for a body."""


class BodyError(StandoffError):
    """The parts given do not bound a convex body; the message names the part and the fix.

    Parameters
    ----------
    message, argument, value
        As of a `StandoffError`.
    part : (str, int), optional
        The part at fault: "face", "edge", "vertex", "patch" or "curve", and its number as given;
        None if it is not a single one.
    """

    def __init__(
        self,
        message: str,
        argument: str = "",
        value: Any = None,
        *,
        part: tuple[str, int] | None = None,
    ) -> None:
        super().__init__(message, argument, value)
        self.part = part


class CadError(StandoffError):
    """A CAD file, or a part of one, that can't be read; nothing of it is kept.

    Parameters
    ----------
    message, argument, value
        As of a `StandoffError`; the message names the file, the part and the place in it.
    refusals : tuple of str
        Of an assembly, each part that was refused, with the reason.
    """

    def __init__(
        self,
        message: str,
        argument: str = "",
        value: Any = None,
        *,
        refusals: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message, argument, value)
        self.refusals = refusals


class FormulaError(StandoffError):
    """A formula that cannot be used: the message names the place and the fix."""


class VoronoiError(StandoffError, RuntimeError):
    """The regions could not be computed, or did not pass their own checks."""


class PassivityError(StandoffError):
    """A spring and damper that the device would not show passively.

    Parameters
    ----------
    message, argument, value
        As of a `StandoffError`.
    required : float
        The device's damping that would be needed.
    largest : float
        The largest stiffness that is passive with the damping given; 0 if none is.
    """

    def __init__(
        self,
        message: str,
        argument: str = "",
        value: Any = None,
        *,
        required: float = 0.0,
        largest: float = 0.0,
    ) -> None:
        super().__init__(message, argument, value)
        self.required = required
        self.largest = largest


class DeviceError(StandoffError, RuntimeError):
    """A haptic device that is not open, or no longer there."""


class UnreadableNumbers(StandoffTypeError):
    """Numbers that are given in an array, but cannot be read there: they are on a device, such as
    a GPU, or belong to a framework that does not share them."""


class MaskedNumbers(UnreadableNumbers):
    """Some of the numbers given are masked: there is no value to compute with."""


class DerivativeWarning(RuntimeWarning):
    """Derivatives of a distance that are undefined, all or in part, were passed to a framework as
    nan."""


class RefusedRowsWarning(RuntimeWarning):
    """Most poses of a batch are invalid, so most answers are nan; the message says what is wrong
    with the first, and whether the numbers are in another order."""


class GainWarning(RuntimeWarning):
    """A gain is so near its limit that errors hardly fall from step to step."""


def not_installed(library: str, extra: str = "cli") -> str:
    """What is said if a library is missing that comes with an extra of this package."""
    return (
        f"{library} is not installed; install the extra '{extra}': pip install 'standoff[{extra}]'"
    )


@contextmanager
def of_extra(library: str, extra: str = "cli") -> Iterator[None]:
    """For the imports within: where a library is missing, the extra that it comes with is told.

    Raises ModuleNotFoundError.

    Parameters
    ----------
    library : str
        As it is called; if empty, the module that is missing.
    extra : str
    """
    try:
        yield
    except ModuleNotFoundError as error:
        called = library or str(error.name).replace("_", "-")
        raise ModuleNotFoundError(not_installed(called, extra), name=error.name) from error
