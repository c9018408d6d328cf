"""What all subjects of sweeps have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, NamedTuple

from standoff.sweep.parameters import Parameter
from standoff.sweep.rows import Rows
from standoff.typing import Array


class Alone(NamedTuple):
    """One row in full.

    Attributes
    ----------
    rows : Rows
        The row as it is in a block of others.
    nearest : Any
        The answer of the nearest pair, such as a `Proximity`; None if no pair is within the
        horizon.
    names : (str, str)
        Of its bodies, A and B.
    shapes : (body, body)
        Which the answer is of: the bodies, or their nearest pieces.
    poses : tuple of (str, (4, 4) array)
        World poses of these bodies, by their names.
    state : dict of str to list of float
        What else says where everything is: a robot's configuration.
    """

    rows: Rows
    nearest: Any
    names: tuple[str, str]
    shapes: tuple[Any, Any]
    poses: tuple[tuple[str, Array], ...]
    state: dict[str, list[float]]


class Subject(ABC):
    """What a job sweeps: it answers rows by their numbers.

    A row's answer has the same bits whichever others are asked with it.

    """

    within: float | None
    """Horizon [length]; of rows that are farther apart only that is proven."""

    @property
    @abstractmethod
    def length_unit(self) -> str:
        """Label of lengths."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What it is called in a line."""

    @property
    @abstractmethod
    def movable(self) -> tuple[str, ...]:
        """Names of what parameters can move: bodies, or joints."""

    @property
    @abstractmethod
    def planar(self) -> bool:
        """Are the bodies planar, so that they move in a plane alone?"""

    @abstractmethod
    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        """Return the answers of rows, the first of which has the number `first`.

        Parameters
        ----------
        parameters : sequence of Parameter
        numbers : (n, columns) array
            Of the parameters.
        first : int
        """

    @abstractmethod
    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        """Return the answer of one row in full; numbers (1, columns)."""

    @abstractmethod
    def facts(self) -> dict[str, Any]:
        """Return all of it that results depend on, as plain data."""

    @abstractmethod
    def reported(self) -> dict[str, Any]:
        """Return what a report says of it."""

    def pair_names(self, number: int) -> tuple[str, str] | None:
        """Return the names of a pair by its number in `Rows`; None of `NO_PAIR`."""
        return None
