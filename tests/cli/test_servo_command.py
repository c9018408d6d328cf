"""`standoff servo`: what it prints and writes, how signals end it, and what it refuses."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partialmethod
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.devices import Trace
from standoff.servo import Servo
from waiting import LONG

SCENE = Path(__file__).parents[2] / "examples" / "simulation" / "hand-on-lens.toml"
Standoff = Callable[..., Any]


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that others use holds up a loop now and then; memory stays as it is."""
    monkeypatch.setattr("standoff.servo.loop.LONGEST_GAP", 2.0)
    monkeypatch.setattr("standoff.servo.loop.ask_for_real_time", lambda: ["memory, not asked for"])


def test_it_tells_how_the_loop_kept_its_time(standoff: Standoff, tmp_path: Path) -> None:
    log = tmp_path / "log.parquet"
    ended = standoff("servo", SCENE, "--seconds", "0.4", "--rate", "1000", "-o", str(log), "--json")
    facts = json.loads(ended.out)
    assert (ended.code, facts["ended"], facts["fault"]) == (0, "DONE", "NONE"), ended.err
    assert (facts["rate"], facts["ticks"]) == (1000.0, 400)
    assert 0 < facts["engaged"] <= 400
    assert 0.0 < facts["work"]["median"] <= facts["work"]["p999"] <= facts["work"]["worst"]
    import pyarrow.parquet as pq

    table = pq.read_table(log)
    assert table.num_rows == 400
    assert table.column("tick").to_pylist() == list(range(400))
    assert np.isfinite(table.column("work").to_numpy()).all()


def test_a_log_is_a_trace(standoff: Standoff, tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    log = tmp_path / "log.parquet"
    standoff("servo", SCENE, "--seconds", "0.3", "--rate", "1000", "-o", str(log))
    table = pq.read_table(log)
    known = table.filter(np.isfinite(table.column("x").to_numpy()))
    pq.write_table(known, log)
    trace = Trace.read(log)
    first = [known.column(axis)[0].as_py() for axis in "xyz"]
    np.testing.assert_allclose(trace.path.pose(trace.start).translation, first, atol=1e-12)


def test_the_fault_is_named(
    standoff: Standoff, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # An age that no reading keeps: the coupler lets go of the first.
    made = Servo.__init__
    monkeypatch.setattr(Servo, "__init__", partialmethod(made, max_age=1e-12))
    log = tmp_path / "log.parquet"
    ended = standoff("servo", SCENE, "--seconds", "2", "--device", "simulated", "-o", str(log))
    assert ended.code == 3
    (line,) = re.findall(r"^fault +(.*)$", ended.out, re.MULTILINE)
    assert line.startswith(f"LATE: {so.simulation.Fault.LATE.advice}")
    assert "Before, the coupler let go: LATE: " in ended.out
    import pyarrow.parquet as pq

    table = pq.read_table(log)
    names = {"time", *"xyz", "qx", "qy", "qz", "qw", "distance", "tick", "lateness", "work"}
    names |= {f"{what}.{axis}" for what in ("tool", "force", "torque") for axis in "xyz"}
    assert set(table.column_names) == names | {"engaged", "fault"}
    assert so.simulation.Fault.LATE in table.column("fault").to_pylist()


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(kind: signal.Signals) -> None:
    running = subprocess.Popen(
        [sys.executable, "-m", "standoff.cli", "servo", str(SCENE), "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(Path(so.__file__).parents[1])},
    )
    assert running.stderr is not None
    assert any("engaged" in text for text in running.stderr)
    time.sleep(0.1)
    running.send_signal(kind)
    out, err = running.communicate(timeout=LONG)
    facts = json.loads(out)
    assert running.returncode == 0 or facts["ended"] == "STALLED", err
    assert "no force is on the handle" in facts["message"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("--rate", "20000"), "20000 a second: a servo runs at 10 to 10000"),
        (("--rate", "-1"), "--rate -1.0: give ticks a second"),
        (("--device", "joystick"), "--device joystick: give path, simulated"),
        (("--device", "none.parquet"), "none.parquet"),
        (("--device", "haply=ws://127.0.0.1:1"), "no Inverse Service answers"),
        (("--seconds", "0"), "seconds = 0.0"),
    ],
)
def test_what_cannot_serve_is_refused(
    standoff: Standoff, given: tuple[str, ...], message: str
) -> None:
    ended = standoff("servo", SCENE, *given)
    assert ended.code == 2
    assert message in ended.err


def test_a_scene_without_a_coupler_is_refused(standoff: Standoff) -> None:
    ended = standoff("servo", SCENE.with_name("bounce.toml"))
    assert ended.code == 2
    assert "add [coupler] and [device]" in ended.err
