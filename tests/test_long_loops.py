"""What takes long says how far it is, on stderr alone, and ends when it is interrupted."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import standoff as so
from standoff import long_loops
from standoff.long_loops import told
from standoff.scene import load_scene
from waiting import LONG

BOXES = "".join(f'[bodies.b{k}]\nshape = "box"\nsize = [1, 2, {1 + k}]\n' for k in range(20_000))
SCENE = f'version = 1\n{BOXES}[placements.b1]\nposition = [9, 0, 0]\n[pair]\na = "b0"\nb = "b1"\n'

# A shell has its background jobs ignore the signal, and they pass that on to what they start.
INTERRUPTIBLE = """
import signal, sys
from standoff.cli import main
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture
def talking(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STANDOFF_QUIET", "0")


@pytest.mark.usefixtures("talking")
def test_a_loop_speaks_where_it_takes_long(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [100.0]
    monkeypatch.setattr("standoff.long_loops.time.monotonic", lambda: now[0])
    for k in told(range(100), "counting"):
        now[0] += 0.5
        assert 0 <= k < 100
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.splitlines()
    assert lines[:2] == ["standoff: counting: 4 of 100", "standoff: counting: 24 of 100"]
    assert len(lines) == 5
    assert list(told(range(3), "counting")) == [0, 1, 2]
    assert capsys.readouterr() == ("", "")


@pytest.mark.usefixtures("talking")
def test_a_body_of_many_patches_and_a_scene_of_many_bodies_speak(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    so.shapes.gore(1.0, 3.0, 8)
    assert capsys.readouterr().out == ""
    monkeypatch.setattr(long_loops, "FIRST_WORD", 0.0)
    so.shapes.gore(1.0, 3.0, 8)
    said = capsys.readouterr()
    assert said.out == ""
    assert "standoff: proving patches convex: 0 of 8" in said.err
    file = tmp_path / "\x1b[2J.toml"
    file.write_text(SCENE.replace(BOXES, BOXES[:150].rpartition("[bodies")[0]))
    load_scene(file)
    said = capsys.readouterr()
    assert said.out == ""
    assert "standoff: reading bodies of \\x1b[2J.toml: 0 of 3" in said.err


def test_an_interrupt_ends_the_reading_of_many_bodies(tmp_path: Path) -> None:
    file = tmp_path / "many.toml"
    file.write_text(SCENE)
    command = [sys.executable, "-c", INTERRUPTIBLE, "distance", str(file)]
    talking = {**os.environ, "STANDOFF_QUIET": "0"}
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stderr=pipe, stdout=pipe, env=talking) as running:
        assert running.stderr is not None
        for line in running.stderr:
            if b"reading bodies" in line:
                break
        running.send_signal(signal.SIGINT)
        try:
            out, err = running.communicate(timeout=LONG)
        finally:
            running.kill()  # else one that goes on would be waited for
    assert running.returncode == 130
    assert out == b""
    assert b"interrupted" in err
    assert b"Traceback" not in err
