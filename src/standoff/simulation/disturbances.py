"""What can go wrong between a device and the loop, by a script and by chance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np

from standoff.checks.names import choice
from standoff.checks.numbers import is_whole, number, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import DeviceError, StandoffError, StandoffTypeError
from standoff.simulation.device import DeviceReading

Disturbance: TypeAlias = Literal[
    "missing", "late", "nan", "inf", "shape", "order", "invalid", "disconnect"
]

KINDS: Final = get_args(Disturbance)


@dataclass(frozen=True, kw_only=True)
class Disturbances:
    """What a simulated device does to its readings, the same at every run.

    Raises StandoffError: not a mapping, an unknown word, a number of a reading below zero, or what
    is not a probability.

    Parameters
    ----------
    script : mapping from int to str
        By the number of the reading, from 0: "missing" (None comes), "late" (this reading and all
        later ones never come; the last one is repeated), "nan" and "inf" (in the position), "shape"
        (a position of two numbers), "order" (an older sequence number), "invalid" (the device says
        so itself), "disconnect" (`DeviceError`, from then on).
    drop_out : float
        Probability of each reading to be lost; the last one comes again.
    malformed : float
        Probability of each reading to come as one of "nan", "inf", "shape", "order", "invalid".
    seed : int
        Seed of both.
    """

    script: Mapping[int, str] = field(default_factory=dict)
    drop_out: float = 0.0
    malformed: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not isinstance(self.script, Mapping):
            raise StandoffTypeError(
                f"script is {shown(self.script)}: give a mapping from numbers of readings to words",
                "script",
                self.script,
            )
        for reading, kind in self.script.items():
            choice(kind, "script", KINDS)
            if not is_whole(reading) or reading < 0:
                raise StandoffError(
                    f"script names reading {shown(reading)}: give whole numbers from 0",
                    "script",
                    self.script,
                )
        for name in ("drop_out", "malformed"):
            chance = number(getattr(self, name), name)
            object.__setattr__(self, name, chance)
            if not 0.0 <= chance <= 1.0:
                raise StandoffError(f"{name} is {chance}: give a probability, 0 to 1", name, chance)
        whole_number(self.seed, "seed", 0)

    def running(self) -> RunningDisturbances:
        """Return what disturbs one run, from its start."""
        return RunningDisturbances(self)


class RunningDisturbances:
    """Disturbances in the course of one run.

    Parameters
    ----------
    disturbances : Disturbances
    """

    def __init__(self, disturbances: Disturbances) -> None:
        self._given = disturbances
        self._draws = np.random.Generator(np.random.PCG64(disturbances.seed))
        self._late = False
        self._last: DeviceReading | None = None

    def disturbed(self, number: int, reading: DeviceReading) -> Any:
        """Return what comes in place of reading `number`; raises `DeviceError` where it is gone."""
        lost, broken, which = self._draws.random(3)
        kind = self._given.script.get(number, "")
        if not kind and broken < self._given.malformed:
            kind = ("nan", "inf", "shape", "order", "invalid")[int(5.0 * which)]
        if kind == "disconnect":
            raise DeviceError(f"the device is gone since reading {number}; connect it and open it")
        if kind == "missing":
            return None
        self._late = self._late or kind == "late"
        if self._late or (not kind and lost < self._given.drop_out):
            return self._last
        if not kind:
            self._last = reading
            return reading
        return _broken(kind, reading)


def _broken(kind: str, reading: DeviceReading) -> Any:
    rotation, position = reading.pose.rotation, reading.pose.translation.copy()  # type: ignore[union-attr]
    if kind == "order":
        return reading._replace(sequence=max(reading.sequence - 2, 0), time=reading.time)
    if kind == "invalid":
        return reading._replace(valid=False)
    if kind == "shape":
        return reading._replace(pose=(rotation, position[:2]))
    position[1] = np.nan if kind == "nan" else np.inf
    return reading._replace(pose=(rotation, position))
