"""``standoff servo``: a scene in real time, its summary and its log."""

from __future__ import annotations

import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from standoff.cli.arguments import ServoCommand
from standoff.cli.errors import CommandError, ExitCode, MissingExtra
from standoff.cli.facts import json_text, simulation_facts
from standoff.cli.output import check_results, write_whole
from standoff.cli.summary import line
from standoff.cli.terminal import tell
from standoff.devices import Inverse3, Trace
from standoff.errors import StandoffError
from standoff.kernels.compiler.notices import say
from standoff.scene import SceneError
from standoff.scene.simulation import SimulationScene, load_simulation
from standoff.servo import Servo, ServoReport
from standoff.servo.report import fault_told
from standoff.simulation.device import Fault
from standoff.wording import counted, printable

HAPLY = "haply"
LOOKED = 0.05
"""Seconds between two looks at the loop."""
FIRST_READING = 5.0
"""Seconds in which a device must say something."""
MICRO = 1e6
"""Microseconds of a second."""


def run_servo(command: ServoCommand) -> int:
    """Run a scene in real time, write the log asked for, and print the summary.

    Raises SceneError, CommandError if the scene, an option or the output file is not usable, or
    there is no device. Raises WriteError if the log could not be written after all.
    """
    check_results(command.output, "standoff.servo.file")
    rate = command.rate
    if rate is not None and not (math.isfinite(rate) and rate > 0.0):
        raise CommandError(f"--rate {rate}: give ticks a second, 10 to 10000")
    scene = load_simulation(command.scene, rate=rate)
    if scene.device is None:
        raise SceneError(
            "a servo is felt through a coupler; add [coupler] and [device]",
            key="coupler",
            file=scene.file,
        )
    try:
        state = scene.operator.start(scene.start, allow_overlap=scene.allow_overlap)
        servo = Servo(
            scene.operator,
            state=state,
            device=_device(command.device, scene),
            seconds=command.seconds,
            real_time=True,
        )
        report = _served(servo)
    except SceneError:
        raise
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name), "devices") from error
    except StandoffError as error:
        raise CommandError(str(error)) from error
    facts = _facts(scene, report)
    if command.output is not None:
        from standoff.servo.file import write_log

        write_whole({command.output: lambda file: write_log(report, facts, file)})
    tell(json_text(facts) if command.json else "\n".join(_lines(scene, report, command.output)))
    sound = report.ended.sound and report.fault is Fault.NONE
    return ExitCode.DONE if sound else ExitCode.FAILED


def _device(name: str, scene: SimulationScene) -> Any:
    """What moves the handle, by the word or file that was given."""
    own = scene.device
    if name == "simulated":
        return own
    if name == "path":
        hand = None if own is None else own.hand
        if hand is None:
            raise SceneError(
                "the scene's device does not follow a path; add [device.path], or give --device",
                key="device",
                file=scene.file,
            )
        end = scene.ticks * scene.operator.dt
        return Trace(hand.path, 0.0, end, there_and_back=True)
    if name == HAPLY or name.startswith(f"{HAPLY}="):
        period = scene.operator.dt * scene.operator.ticks_a_reading
        url = name.partition("=")[2]
        return Inverse3(url, period=period) if url else Inverse3(period=period)
    if Path(name).suffix.lower() in (".parquet", ".csv", ".tum", ".txt"):
        try:
            return Trace.read(name)
        except OSError as error:
            raise CommandError(f"--device {name}: {error}") from error
    raise CommandError(
        f"--device {name}: give path, simulated, haply, haply=ws://HOST:PORT, or a recorded trace "
        "(.parquet, .csv, .tum)"
    )


@contextmanager
def _asked_to_end() -> Iterator[list[int]]:
    """The signals that came, in place of what they would do."""
    came: list[int] = []
    kinds = (signal.SIGINT, signal.SIGTERM)

    def note(number: int, frame: object) -> None:
        came.append(number)

    before = {kind: signal.signal(kind, note) for kind in kinds}
    try:
        yield came
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)


def _served(servo: Servo) -> ServoReport:
    """The whole run: engaged with the first reading, ended by a signal, a fault, or its time."""
    with _asked_to_end() as came:
        servo.start()
        try:
            waited = 0.0
            while not (servo.ready or came or servo.wait(LOOKED) or waited > FIRST_READING):
                waited += LOOKED
            servo.engage()
            say("engaged; Ctrl-C ends it")
            while not (came or servo.wait(LOOKED)):
                told = servo.latest()
                if told.ended is None and told.fault is not Fault.NONE:
                    problem = printable(servo.problem)
                    say(f"the coupler let go: {fault_told(told.fault)} {problem}".rstrip())
                    break
        finally:
            report = servo.stop()
    for note in report.notes:
        say(printable(note))
    return report


def _facts(scene: SimulationScene, report: ServoReport) -> dict[str, Any]:
    """The summary as plain data."""
    found = report.statistics
    return simulation_facts(scene) | {
        "rate": report.rate,
        "ended": report.ended.name,
        "message": report.message,
        "fault": report.fault.name,
        "advice": report.fault.advice,
        "problem": report.problem,
        "notes": list(report.notes),
        "ticks": found.ticks,
        "missed": found.missed,
        "engaged": found.engaged,
        "period": found.period._asdict(),
        "lateness": found.lateness._asdict(),
        "work": found.work._asdict(),
    }


def _lines(scene: SimulationScene, report: ServoReport, written: Path | None) -> list[str]:
    found = report.statistics
    lines = [
        line("scene", scene.title),
        line("ended", report.message),
        line(
            "ticks",
            f"{found.ticks} at {report.rate:g} Hz, {counted(found.missed, 'deadline')} missed",
        ),
        line("engaged", f"in {counted(found.engaged, 'tick')}"),
        line("fault", f"{fault_told(report.fault)} {report.problem}".rstrip()),
        line("times, µs", "median, p99, p99.9, p99.99, worst"),
    ]
    for name in ("period", "lateness", "work"):
        values = ", ".join(f"{MICRO * value:.1f}" for value in getattr(found, name))
        lines.append(line(name, values))
    return lines if written is None else [*lines, line("wrote", str(written))]
