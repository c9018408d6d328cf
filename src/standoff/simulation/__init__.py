"""What bodies weigh; the coupler between a tool and a hand, and the devices it is felt by."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.simulation.coupler import VirtualCoupler
    from standoff.simulation.coupler_state import CouplerCounts, CouplerState
    from standoff.simulation.device import Device, DeviceLimits, DeviceReading, Fault
    from standoff.simulation.disturbances import Disturbances
    from standoff.simulation.encoder import Encoder
    from standoff.simulation.human_arm import HumanArm
    from standoff.simulation.mass_properties import MassErrors, MassProperties, mass_properties
    from standoff.simulation.passivity import (
        Sampling,
        largest_stiffness,
        required_damping,
        required_damping_of,
    )
    from standoff.simulation.passivity_observer import PassivityController, PortEnergy
    from standoff.simulation.simulated_device import Mechanism, ScriptedHand, SimulatedDevice
    from standoff.simulation.wrench import Wrench
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.simulation.coupler": ("VirtualCoupler",),
            "standoff.simulation.coupler_state": ("CouplerCounts", "CouplerState"),
            "standoff.simulation.device": (
                "Device",
                "DeviceLimits",
                "DeviceReading",
                "Fault",
            ),
            "standoff.simulation.disturbances": ("Disturbances",),
            "standoff.simulation.encoder": ("Encoder",),
            "standoff.simulation.human_arm": ("HumanArm",),
            "standoff.simulation.mass_properties": (
                "MassErrors",
                "MassProperties",
                "mass_properties",
            ),
            "standoff.simulation.passivity": (
                "Sampling",
                "largest_stiffness",
                "required_damping",
                "required_damping_of",
            ),
            "standoff.simulation.passivity_observer": ("PassivityController", "PortEnergy"),
            "standoff.simulation.simulated_device": (
                "Mechanism",
                "ScriptedHand",
                "SimulatedDevice",
            ),
            "standoff.simulation.wrench": ("Wrench",),
        },
    )

__all__ = [
    "CouplerCounts",
    "CouplerState",
    "Device",
    "DeviceLimits",
    "DeviceReading",
    "Disturbances",
    "Encoder",
    "Fault",
    "HumanArm",
    "MassErrors",
    "MassProperties",
    "Mechanism",
    "PassivityController",
    "PortEnergy",
    "Sampling",
    "ScriptedHand",
    "SimulatedDevice",
    "VirtualCoupler",
    "Wrench",
    "largest_stiffness",
    "mass_properties",
    "required_damping",
    "required_damping_of",
]
