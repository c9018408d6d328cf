"""Fits that are meant: pairs that may touch or overlap, or whose gap has a range, from a file."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from standoff.checks.names import did_you_mean
from standoff.scene.errors import SceneError
from standoff.scene.files import text_of, toml_tables
from standoff.scene.reader import SceneTable, shown

VERSION = 1
"""The version of the file's format."""


def matching(pattern: str, names: Collection[str]) -> frozenset[str]:
    """Return the names that are a pattern to the letter, or fit it as the shell's file names do."""
    return frozenset(name for name in names if name == pattern or fnmatchcase(name, pattern))


def unmatched(pattern: str, names: Collection[str]) -> str:
    """Return what is to be said of a pattern that no body's name fits."""
    return f"there is no body {shown(pattern)}.{did_you_mean(pattern, names)}"


@dataclass(frozen=True)
class Fit:
    """Pairs of bodies whose gap has a range of its own.

    Attributes
    ----------
    a, b : str
        Names of the bodies, or patterns of names, in any order.
    gap : (float, float)
        The least and the greatest gap that is allowed [length]; a gap below 0 is a depth. (-d, inf)
        is a contact: they may touch, and be d deep in each other.
    reason : str
    """

    a: str
    b: str
    gap: tuple[float, float]
    reason: str

    @property
    def pair(self) -> frozenset[str]:
        """The two names."""
        return frozenset((self.a, self.b))

    @property
    def contact(self) -> bool:
        """Is it a contact that is meant, which need not be there?"""
        return self.gap[1] == math.inf

    def allowance(self, unit: str = "") -> str:
        """Return what is allowed, in words."""
        low, high = self.gap
        if self.contact:
            return f"up to {-low:g} {unit}".rstrip() if low else "touching"
        told = f"depth of {-high:g} to {-low:g}" if high <= 0.0 else f"gap of {low:g} to {high:g}"
        return f"a {told} {unit}".rstrip()

    def unknown(self, bodies: Collection[str]) -> str:
        """Return what is to be said of names that are no bodies; nothing where both are."""
        for name in (self.a, self.b):
            if not matching(name, bodies):
                return unmatched(name, bodies)
        return ""


def fit_of(fits: Sequence[Fit], bodies: Collection[str]) -> Callable[[Sequence[str]], Fit | None]:
    """Return what finds the fit of a pair of bodies: the first of several that it fits."""
    sides = [(fit, matching(fit.a, bodies), matching(fit.b, bodies)) for fit in fits]

    def found(names: Sequence[str]) -> Fit | None:
        for fit, a, b in sides:
            for one, other in (names, names[::-1]):
                if one in a and other in b:
                    return fit
        return None

    return found


def load_fits(file: str | os.PathLike[str]) -> tuple[Fit, ...]:
    """Read a list of fits that are meant.

    Raises SceneError if the file is missing or is not TOML, or anything in it is unknown, missing
    or of the wrong type, or two entries are of one pair.

    Parameters
    ----------
    file : str or path
        A TOML file; docs/clearance.md describes the format.
    """
    path = Path(file)
    try:
        content = toml_tables(text_of(path))
    except SceneError as error:
        raise error.found_in(path) from error
    top = SceneTable(content, file=path)
    version = top.required("version", f"version = {VERSION}")
    if type(version) is not int or version != VERSION:
        raise top.error(f"is {shown(version)}; this Standoff reads version {VERSION}", "version")
    top.expect("version", "allow")
    found: list[Fit] = []
    for table in top.tables("allow"):
        table.expect("a", "b", "depth", "gap", "reason")
        a, b = table.text("a"), table.text("b")
        if a == b and not any(letter in a for letter in "*?["):
            raise table.error(f"'{a}' is both a and b; name two different bodies")
        fit = Fit(a, b, _gap(table), table.text("reason"))
        if any(fit.pair == other.pair for other in found):
            first = next(i for i, other in enumerate(found) if other.pair == fit.pair)
            raise table.error(f"is of the same pair as allow[{first}]; keep one of them")
        found.append(fit)
    return tuple(found)


def _gap(table: SceneTable) -> tuple[float, float]:
    """The range of the gap: as it is given, or that of a contact."""
    if table.only_one(("depth", "gap")) != "gap":
        return 0.0 - table.not_negative("depth", 0.0), math.inf
    low, high = table.vector("gap", 2, example="gap = [0.01, 0.03]").tolist()
    if low > high:
        raise table.error(f"is [{low:g}, {high:g}]: give the least gap first", "gap")
    return low, high
