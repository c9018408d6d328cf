"""One operator of a system: bodies, contacts and trackers advanced by one fixed-step method."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.checks.names import choice
from standoff.checks.numbers import number, positive, whole_number, yes_or_no
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.dynamics.operator import METHODS
from standoff.kernels.entries import simulation as entries
from standoff.kernels.entries.preparing import prepare_simulation
from standoff.kernels.state import arrays as T
from standoff.progress import Progress
from standoff.read_only import KeepsReadOnly
from standoff.simulation import stability
from standoff.simulation.device import Device, DeviceReading
from standoff.simulation.device_loop import (
    blocks,
    check_count,
    check_device,
    given_readings,
    read,
    write,
)
from standoff.simulation.device_readings import DeviceReadings
from standoff.simulation.near_pairs import near_rows
from standoff.simulation.packed_system import driven_table, pack_system
from standoff.simulation.pair_contacts import ContactHistory, PairContact, no_room, pair_contacts
from standoff.simulation.pair_laws import (
    Laws,
    keeps_polytopes,
    law_inside,
    laws_beside,
    packed_laws,
)
from standoff.simulation.state_room import kept_numbers
from standoff.simulation.system import System
from standoff.simulation.system_run import SystemRun, account_width
from standoff.simulation.system_start import started
from standoff.simulation.system_state import SystemState, coupler_at, state_length
from standoff.tracking.law_options import Law
from standoff.typing import Array

SIDES = ("inside", "beside")

MOST_NUMBERS = 200_000_000
"""Numbers that one run may record: 1.6 GB."""

BLOCK = 20_000
"""Ticks of one compiled loop, a tenth of a second or so: progress is reported between them."""


class Going(NamedTuple):
    """A run under way: the state, changed in place, when it began, and ticks a record."""

    data: Array
    start: float
    every: int


class Operator(KeepsReadOnly):
    """Bodies, contacts and tracked parameters as one state, advanced by one method.

    Raises StandoffTypeError: no system. Raises StandoffError: a step that is not positive; an
    unknown method; a gain beyond the method's limit; a contact or a coupler too stiff for the step,
    with the largest stable stiffness; a slip speed too small for it; a step that does not fit into
    the period of a coupler's device.

    Parameters
    ----------
    system : System
    dt : float
        Step [time], positive.
    method : str
        "euler", "heun", "midpoint", "rk4", or "semi-implicit", which is for stiff contact: momenta
        by the forces at the start of the step, then poses by the new momenta.
    tracker : str
        "inside": the parameters of the witness points are part of the state and of every stage,
        advanced by the paper's law (in contact by its contact-regular form). "beside": one step of
        the tracker per tick; the forces at its witness points are held over the stages of the tick.
    gain : float, optional
        K [1/time] of the law inside; one over the step if not given.
    law : PredictorCorrector, PaperLaw, or mapping of pairs (int, int) to these, optional
        Of the trackers beside the operator, with all options: one for all pairs, or one for each of
        some pairs. A pair without one has ``PredictorCorrector(depth="local")``. With depth
        "global" the proof of a depth is kept from tick to tick, as part of the state.

    Attributes
    ----------
    laws : tuple
        Of the pairs, in their order.
    ticks_a_reading : int
        Ticks from one reading of a coupler's device to the next: its period over the step; 1 where
        there is none.
    """

    def __init__(
        self,
        system: System,
        dt: float,
        method: str = "semi-implicit",
        tracker: str = "beside",
        gain: float | None = None,
        law: Laws = None,
    ) -> None:
        if not isinstance(system, System):
            raise StandoffTypeError(
                f"system is {shown(system)}: give a standoff.simulation.System.", "system", system
            )
        self.system = system
        self.dt = positive(dt, "dt")
        choice(method, "method", METHODS)
        choice(tracker, "tracker", SIDES)
        self.method, self.tracker = method, tracker
        if tracker == "inside" and any(system.of_solids):
            raise StandoffError(
                'tracker="inside" is for convex bodies: the places at which solids touch are born '
                'and end, and are no parameters of a state; take tracker="beside".',
                "tracker",
                tracker,
            )
        self.laws = self._laws(gain, law)
        check_tool(system, self.dt, method)
        check_contacts(system, self.dt, method)
        self._pack()

    def _pack(self) -> None:
        number = METHODS.index(self.method)
        inside = self.tracker == "inside"
        options = packed_laws(self.system, self.laws, self.dt, inside)
        kept = keeps_polytopes(self.laws)
        near = None if inside else near_rows(self.system, self.laws)
        self.packed = pack_system(self.system, self.dt, number, inside, options, kept, near)
        self.ticks_a_reading = int(self.packed[0][K.I_READING])
        prepare_simulation()

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        # in another process the bodies' formulas have other addresses
        self._pack()

    def _laws(self, gain: float | None, law: Laws) -> tuple[Law, ...]:
        if self.tracker == "beside":
            if gain is not None:
                raise StandoffError(
                    f"gain = {shown(gain)} belongs to the law inside; a tracker beside the "
                    "operator has its gain in its law: leave it out.",
                    "gain",
                    gain,
                )
            return laws_beside(self.system, law)
        if law is not None:
            raise StandoffError(
                "law belongs to trackers beside the operator; inside, the operator's own method "
                'integrates the paper\'s law: give gain, or tracker="beside".',
                "law",
                law,
            )
        return (law_inside(self.method, gain),) * len(self.system.pairs)

    def start(self, time: float = 0.0, *, allow_overlap: bool = False) -> SystemState:
        """Return the state of the bodies' own poses and twists, with certified witness points.

        Raises StandoffError: bodies overlap, by a depth that the message gives, and that is not
        allowed.

        Parameters
        ----------
        time : float
            On the clock of the driven bodies' paths [time].
        allow_overlap : bool
            Start even if bodies overlap: they will push each other apart.
        """
        t = number(time, "time")
        overlap = yes_or_no(allow_overlap, "allow_overlap")
        return started(self.system, self.laws, self.dt, t, overlap)

    def run(
        self,
        state: SystemState,
        ticks: int,
        every: int = 1,
        *,
        device: Device | DeviceReadings | None = None,
        progress: Progress | None = None,
        contacts: bool = False,
    ) -> SystemRun:
        """Advance a state by many ticks, in compiled loops.

        Raises StandoffTypeError: not a state; not a device; neither True nor False. Raises
        StandoffError: the motion left all bounds, at a tick that the message gives: a step too long
        for it; too few readings; a device without a coupler.

        Parameters
        ----------
        state : SystemState
            Of this system; it is not changed.
        ticks : int
            How many steps.
        every : int
            Ticks from one record to the next; ``ticks`` is a multiple of it, and if a coupler has a
            device, it is a multiple of the ticks from reading to reading.
        device : Device or DeviceReadings, optional
            What moves the handle of the system's coupler. A device must be open; it is read, and
            its wrench written, once per period: the ticks of a period are one compiled call.
            Readings that are given run without Python. Without either, an engaged coupler lets go.
        progress : callable, optional
            Called now and then with the ticks done and the ticks in all.
        contacts : bool
            Keep all places and spots of each record, for `SystemRun.contacts` and for ``so.view``.
        """
        self._check_state(state)
        ticks, every = self._counts(ticks, every)
        told = ContactHistory() if yes_or_no(contacts, "contacts") else None
        check_device(device, self.system.coupler is not None)
        check_count(device, ticks // self.ticks_a_reading)
        count = ticks // every + 1
        width, length = account_width(self.system), state_length(self.system)
        if count * (length + width) > MOST_NUMBERS:
            raise StandoffError(
                f"{count} records of {length + width} numbers are more than {MOST_NUMBERS}: "
                "record fewer ticks (every=...), or run in parts.",
                "ticks",
                ticks,
            )
        states, accounts = np.empty((count, length)), np.empty((count, width))
        going = Going(self.room_for(state), state.time, every)
        size = 1 if isinstance(device, Device) or told else max(1, BLOCK // every)
        if told:
            self._tell(going.data, told)
        for first, last in blocks(count - 1, size):
            rows = slice(first, last + 1)
            records = (states[rows], accounts[rows])
            if isinstance(device, Device):
                self._with_device(going, first, device, records)
            else:
                a_record = every // self.ticks_a_reading
                read = given_readings(device, first * a_record, (last - first) * a_record)
                self._advance(going, first * every, read, records)
            if told:
                self._tell(going.data, told)
            if progress is not None:
                progress(last * every, ticks)
        for array in (states, accounts):
            array.flags.writeable = False
        going.data.flags.writeable = False
        final = SystemState(self.system, going.data)
        return SystemRun(self.system, states, accounts, final, told.rows if told else None)

    def contacts(self, state: SystemState) -> tuple[PairContact, ...]:
        """Return all contacts of a state: pairs that touch or nearly do, of convex bodies and
        solids, with all their places and what each spot pushes.

        Raises StandoffTypeError, StandoffError: not a state; a state of another system.

        Parameters
        ----------
        state : SystemState
            Of this system. Of one that keeps no places, a start or a record, they are found as a
            run that begins with it finds them.
        """
        self._check_state(state)
        told, data = ContactHistory(), self.room_for(state)
        self._tell(data, told)
        spots, places = told.rows.spots_of(0), told.rows.places_of(0)
        return pair_contacts(self.system, data[: state_length(self.system)], spots, places)

    def _tell(self, data: Array, told: ContactHistory) -> None:
        """Add the contacts of a state in its data, in which places may be found first."""
        shape = state_length(self.system), account_width(self.system)
        records = np.empty((1, shape[0])), np.empty((1, shape[1]))
        still = np.zeros((1, 1)), np.zeros(1)
        while not told.fits():
            entries.run_system(self.packed, data, still, 1, records, told.room)
        told.take(SystemState(self.system, data))

    def room_for(self, state: SystemState) -> Array:
        """A copy of a state's numbers, with room for what is kept beside its row."""
        data = np.zeros(state_length(self.system) + kept_numbers(self.system, self.laws))
        given = state.data[: len(data)]
        data[: len(given)] = given
        return data

    def _counts(self, ticks: Any, every: Any) -> tuple[int, int]:
        """Ticks and ticks a record, in whole records of whole readings."""
        ticks, every = whole_number(ticks, "ticks"), whole_number(every, "every")
        if ticks % every:
            raise StandoffError(
                f"ticks = {ticks} is not a multiple of every = {every}: the last tick would not be "
                "recorded.",
                "every",
                every,
            )
        if every % self.ticks_a_reading:
            raise StandoffError(
                f"every = {every} is not a multiple of {self.ticks_a_reading}, the ticks from one "
                "reading of the device to the next: records are made where readings come.",
                "every",
                every,
            )
        return ticks, every

    def _with_device(
        self, going: Going, record: int, device: Device, records: tuple[Array, Array]
    ) -> None:
        """The ticks from one record to the next, reading by reading."""
        ticks, at = self.ticks_a_reading, coupler_at(self.system)
        states = np.empty((2, records[0].shape[1])), np.empty((2, records[1].shape[1]))
        short = going._replace(every=ticks)
        for reading in range(going.every // ticks):
            done = record * going.every + reading * ticks
            self._advance(short, done, read(device), states)
            write(device, going.data[at:])
            if record == 0 and reading == 0:
                records[0][0], records[1][0] = states[0][0], states[1][0]
        records[0][1], records[1][1] = states[0][1], states[1][1]

    def _advance(
        self, going: Going, done: int, readings: Array, records: tuple[Array, Array]
    ) -> None:
        """One compiled loop: the data are changed in place, the records are written."""
        data, every = going.data, going.every
        ticks = every * (len(records[0]) - 1)
        # counted from the start of the run, so that blocks add no rounding
        data[K.S_TIME] = going.start + done * self.dt
        table = driven_table(self.system, float(data[K.S_TIME]), self.dt, ticks)
        tick, why = entries.run_system(
            self.packed, data, (table, readings), every, records, no_room()
        )
        if why != T.FINE:
            at = done + tick + 1
            raise StandoffError(
                f"After tick {at} ({going.start + at * self.dt:g} s) a body's motion was no longer "
                "finite: take a shorter step or less stiffness."
            )

    def step(self, state: SystemState, reading: DeviceReading | None = None) -> SystemState:
        """Advance a state by one tick; with a coupler, by those of one reading of its device.

        Raises StandoffTypeError, StandoffError as `run`.

        Parameters
        ----------
        state : SystemState
        reading : DeviceReading, optional
            Of the coupler's device; None if nothing came: then an engaged coupler lets go. The
            wrench to be held on the handle is `state.coupler.wrench_on_device` of the new state.
        """
        given = None if reading is None else DeviceReadings([reading])
        ticks = self.ticks_a_reading
        return self.run(state, ticks, ticks, device=given).final

    def _check_state(self, state: Any) -> None:
        if not isinstance(state, SystemState):
            raise StandoffTypeError(
                f"state is {shown(state)}: get one from operator.start.", "state", state
            )
        if state.system.key != self.system.key:
            raise StandoffError(
                "The state belongs to another system: get one from operator.start.", "state", state
            )

    def __repr__(self) -> str:
        return (
            f"<Operator {self.method}, tracker {self.tracker}, dt = {self.dt:g}, of "
            f"{self.system!r}>"
        )


# Contacts of a system that a step can follow: what is refused before a run.


def check_contacts(system: System, dt: float, method: str) -> None:
    """Refuse contacts that a method does not follow with a step.

    Raises StandoffError: a stiffness beyond the largest stable one, or a slip speed below the
    least, which the message gives.
    """
    for pair in range(len(system.pairs)):
        _check_stiffness(system, dt, method, pair)
        _check_slip(system, dt, pair)


def _check_stiffness(system: System, dt: float, method: str, pair: int) -> None:
    """Refuse a contact that the step does not follow."""
    contact = system.contacts[pair]
    give = system.springs(pair) * system.give(pair)
    depth = system.depth(pair)
    slope, drag = contact.tangent(depth)
    if stability.is_stable(method, give * slope, give * drag, dt):
        return
    largest = stability.largest_stable_stiffness(contact, method, dt, give, depth)
    names = " and ".join(system.bodies[k].body.name for k in system.pairs[pair])
    raise StandoffError(
        f"stiffness = {contact.stiffness:g} of {names} is beyond what {method} follows at "
        f"dt = {dt:g} down to the depth {depth:g}: the largest stable one is "
        f"{largest:.4g}. Take a shorter step, less stiffness or damping, or give the depth "
        "that the contact is meant for.",
        "stiffness",
        contact.stiffness,
    )


def _check_slip(system: System, dt: float, pair: int) -> None:
    """Refuse friction that would throw a resting body to and fro."""
    contact = system.contacts[pair]
    least = stability.least_slip_speed(contact.friction, system.weight(pair), system.give(pair), dt)
    if contact.friction > 0.0 and contact.slip_speed < least:
        raise StandoffError(
            f"slip_speed = {contact.slip_speed:g} is too small for dt = {dt:g}: friction "
            "would throw a body back and forth under its own weight. Give at least "
            f"{least:.4g}, or take a shorter step.",
            "slip_speed",
            contact.slip_speed,
        )


# Which couplers a system's step follows: the tool's own motion on the coupler's spring.


def check_tool(system: System, dt: float, method: str) -> None:
    """Refuse a coupler on whose spring the tool's motion would grow by the step alone.

    Raises StandoffError: the message gives the largest stable stiffness.
    """
    coupler, tool = system.coupler, system.tool
    if coupler is None or tool is None:
        return
    mass = system.bodies[tool].mass_properties
    assert mass is not None, "a tool is free"
    turning = 1.0 / float(mass.principal_moments[0])
    # the coupler holds the tool at its origin
    pushed = 1.0 / mass.mass + float(np.dot(mass.centre, mass.centre)) * turning
    for kind, give in (("", pushed), ("rotational_", turning)):
        stiffness = float(getattr(coupler, f"{kind}stiffness"))
        damping = float(getattr(coupler, f"{kind}damping"))
        if stability.is_stable_held(method, give * stiffness, give * damping, dt):
            continue
        largest = stability.largest_coupled_stiffness(damping, method, dt, give)
        cure = (
            f"the largest stable one is {largest:.4g}"
            if largest > 0.0
            else f"with {kind}damping = {damping:g} none is stable"
        )
        raise StandoffError(
            f"{kind}stiffness = {stiffness:g} of the coupler, held over a step, is beyond what "
            f"{method} follows at dt = {dt:g} with a tool that gives by {give:.4g} (one over its "
            f"mass or least inertia): {cure}. Take a shorter step, or a heavier tool.",
            f"{kind}stiffness",
            stiffness,
        )
