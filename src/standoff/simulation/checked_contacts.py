"""Contacts of a system that a step can follow: what is refused before a run."""

from __future__ import annotations

from standoff.errors import StandoffError
from standoff.simulation import stability
from standoff.simulation.system import System


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
