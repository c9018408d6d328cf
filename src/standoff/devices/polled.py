"""Any `Device`, asked once a period by a thread in Python."""

from __future__ import annotations

import threading
import time

from standoff.bound_to_run import BoundToRun
from standoff.checks.numbers import positive, yes_or_no
from standoff.checks.real_numbers import shown
from standoff.devices.port import Port
from standoff.errors import DeviceError, StandoffTypeError
from standoff.simulation.device import Device, Fault


class Polled(BoundToRun):
    """A `Device` whose readings and wrenches go to and from a loop, once per period.

    Python reads it, and is late now and then; what matters is that a late reading is recognised as
    late.

    Raises StandoffTypeError: not a device. Raises StandoffError: a period that is not above zero; a
    flag that is neither true nor false.

    Parameters
    ----------
    device : Device
        Closed; it is opened when it is attached.
    period : float
        From reading to reading [s].
    stamped : bool
        Its readings carry the time of `time.monotonic()`; else they are stamped when they arrive.

    Attributes
    ----------
    problem : str
        Why it no longer gives readings.
    """

    def __init__(self, device: Device, *, period: float, stamped: bool = True) -> None:
        if not isinstance(device, Device):
            raise StandoffTypeError(
                f"device is {shown(device)}: give one with the calls of simulation.Device.",
                "device",
                device,
            )
        self._inner, self._stamped = device, yes_or_no(stamped, "stamped")
        self._period = positive(period, "period")
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self.problem = ""

    def attach(self, port: Port) -> None:
        """Open the device, and begin to give readings to a port.

        Raises DeviceError: there is no device, or it gives its readings to another port.
        """
        if self._thread is not None:
            raise DeviceError("the device moves another loop's handle; stop that loop first")
        self._inner.open()
        self._stopping.clear()
        self.problem = ""
        self._thread = threading.Thread(target=self._ask, args=(port,), name="device", daemon=True)
        self._thread.start()

    def detach(self) -> None:
        """Close the device, its wrench zero; does nothing where it is closed."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _ask(self, port: Port) -> None:
        """The device's thread."""
        due = time.monotonic()
        try:
            while not self._stopping.is_set():
                reading = self._inner.read()
                if reading is not None and not self._stamped:
                    reading = reading._replace(time=time.monotonic())
                port.put(reading)
                self._inner.write(port.wrench())
                now = time.monotonic()
                due = max(due + self._period, now)
                self._stopping.wait(due - now)
        except Exception as error:  # whatever a driver raises, the force must end
            self.problem = f"the device gives no readings any more: {error}"
        finally:
            port.fail(Fault.MISSING)
            self._inner.close()
