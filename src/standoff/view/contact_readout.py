"""The contacts and energies of a simulation in the words and numbers of its page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from itertools import chain, islice

import numpy as np

from standoff.simulation.pair_contacts import PairContact
from standoff.simulation.system_state import Energy
from standoff.simulation.units import Units
from standoff.tracking import Status
from standoff.typing import Array
from standoff.view.contact_nodes import FORCE_COLOUR, Arrows
from standoff.view.readout import COLOURS, MARK, ROW, SHORT, TABLE, length
from standoff.view.shown_simulation import Instant, Simulated
from standoff.view.solid_readout import ANOTHER, IN_OVERLAP, MOST_LISTED, NONE
from standoff.wording import counted, printable, short_name

LIST = (
    '<table style="font-size:.8em;margin:.3em .9em;border-spacing:.6em 0;'
    'font-variant-numeric:tabular-nums" data-of="contacts-list">{}</table>'
)
HEAD = '<tr data-pair="{}"><td colspan="4" style="font-weight:600;padding-top:.4em">{}</td></tr>'
CELL = '<td style="white-space:nowrap">{}</td>'
PLACE = f'<tr data-place="{{}}">{CELL}<td colspan="3">{{}}</td></tr>'
SPOT = f'<tr data-spot="{{}}">{4 * CELL}</tr>'
ENERGIES = (
    '<table style="font-size:.875em;margin:.2em .9em;font-variant-numeric:tabular-nums">{}</table>'
)
DOT = '<span style="color:rgb{}">●</span> '


def contacts_verdict(contacts: Sequence[PairContact], total: float, units: Units) -> str:
    """Return in a sentence what pushes."""
    pushing = [each for each in contacts if each.spots]
    if not pushing:
        return "nothing touches"
    spots = sum(len(each.spots) for each in pushing)
    push = f"{counted(spots, 'spot')} of {counted(len(pushing), 'pair')} push"
    return f"{push}{'es' if spots == 1 else ''} with {length(total, units.force, SHORT)} in all"


def simulation_readout(instant: Instant, given: Simulated, arrows: Arrows, more: str = "") -> str:
    """Return the sentence and the table of an instant, as HTML.

    Parameters
    ----------
    instant : Instant
    given : Simulated
    arrows : Arrows
        How forces are drawn.
    more : str
        Of a system that is stepped, how fast.
    """
    units = Units.of(given.unit)
    places = sum(len(each.places) for each in instant.contacts)
    spots = sum(len(each.spots) for each in instant.contacts)
    first, second = (MARK.format(colour) for colour in COLOURS)
    forces = f"{length(instant.total, units.force)}, {counted(spots, 'spot')}"
    rows = [
        ("time", "time", f"{instant.time:.6g} s"),
        (first + "forces", "forces", forces),
        (second + "greatest", "greatest", length(instant.greatest, units.force)),
        ("places", "places", f"{places}, of {counted(len(instant.contacts), 'pair')}"),
        ("distance", "distance", length(instant.distance, units.length)),
        ("deepest", "deepest", f"{length(instant.deepest + 0.0, units.length, SHORT)} so far"),
        ("certified", "certified", certified_text(instant, given)),
    ]
    rows.append((DOT.format(FORCE_COLOUR) + "arrows", "arrows", arrows_text(arrows, units)))
    if more:
        rows.append(("pace", "pace", more))
    return TABLE.format(
        escape(contacts_verdict(instant.contacts, instant.total, units)),
        "".join(ROW.format(name, key, escape(text)) for name, key, text in rows),
    )


def energy_table(energy: Energy, units: Units) -> str:
    """Return the table of energies, as HTML."""
    names = ("kinetic", "potential", "stored", "dissipated", "supplied", "shared", "balance")
    told = ((name, length(getattr(energy, name) + 0.0, units.energy, 6)) for name in names)
    return ENERGIES.format("".join(ROW.format(name, name, escape(text)) for name, text in told))


def arrows_text(arrows: Arrows, units: Units) -> str:
    """Return how long the arrow of a force is."""
    one = f"1 {units.force}".rstrip()
    return (
        f"{one} is {length(arrows.scale, units.length, 3)} long, at most "
        f"{length(arrows.longest, units.length, 3)}"
    )


def is_sound(status: Status) -> bool:
    """Is an answer certified, or proven as far as a tick proves it?"""
    return status.certified or status in (Status.TRACKING, Status.LOCAL)


def certified_text(instant: Instant, given: Simulated) -> str:
    """Return which pairs are not certified now, and how many answers were not."""
    pairs = [each.pair for each in instant.contacts if not is_sound(each.status)]
    now = ", ".join(_names(given, pair) for pair in pairs[:3]) + (", …" if len(pairs) > 3 else "")
    since = f"{instant.uncertified} not since the start" if instant.uncertified else "all so far"
    return f"not now: {now}; {since}" if pairs else since


def _names(given: Simulated, pair: int) -> str:
    return " – ".join(printable(name) for name in given.pair_names(pair))


def force_texts(contacts: Iterable[PairContact], units: Units) -> list[tuple[Array, str]]:
    """Return what stands beside each pair that pushes, the strongest first: its force, and the
    point of its greatest spot."""
    found = []
    for each in contacts:
        if each.spots:
            greatest = max(each.spots, key=lambda spot: float(np.linalg.norm(spot.force)))
            found.append((float(np.linalg.norm(each.force)), greatest.point))
    found.sort(key=lambda each: -each[0])
    return [(point, length(force, units.force, 3)) for force, point in found]


def contacts_list(instant: Instant, given: Simulated) -> str:
    """Return the list of all contacts, as HTML: of each pair its status and force, its places, and
    of each spot depth, force and springs."""
    units, contacts = Units.of(given.unit), instant.contacts
    if not contacts:
        return NONE.format("no pair is near")
    rows = chain.from_iterable(_rows_of(each, given, units) for each in contacts)
    table = LIST.format("".join(islice(rows, MOST_LISTED)))
    count = sum(1 + len(each.places) + len(each.spots) for each in contacts)
    more = count - MOST_LISTED
    return table + (NONE.format(f"and {counted(more, 'more row')}") if more > 0 else "")


def _rows_of(each: PairContact, given: Simulated, units: Units) -> Iterator[str]:
    """A row of the pair, of each place, and of each spot."""
    names = " – ".join(short_name(name) for name in given.pair_names(each.pair))
    force = float(np.linalg.norm(each.force))
    pushes = f", {length(force, units.force, SHORT)}" if each.spots else ""
    yield HEAD.format(each.pair, escape(f"{names}: {each.status.name}{pushes}"))
    for place in each.places:
        told = escape(length(place.distance, units.length, 6))
        if place.distance < 0.0:
            told = IN_OVERLAP.format(told)
        yield PLACE.format(place.key, f"place #{place.key}", told + ("" if place.felt else ANOTHER))
    for number, spot in enumerate(each.spots, 1):
        depth = length(spot.depth, units.length, SHORT)
        pushed = length(float(np.linalg.norm(spot.force)), units.force, SHORT)
        springs = f"{spot.springs:.2f} springs"
        yield SPOT.format(number, f"spot {number}", escape(depth), escape(pushed), springs)
