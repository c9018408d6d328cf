"""Systems in real time: a fixed-rate loop, felt by a device."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.servo.loop import Servo, Snapshot
    from standoff.servo.report import Ended, ServoReport
    from standoff.servo.statistics import ServoStatistics, Spread
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = ["Ended", "Servo", "ServoReport", "ServoStatistics", "Snapshot", "Spread"]
