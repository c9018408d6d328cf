"""Devices that move a servo's handle: recorded traces, a pointer, Haply's Inverse3, any driver."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.devices.inverse3 import Inverse3
    from standoff.devices.pointer import PointerDevice
    from standoff.devices.polled import Polled
    from standoff.devices.port import LiveDevice, Port
    from standoff.devices.trace import Trace
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = ["Inverse3", "LiveDevice", "PointerDevice", "Polled", "Port", "Trace"]
