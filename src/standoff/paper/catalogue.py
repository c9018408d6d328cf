"""Every figure that ``standoff paper`` makes, in the report's order."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib import import_module

from standoff.paper.figure import Artwork, Entry
from standoff.scene.reader import nearest

# One line a figure. Modules are imported when their figure is asked for.
# fmt: off
CATALOGUE: tuple[Entry, ...] = (
    Entry("1", "A patch and its tangents", "Patches", "standoff.paper.patches", "tangents_patch"),
    Entry("2", "Two patches and ΔR", "Patches", "standoff.paper.patches", "witness_pair"),
    Entry("3", "Ψ as a state", "Realisations", "standoff.paper.realisations", "figure_3"),
    Entry("4", "Ψ evaluated", "Realisations", "standoff.paper.realisations", "figure_4"),
    Entry("6", "Witness lines", "Simulation A", "standoff.paper.simulation_a", "figure_6"),
    Entry("7", "Errors and gains", "Simulation A", "standoff.paper.simulation_a", "figure_7"),
    Entry("8", "Regions and a spiral", "Simulation B", "standoff.paper.simulation_b", "figure_8"),
    Entry("9", "Inside and outside", "Simulation B", "standoff.paper.simulation_b", "figure_9"),
    Entry("10", "A hundred snapshots", "Simulation B", "standoff.paper.simulation_b", "figure_10"),
    Entry("11", "Parameters in time", "Simulation B", "standoff.paper.simulation_b", "figure_11"),
    Entry("12", "Voronoi regions", "Simulation C", "standoff.paper.simulation_c", "figure_12"),
    Entry("13", "The pair’s automaton", "Simulation C", "standoff.paper.simulation_c", "figure_13"),
    Entry("14", "Twelve snapshots", "Simulation C", "standoff.paper.simulation_c", "figure_14"),
    Entry("15", "Parameters in time", "Simulation C", "standoff.paper.simulation_c", "figure_15"),
    Entry("16", "The lens and a helix", "Simulation D", "standoff.paper.simulation_d", "figure_16"),
    Entry("17", "The automaton", "Simulation D", "standoff.paper.simulation_d", "figure_17"),
    Entry("18", "Parameters in time", "Simulation D", "standoff.paper.simulation_d", "figure_18"),
    Entry("19", "Five snapshots", "Simulation E", "standoff.paper.simulation_e", "figure_19"),
    Entry("20", "Parameters in time", "Simulation E", "standoff.paper.simulation_e", "figure_20"),
    Entry("voronoi", "Voronoi regions", "Voronoi regions", "standoff.paper.voronoi_figure", "regions"),  # noqa: E501
    Entry("gains", "Gains: decay and lag", "Control theory", "standoff.paper.control", "decay_and_lag"),  # noqa: E501
    Entry("stability", "Stability", "Control theory", "standoff.paper.control", "stability"),
    Entry("feedback", "Four feedbacks", "Control theory", "standoff.paper.control", "four_feedbacks"),  # noqa: E501
    Entry("basin", "Basins of attraction", "Control theory", "standoff.paper.control", "attraction"),  # noqa: E501
    Entry("lyapunov", "Lyapunov levels", "Control theory", "standoff.paper.control", "lyapunov"),
    Entry("normals", "The normals' set", "Reference [28]", "standoff.paper.normals", "comparison"),
    Entry("variants", "The variants as printed", "Variants and verdict", "standoff.paper.variants", "variants"),  # noqa: E501
    Entry("verdict", "Verdict", "Variants and verdict", "standoff.paper.verdict", "verdict"),
)
# fmt: on

ALL = "all"
"""The key of every figure."""

RANGE = re.compile(r"(\d+)-(\d+)")


class UnknownFigure(ValueError):
    """A key that no figure has; the message names the nearest one and lists them all."""


def make(entry: Entry) -> Artwork:
    """Make a figure: import its module and call its function."""
    artwork = getattr(import_module(entry.module), entry.function)()
    if not isinstance(artwork, Artwork):
        raise TypeError(f"{entry.module}.{entry.function}() gave no Artwork but {artwork!r}.")
    return artwork


def chosen(keys: Sequence[str]) -> tuple[Entry, ...]:
    """Return the figures that some keys name, in the report's order, each once.

    Parameters
    ----------
    keys : sequence of str
        "7", "07", "8-11" (those that there are), a word such as "voronoi", or "all".

    Raises
    ------
    UnknownFigure
        If no figure has a key, or a range is empty.
    """
    wanted = {found for key in keys for found in _named(key.strip().casefold())}
    return tuple(entry for entry in CATALOGUE if entry.key in wanted)


def _named(key: str) -> set[str]:
    """The keys of the catalogue that one key of the command line stands for."""
    known = {entry.key for entry in CATALOGUE}
    if key == ALL:
        return known
    ends = RANGE.fullmatch(key)
    if ends:
        low, high = map(int, ends.groups())
        found = {one for one in known if one.isdecimal() and low <= int(one) <= high}
        if found:
            return found
    plain = str(int(key)) if key.isdecimal() else key
    if plain in known:
        return {plain}
    raise UnknownFigure(_refusal(key))


def _refusal(key: str) -> str:
    names = [*(entry.key for entry in CATALOGUE), ALL]
    likely = None if key.isdecimal() else nearest(key, names)
    hint = f"did you mean '{likely}'? " if likely else ""
    return f"unknown figure '{key}'; {hint}known here: {', '.join(names)}, and ranges such as 8-11"
