"""Fits that are meant: pairs that may touch or overlap, read from a file."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from standoff.checks.names import did_you_mean
from standoff.scene.errors import SceneError
from standoff.scene.files import text_of, toml_tables
from standoff.scene.reader import Table, shown

VERSION = 1
"""The version of the file's format."""


@dataclass(frozen=True)
class Fit:
    """Two bodies that may be in contact.

    Attributes
    ----------
    a, b : str
        Names of the bodies, in any order.
    depth : float
        The greatest depth that is allowed [length]; 0: they may touch.
    reason : str
    """

    a: str
    b: str
    depth: float
    reason: str

    @property
    def pair(self) -> frozenset[str]:
        """The two names."""
        return frozenset((self.a, self.b))

    def allowance(self, unit: str = "") -> str:
        """Return what is allowed, in words."""
        return f"up to {self.depth:g} {unit}".rstrip() if self.depth else "touching"

    def unknown(self, bodies: Collection[str]) -> str:
        """Return what is to be said of names that are no bodies; nothing where both are."""
        for name in (self.a, self.b):
            if name not in bodies:
                return f"the scene has no body {shown(name)}.{did_you_mean(name, bodies)}"
        return ""


def load_fits(file: str | os.PathLike[str]) -> tuple[Fit, ...]:
    """Read a list of fits that are meant.

    Parameters
    ----------
    file : str or path
        A TOML file; docs/clearance.md describes the format.

    Raises
    ------
    SceneError
        If the file is missing or is not TOML, or anything in it is unknown, missing or of the wrong
        type, or two entries are of one pair.
    """
    path = Path(file)
    try:
        content = toml_tables(text_of(path))
    except SceneError as error:
        raise error.found_in(path) from error
    top = Table(content, file=path)
    version = top.required("version", f"version = {VERSION}")
    if type(version) is not int or version != VERSION:
        raise top.error(f"is {shown(version)}; this Standoff reads version {VERSION}", "version")
    top.expect("version", "allow")
    found: list[Fit] = []
    for table in top.tables("allow"):
        table.expect("a", "b", "depth", "reason")
        a, b = table.text("a"), table.text("b")
        if a == b:
            raise table.error(f"'{a}' is both a and b; name two different bodies")
        fit = Fit(a, b, table.not_negative("depth", 0.0), table.text("reason"))
        if any(fit.pair == other.pair for other in found):
            first = next(i for i, other in enumerate(found) if other.pair == fit.pair)
            raise table.error(f"is of the same pair as allow[{first}]; keep one of them")
        found.append(fit)
    return tuple(found)
