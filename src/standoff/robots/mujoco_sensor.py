"""Exact distances as MuJoCo's sensors: ``so.robots.MujocoSensor``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from standoff.errors import StandoffError, of_extra
from standoff.robots.mujoco_robot import model_of, watched
from standoff.robots.near import NearLinks
from standoff.robots.robot import Robot

with of_extra("MuJoCo", "mujoco"):
    import mujoco


class MujocoSensor:
    """Fills a model's user sensors with exact distances; give it to ``mujoco.set_mjcb_sensor``.

    Of a sensor of dimension 1 the number is the signed distance; with dimension 2 its proven lower
    bound follows. Of a pair beyond the horizon both are the horizon, as MuJoCo's own have their
    cutoff. In MJCF: ``<user name="gap" dim="2" needstage="pos" datatype="real"/>``.

    Raises ModuleNotFoundError: MuJoCo is not installed; the message names the extra. Raises
    TypeError: no robot. Raises ValueError: a sensor that the model does not have, or not as a user
    sensor of dimension 1 or 2 of the position stage; a pair that the robot does not watch.

    Parameters
    ----------
    robot : Robot
        Of the MuJoCo model, without obstacles.
    sensors : mapping of str to (str, str) or None
        By the sensor's name the two geoms' names, or None for the nearest of all pairs.
    within : float, optional
        The horizon, length; the robot's own if not given.
    """

    def __init__(
        self,
        robot: Robot,
        sensors: Mapping[str, tuple[str, str] | None],
        *,
        within: float | None = None,
    ) -> None:
        self._near = NearLinks(robot, -math.inf, within)
        model, _ = model_of(robot)
        self._size = (model.nq, model.nsensordata)
        self._sensors = [
            (*_place(model, name), None if pair is None else watched(robot, [pair])[0])
            for name, pair in sensors.items()
        ]

    def __call__(self, model: Any, data: Any, stage: int) -> None:
        """As MuJoCo calls it: models of other sizes, and other stages, are left alone."""
        wanted = stage == mujoco.mjtStage.mjSTAGE_POS
        if not wanted or (model.nq, model.nsensordata) != self._size:
            return
        rows = self._near.rows(data.qpos)
        at = {tuple(pair): k for k, pair in enumerate(rows.bodies.tolist())}
        nearest = int(rows.distance.argmin()) if len(rows) else None
        for first, count, pair in self._sensors:
            k = nearest if pair is None else at.get(pair)
            found = [rows.within, rows.within]
            if k is not None:
                bound = rows.clearance if pair is None else rows.lower_bound[k]
                found = [float(rows.distance[k]), float(bound)]
            data.sensordata[first : first + count] = found[:count]


def _place(model: Any, name: str) -> tuple[int, int]:
    """Where a sensor's numbers are, and how many.

    Raises StandoffError.
    """
    k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SENSOR, name)
    user = int(mujoco.mjtSensor.mjSENS_USER)
    stage = int(mujoco.mjtStage.mjSTAGE_POS)
    fits = k >= 0 and (model.sensor_type[k], model.sensor_needstage[k]) == (user, stage)
    if not fits or model.sensor_dim[k] not in (1, 2):
        raise StandoffError(
            f"The model has no user sensor {name!r} of dimension 1 or 2 and of the position stage: "
            f'write <user name="{name}" dim="1" needstage="pos"/> into <sensor>.',
            "sensors",
            name,
        )
    return int(model.sensor_adr[k]), int(model.sensor_dim[k])
