"""The human hand on a device's handle: a mass, a damper and a spring to where it tries to be."""

from __future__ import annotations

from dataclasses import dataclass, fields

from standoff.checks.numbers import not_negative


@dataclass(frozen=True, kw_only=True)
class HumanArm:
    """The mechanical impedance of a hand that holds a handle firmly.

    Second order, the same in all directions. Spring and damper act between the handle and the pose
    that the hand tries to reach.

    Raises StandoffError: a number that is not finite, or below zero.

    Parameters
    ----------
    mass : float
        Moves with the handle [kg].
    damping : float
        [N s/m]
    stiffness : float
        [N/m]
    rotational_inertia : float
        About each axis, turns with the handle [kg m²].
    rotational_damping : float
        [N m s/rad]
    rotational_stiffness : float
        [N m/rad]
    """

    mass: float
    damping: float
    stiffness: float
    rotational_inertia: float = 0.0
    rotational_damping: float = 0.0
    rotational_stiffness: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = not_negative(getattr(self, field.name), field.name)
            object.__setattr__(self, field.name, value)

    @classmethod
    def none(cls) -> HumanArm:
        """Return the absence of a hand."""
        return cls(mass=0.0, damping=0.0, stiffness=0.0)

    @classmethod
    def fingertip(cls) -> HumanArm:
        """Return a light touch, with a mass that masks nothing of the device.

        Chosen values, of the order that Hajian and Howe (J. Biomechanical Engineering 119(1), 1997)
        report for index fingers in extension, not taken from a table: fit your own for a study of
        people. A fingertip does not hold the handle's rotation.
        """
        return cls(mass=0.006, damping=5.0, stiffness=400.0)

    @classmethod
    def relaxed(cls) -> HumanArm:
        """Return an arm at rest that holds a knob.

        Translation: one trial of van Beek, Bergmann Tiest, Mugge and Kappers, Scientific Reports
        5:18004, 2015 (M = 0.554 kg, B = 6.45 N s/m, K = 135 N/m). Rotation: chosen, the order of a
        passive wrist at rest; it is stiffer in radial and ulnar deviation than in flexion (Formica
        et al., J. Neurophysiology 108(4), 2012), which one number cannot say.
        """
        return cls(
            mass=0.554,
            damping=6.45,
            stiffness=135.0,
            rotational_inertia=0.003,
            rotational_damping=0.03,
            rotational_stiffness=1.0,
        )

    @classmethod
    def tensed(cls) -> HumanArm:
        """Return an arm with its muscles tensed: eight times as stiff as `relaxed`, at the same
        ratio of damping.

        A scaled value, not a measured one; co-contraction raises stiffness by about as much.
        """
        arm = cls.relaxed()
        return cls(
            mass=arm.mass,
            damping=arm.damping * 8.0**0.5,
            stiffness=arm.stiffness * 8.0,
            rotational_inertia=arm.rotational_inertia,
            rotational_damping=arm.rotational_damping * 8.0**0.5,
            rotational_stiffness=arm.rotational_stiffness * 8.0,
        )
