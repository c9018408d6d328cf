"""Numbers that define a shape: one by one, several in a list, or by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffTypeError
from standoff.typing import Array


def by_position(
    shape: str, given: tuple[Any, ...], counts: Mapping[str, int], named: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the arguments of a shape by name.

    Raises StandoffTypeError: an argument that is missing or given twice, or too many positional
    arguments.

    Parameters
    ----------
    shape : str
        Its name, for messages.
    given : tuple
        The positional arguments: ``(a, b, c)`` for one argument of three numbers, or
        ``([a, b, c],)``.
    counts : mapping
        For every name, in the order of positions, how many numbers the argument has; 0 for one
        that is given as a whole.
    named : mapping
        The keyword arguments; None if one is not given.
    """
    found = {name: value for name, value in named.items() if value is not None}
    rest = list(given)
    for name, count in counts.items():
        if not rest or name in found:
            continue
        if count and shape_of(rest[0]) == ():
            found[name], rest = rest[:count], rest[count:]
        else:
            found[name] = rest.pop(0)
    if rest:
        call = ", ".join(f"{name}=..." for name in counts)
        twice = next((name for name in counts if named.get(name) is not None), None)
        problem = f"{twice} by position and by name" if twice else "too many numbers"
        raise StandoffTypeError(f"so.shapes.{shape} got {problem}: write {call}.", twice or "")
    for name, count in counts.items():
        if name not in found and count:
            numbers = ", ".join(["1.0"] * count)
            raise StandoffTypeError(
                f"so.shapes.{shape} needs {name}: give {name}=({numbers}).", name
            )
    return found


def positive_numbers(value: Any, name: str, count: int) -> Array:
    """Return `count` finite numbers above zero."""
    numbers = finite(value, name, (count,))
    for k, number in enumerate(numbers):
        magnitude(number, f"{name}[{k}]")
    return numbers
