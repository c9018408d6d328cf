"""A step of MuJoCo with contacts that are given between its own collision and constraints."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from standoff.errors import StandoffError, of_extra

with of_extra("MuJoCo", "mujoco"):
    import mujoco

POSITION = (
    mujoco.mj_checkPos,
    mujoco.mj_checkVel,
    mujoco.mj_kinematics,
    mujoco.mj_comPos,
    mujoco.mj_camlight,
    mujoco.mj_flex,
    mujoco.mj_tendon,
    mujoco.mj_makeM,
    mujoco.mj_factorM,
)
"""What a step of MuJoCo does before its contacts."""

VELOCITY = (
    mujoco.mj_makeConstraint,
    mujoco.mj_island,
    mujoco.mj_transmission,
    mujoco.mj_projectConstraint,
    mujoco.mj_sensorPos,
    mujoco.mj_fwdVelocity,
    mujoco.mj_sensorVel,
)
"""And between them and the control."""


def stepped(model: Any, data: Any, give_contacts: Callable[[Any], Any]) -> None:
    """``mj_step`` by the model's integrator but RK4; `give_contacts` is called with the data.

    Raises StandoffError: the model asks for RK4, which makes contacts within a step.
    """
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        raise StandoffError(
            "The model's integrator is RK4, within whose steps no contact can be given: set "
            "contacts.model.opt.integrator to Euler, implicit or implicitfast.",
            "integrator",
        )
    for work in (*POSITION, mujoco.mj_collision):
        work(model, data)
    give_contacts(data)
    for work in VELOCITY:
        work(model, data)
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_ENERGY:
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
    control = mujoco.get_mjcb_control()
    if control is not None:
        control(model, data)
    mujoco.mj_step2(model, data)
