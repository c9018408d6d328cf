"""Rigid bodies that move and touch, and what they weigh; the coupler between a tool and a hand, and
the devices it is felt by."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.simulation.adaptive import Solution, SystemEvent, solve
    from standoff.simulation.adaptive_bodies import SystemSolution
    from standoff.simulation.contact import HuntCrossley
    from standoff.simulation.coupler import VirtualCoupler
    from standoff.simulation.coupler_run import CouplerRun
    from standoff.simulation.coupler_state import CouplerCounts, CouplerState
    from standoff.simulation.device import Device, DeviceLimits, DeviceReading, Fault
    from standoff.simulation.device_readings import DeviceReadings
    from standoff.simulation.disturbances import Disturbances
    from standoff.simulation.encoder import Encoder
    from standoff.simulation.generalised_system import GeneralisedSystem
    from standoff.simulation.human_arm import HumanArm
    from standoff.simulation.mass_properties import MassErrors, MassProperties, mass_properties
    from standoff.simulation.operator import Operator
    from standoff.simulation.pair_contacts import PairContact, SpotForce
    from standoff.simulation.passivity import (
        Sampling,
        largest_stiffness,
        required_damping,
        required_damping_of,
    )
    from standoff.simulation.passivity_observer import PassivityController, PortEnergy
    from standoff.simulation.rigid_body import RigidBody
    from standoff.simulation.simulated_device import Mechanism, ScriptedHand, SimulatedDevice
    from standoff.simulation.solid_places import ContactPlace, ContactSpot, SolidContact
    from standoff.simulation.system import System
    from standoff.simulation.system_run import SystemRun
    from standoff.simulation.system_state import Crossing, Energy, SystemState
    from standoff.simulation.wrench import Wrench
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "ContactPlace",
    "ContactSpot",
    "CouplerCounts",
    "CouplerRun",
    "CouplerState",
    "Crossing",
    "Device",
    "DeviceLimits",
    "DeviceReading",
    "DeviceReadings",
    "Disturbances",
    "Encoder",
    "Energy",
    "Fault",
    "GeneralisedSystem",
    "HumanArm",
    "HuntCrossley",
    "MassErrors",
    "MassProperties",
    "Mechanism",
    "Operator",
    "PairContact",
    "PassivityController",
    "PortEnergy",
    "RigidBody",
    "Sampling",
    "ScriptedHand",
    "SimulatedDevice",
    "SolidContact",
    "Solution",
    "SpotForce",
    "System",
    "SystemEvent",
    "SystemRun",
    "SystemSolution",
    "SystemState",
    "VirtualCoupler",
    "Wrench",
    "largest_stiffness",
    "mass_properties",
    "required_damping",
    "required_damping_of",
    "solve",
]
