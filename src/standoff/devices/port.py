"""Where a device meets the loop that it is felt by: readings go in, the wrench comes out."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from standoff.simulation.device import DeviceReading, Fault
from standoff.simulation.wrench import Wrench


class Port(Protocol):
    """A loop as a device sees it. Its calls never wait for the loop, and never raise.

    Attributes
    ----------
    max_age : float
        Greatest age of a reading [s]: what is older ends in zero force.
    """

    @property
    def max_age(self) -> float: ...

    def put(self, reading: DeviceReading | None) -> None:
        """Give the newest reading; None where there is none. Its time is `time.monotonic()`."""
        ...

    def fail(self, fault: Fault) -> None:
        """Say that the device cannot be trusted: no force until the loop is engaged again."""
        ...

    def wrench(self) -> Wrench:
        """Return what to hold on the handle now; zero if the loop has said nothing lately."""
        ...


@runtime_checkable
class LiveDevice(Protocol):
    """A device that gives its readings by itself, from its own thread or its caller's.

    Attributes
    ----------
    problem : str
        Why it no longer gives readings, and what to do; empty while nothing is wrong.
    """

    @property
    def problem(self) -> str: ...

    def attach(self, port: Port) -> None:
        """Begin to give readings to a port. Raises `DeviceError` where there is no device."""
        ...

    def detach(self) -> None:
        """Hold no more force, and give no more readings; does nothing where it gives none."""
        ...
