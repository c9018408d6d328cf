"""Every figure that ``standoff paper`` makes, in the report's order."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from importlib import import_module

from standoff.checks.names import nearest
from standoff.errors import GainWarning
from standoff_studies.paper.figure import Artwork, Entry


def _entry(key: str, title: str, chapter: str, module: str, function: str) -> Entry:
    """A figure made by a module of this package."""
    return Entry(key, title, chapter, f"standoff_studies.paper.{module}", function)


# One line per figure. Modules are imported when their figure is requested.
# fmt: off
CATALOGUE: tuple[Entry, ...] = (
    _entry("1", "A patch and its tangents", "Patches", "patches", "tangents_patch"),
    _entry("2", "Two patches and ΔR", "Patches", "patches", "witness_pair"),
    _entry("3", "Ψ as a state", "Realisations", "realisations", "figure_3"),
    _entry("4", "Ψ evaluated", "Realisations", "realisations", "figure_4"),
    _entry("5", "Device, coupler, tracker in one", "In the loop", "in_the_loop", "figure_5"),
    _entry("6", "Witness lines", "Simulation A", "simulation_a", "figure_6"),
    _entry("7", "Errors and gains", "Simulation A", "simulation_a", "figure_7"),
    _entry("8", "Regions and a spiral", "Simulation B", "simulation_b", "figure_8"),
    _entry("9", "Inside and outside", "Simulation B", "simulation_b", "figure_9"),
    _entry("10", "A hundred snapshots", "Simulation B", "simulation_b", "figure_10"),
    _entry("11", "Parameters in time", "Simulation B", "simulation_b", "figure_11"),
    _entry("12", "Voronoi regions", "Simulation C", "simulation_c", "figure_12"),
    _entry("13", "The pair’s automaton", "Simulation C", "simulation_c", "figure_13"),
    _entry("14", "Twelve snapshots", "Simulation C", "simulation_c", "figure_14"),
    _entry("15", "Parameters in time", "Simulation C", "simulation_c", "figure_15"),
    _entry("16", "The lens and a helix", "Simulation D", "simulation_d", "figure_16"),
    _entry("17", "The automaton", "Simulation D", "simulation_d", "figure_17"),
    _entry("18", "Parameters in time", "Simulation D", "simulation_d", "figure_18"),
    _entry("19", "Five snapshots", "Simulation E", "simulation_e", "figure_19"),
    _entry("20", "Parameters in time", "Simulation E", "simulation_e", "figure_20"),
    _entry("arrivals", "Which starts arrive", "Convergence", "convergence", "as_committed"),
    _entry("harder", "Faster, sharper, bent inwards", "Convergence", "convergence", "harder"),
    _entry("voronoi", "Voronoi regions", "Voronoi regions", "voronoi_figure", "regions"),
    _entry("gains", "Gains: decay and lag", "Control theory", "control", "decay_and_lag"),
    _entry("lower", "The lower limit of K", "Control theory", "control", "lower_limit"),
    _entry("stability", "Stability", "Control theory", "control", "stability"),
    _entry("feedback", "Four feedbacks", "Control theory", "control", "four_feedbacks"),
    _entry("basin", "Basins of attraction", "Control theory", "control", "attraction"),
    _entry("lyapunov", "Lyapunov levels", "Control theory", "control", "lyapunov"),
    _entry("normals", "The normals' set", "Reference [28]", "normals", "comparison"),
    _entry("nonconvex", "Only another switching", "Beyond convex bodies", "nonconvex", "nonconvex"),
    _entry("furthest", "The furthest points", "Beyond convex bodies", "furthest", "furthest"),
    _entry("variants", "The variants as printed", "Variants and verdict", "variants", "variants"),
    _entry("cost", "What an update costs", "Variants and verdict", "update_cost", "update_cost"),
    _entry("verdict", "Verdict", "Variants and verdict", "verdict", "verdict"),
    _entry("field", "The field on the same work", "The field", "field", "as_committed"),
)
# fmt: on

ON_REQUEST: tuple[Entry, ...] = (
    _entry("convergence", "Which starts arrive, run again", "Convergence", "convergence", "anew"),
)
"""Figures that take minutes, and are made only if requested by their own key."""

ALL = "all"
"""The key that stands for all figures."""

RANGE = re.compile(r"(\d+)-(\d+)")


class UnknownFigure(ValueError):
    """A key that no figure has; the message suggests the nearest one and lists all keys."""


def make(entry: Entry) -> Artwork:
    """Make a figure: import its module and call its function."""
    with warnings.catch_warnings():
        # some figures measure what becomes of errors at such gains
        warnings.simplefilter("ignore", GainWarning)
        artwork = getattr(import_module(entry.module), entry.function)()
    if not isinstance(artwork, Artwork):
        raise TypeError(f"{entry.module}.{entry.function}() gave no Artwork but {artwork!r}.")
    return artwork


def chosen(keys: Sequence[str]) -> tuple[Entry, ...]:
    """Return the figures that the keys name, in the report's order, each once.

    Parameters
    ----------
    keys : sequence of str
        "7", "07", "8-11" (those that exist), a word such as "voronoi", or "all".

    Raises
    ------
    UnknownFigure
        If no figure has a key, or a range is empty.
    """
    wanted = {found for key in keys for found in _named(key.strip().casefold())}
    return tuple(entry for entry in (*CATALOGUE, *ON_REQUEST) if entry.key in wanted)


def _named(key: str) -> set[str]:
    """The keys of the catalogue for which one key of the command line stands."""
    usual = {entry.key for entry in CATALOGUE}
    if key == ALL:
        return usual
    known = usual | {entry.key for entry in ON_REQUEST}
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
    names = [*(entry.key for entry in (*CATALOGUE, *ON_REQUEST)), ALL]
    likely = None if key.isdecimal() else nearest(key, names)
    hint = f"did you mean '{likely}'? " if likely else ""
    return f"unknown figure '{key}'; {hint}known here: {', '.join(names)}, and ranges such as 8-11"
