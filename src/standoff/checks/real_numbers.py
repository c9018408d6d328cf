"""Which Python values are real numbers: for `standoff.geometry` and `standoff.motion` alike."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import MaskedNumbers, StandoffError, StandoffTypeError, UnreadableNumbers

SHOWN_CHARACTERS = 200
"""Longest piece of an offending value that a message repeats, in characters."""

SHOWN_NUMBERS = 16
"""Most numbers of an array that a message repeats: those of a pose."""


DEEPEST = 8
"""Most dimensions of an array that is read. NumPy itself stops walking at 32 and at 64."""

NOT_REAL = (
    *(bool, np.bool_, str, bytes, type(None)),
    *(complex, np.complexfloating, np.datetime64, np.timedelta64),
)
"""What NumPy would convert to float64, or refuses in its own words, although it is not a real
number."""


def shown(value: Any, characters: int = SHOWN_CHARACTERS) -> str:
    """Return `value` as a message repeats it: its repr on one line, cut short; of a large array,
    its shape."""
    if isinstance(value, np.ndarray) and value.size > SHOWN_NUMBERS:
        kind = "a masked array" if isinstance(value, np.ma.MaskedArray) else "an array"
        return f"{kind} of {' by '.join(map(str, value.shape))} numbers"
    try:
        text = _items(value) or repr(value)
    except RecursionError:
        return f"a {type(value).__name__} nested too deeply to be shown"
    except ValueError:
        # Python writes no whole number of more than some thousand decimal digits.
        if not isinstance(value, int):
            return f"a {type(value).__name__} with a number too long to be shown"
        text = hex(value)
    text = _LINE_ENDS.sub(" ", text)  # an array's rows; those in a string are escapes already
    return text if len(text) <= characters else text[: characters - 1] + "…"


def _items(value: Any) -> str:
    """What is shown of a short tuple or list with arrays in it, each by itself; else nothing."""
    if type(value) not in (tuple, list) or len(value) > SHOWN_NUMBERS:
        return ""
    if not any(isinstance(item, np.ndarray) for item in value):
        return ""
    brackets = repr(type(value)())
    return brackets[0] + ", ".join(map(shown, value)) + brackets[1]


_LINE_ENDS = re.compile(r"\s*\n\s*")

HOST = {1: "CPU", 3: "CUDA, pinned", 11: "ROCm, pinned", 13: "CUDA, managed"}
"""Devices whose memory the CPU reads, by DLPack's numbers."""
DEVICES = {2: "CUDA", 4: "OpenCL", 7: "Vulkan", 8: "Metal", 10: "ROCm", 14: "oneAPI"}
"""Others, as messages name them."""


def check_readable(value: Any) -> None:
    """Refuse masked numbers, in an array or in lists of arrays: NumPy's own conversions drop the
    mask and read what lies beneath as data. Refuse numbers on a device.

    Raises UnreadableNumbers.
    """
    waiting, seen = [value], set[int]()
    while waiting:
        given = waiting.pop()
        if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
            raise MaskedNumbers("has masked numbers; fill them, or leave them out")
        if isinstance(given, np.ndarray) and given.dtype.kind == "O":
            given = given.ravel().tolist()
        if isinstance(given, list | tuple) and id(given) not in seen:
            seen.add(id(given))  # a list may hold itself
            kinds = {kind for kind in set(map(type, given)) if _holds_numbers(kind)}
            waiting += [item for item in given if type(item) in kinds] if kinds else []
        elif not isinstance(given, list | tuple | np.ndarray) and _holds_numbers(type(given)):
            _check_device(given)


def _holds_numbers(kind: type) -> bool:
    """Is it a list, or an array of NumPy or of a framework that shares its memory by DLPack?"""
    return issubclass(kind, list | tuple) or hasattr(kind, "__dlpack_device__")


def _check_device(value: Any) -> None:
    try:
        kind, number = value.__dlpack_device__()
    except (RuntimeError, ValueError, BufferError):  # on several, or on none: its reading tells
        return
    if int(kind) not in HOST:
        raise UnreadableNumbers(
            f"is on a device ({DEVICES.get(int(kind), f'kind {int(kind)}')}, number {number}): "
            "copy it to the CPU, by tensor.cpu(), cupy.asnumpy(array) or jax.device_get(array)"
        )


def shape_of(value: Any) -> tuple[int, ...] | None:
    """Return the shape of what may be an array; None where its rows differ in length."""
    if hasattr(value, "__dlpack_device__") and hasattr(value, "shape"):
        return tuple(value.shape)
    try:
        # As objects, so that no element is read as a number, which a masked one would warn of.
        objects = np.array(value, dtype=object)
    except (ValueError, RecursionError):
        return None
    if objects.ndim > DEEPEST:
        return None
    ragged = any(isinstance(item, list | tuple | np.ndarray) for item in objects.flat)
    return None if ragged else tuple(objects.shape)


def real_array(value: Any, *, copy: bool = True) -> NDArray[np.float64]:
    """Return a float64 array of real numbers: a new one, or with ``copy=False`` the one given where
    it is one already.

    NumPy itself would read strings, truth values and durations as numbers, None as NaN, and drop an
    imaginary part with only a warning.

    Raises UnreadableNumbers: some of them are masked, or on a device. Raises TypeError: something
    in it is not a real number. Raises ValueError: its rows differ in length, or it is nested too
    deeply.
    """
    check_readable(value)
    given = as_given(value)
    if given.dtype.kind not in "iufO":
        raise StandoffTypeError(f"numbers of the kind {given.dtype}")
    if given.ndim > DEEPEST:
        raise StandoffError(f"lists in lists, more than {DEEPEST} deep")
    if given.dtype.kind == "O":
        wrong = tuple(kind for kind in _kinds(given) if issubclass(kind, NOT_REAL))
        if wrong:
            item = next(item for item in given.flat if isinstance(item, wrong))
            raise StandoffTypeError(f"{shown(item)} is not a real number")
    try:
        return np.array(given, dtype=np.float64) if copy else np.asarray(given, dtype=np.float64)
    except OverflowError as error:
        raise StandoffError(f"a number beyond float64: {error}") from error


def as_given(value: Any) -> NDArray[Any]:
    """An array of what is given, with the elements of lists as they are, before NumPy gives them
    one type. An array of another library is read where it is, without a copy.

    Raises UnreadableNumbers: the other library does not share it. Raises ValueError: its rows
    differ in length.
    """
    if isinstance(value, np.ndarray):
        return value
    if not isinstance(value, np.generic):
        try:
            if hasattr(value, "__array__"):
                # of JAX, PyTorch or pandas, which know their own kind of number
                return np.asarray(value)
            if hasattr(value, "__dlpack__"):
                return np.from_dlpack(value)
        except (RuntimeError, BufferError) as error:  # of PyTorch: it requires a gradient
            raise UnreadableNumbers(f"cannot be read: {error}") from error
    given = np.array(value, dtype=object)
    if any(issubclass(kind, list | tuple) for kind in _kinds(given)):
        raise StandoffError("rows of different lengths")
    return given


def _kinds(objects: NDArray[np.object_]) -> set[type]:
    return set(map(type, objects.ravel().tolist()))
