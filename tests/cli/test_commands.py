"""`standoff track` and `standoff distance`: what they print, and their exit codes."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from standoff import __version__
from standoff.cli import entry
from standoff.scene import first_impact, load_scene, query, record

Standoff = Callable[..., Any]


def test_track_sums_up_the_run(standoff: Standoff, passing: Path) -> None:
    ended = standoff("track", passing)
    recording = record(load_scene(passing))
    closest = recording.closest()
    assert closest is not None
    assert ended.code == 0
    assert ended.err == ""
    lines = {line[:14].strip(): line[14:] for line in reversed(ended.out.splitlines())}
    assert lines["scene"] == "Tool past a box: A = tool (ellipsoid), B = part (box)"
    assert lines["law"] == "predictor-corrector, predictor feedforward-2"
    assert lines["frames"] == "101 from 0 s to 2 s, 20 ms apart"
    assert lines["certified"] == ("101 of 101 frames, 100 %, tolerance 1e-10 of the pair's size")
    assert lines["closest"].startswith(f"{recording.distance[closest]:.6g} cm at ")
    assert f"part {recording.feature_b[closest]}" in lines["closest"]
    assert lines["worst gap"].startswith(f"{recording.gap.max():.3g} cm")
    assert lines["work"].startswith(f"{recording.total_counts().evaluations} evaluations, ")
    assert lines["events"] == f"{len(recording.events)}:"
    first = recording.events[0]
    assert f"part: {first.source} to {first.target}" in ended.out


def test_only_the_first_events_are_listed(standoff: Standoff, passing: Path) -> None:
    passing.write_text(
        passing.read_text()
        .replace("angular = [0.0, 0.5, 1.0]", "angular = [3.0, 9.0, 5.0]")
        .replace('"ellipsoid"\nsemi_axes = [0.3, 0.1, 0.1]', '"box"\nsize = [0.2, 0.15, 0.1]')
    )
    count = len(record(load_scene(passing)).events)
    assert count > 8
    ended = standoff("track", passing)
    assert f"events        {count}, the first 8:" in ended.out
    assert ended.out.count(" to ") - ended.out.count(" s to ") - 1 == 8


def test_track_json_is_all_of_stdout(standoff: Standoff, passing: Path) -> None:
    ended = standoff("track", passing, "--json", "--step", "0.05")
    facts = json.loads(ended.out)
    recording = record(load_scene(passing), load_scene(passing).settings.overridden({"step": 0.05}))
    assert ended.code == 0
    assert ended.err == ""
    assert facts["standoff"] == __version__
    assert (facts["a"], facts["b"], facts["length_unit"]) == ("tool", "part", "cm")
    assert facts["settings"]["step"] == 0.05
    assert facts["frames"] == 41
    assert facts["certified_share"] == 1.0
    assert facts["closest"]["distance"] == recording.distance.min()
    assert facts["worst_gap"] == recording.gap.max()
    assert facts["counts"] == recording.total_counts()._asdict()
    assert len(facts["events"]) == len(recording.events)
    assert facts["events"][0]["target"] == str(recording.events[0].target)


def test_penetration_is_certified(standoff: Standoff, crossing: Path) -> None:
    ended = standoff("track", crossing)
    assert ended.code == 0
    facts = json.loads(standoff("track", crossing, "--json").out)
    assert set(facts["statuses"]) == {"CONVERGED", "GLOBAL"}
    assert facts["certified_share"] == 1.0
    assert facts["closest"]["distance"] < 0.0


def test_a_followed_depth_and_a_deadline_are_not_certified(
    standoff: Standoff, crossing: Path
) -> None:
    ended = standoff("track", crossing, "--depth", "local", "--json")
    assert ended.code == 3
    assert json.loads(ended.out)["settings"]["depth"] == "local"
    assert "LOCAL" in json.loads(ended.out)["statuses"]
    facts = json.loads(standoff("track", crossing, "--deadline", 2, "--json").out)
    assert facts["settings"]["deadline"] == 2
    assert "DEADLINE" in facts["statuses"]
    assert standoff("track", crossing, "--deadline", 0).code == 2


def test_depth_is_told(standoff: Standoff, crossing: Path) -> None:
    ended = standoff("distance", crossing, "--time", 1.0, "--json")
    assert ended.code == 0
    facts = json.loads(ended.out)
    assert facts["distance"] < 0.0
    assert facts["status"] == "GLOBAL"
    told = standoff("distance", crossing, "--time", "1.0").out
    assert f"{facts['distance']:.12g}" in told
    assert "upper bound" in told


def test_a_time_after_the_scene_s_end_is_refused(standoff: Standoff, passing: Path) -> None:
    assert standoff("distance", passing, "--time", 2.0).code == 0
    for time in (99, -1):
        ended = standoff("distance", passing, "--time", time)
        assert (ended.code, ended.out) == (2, "")
        assert f"time: {time} s is outside the scene's times, from 0 s to 2 s" in ended.err
        assert "a duration of 2 s" in ended.err


def test_distance(standoff: Standoff, passing: Path) -> None:
    time, answer = query(load_scene(passing), 0.5)
    facts = json.loads(standoff("distance", passing, "--time", "0.5", "--json").out)
    assert facts["time"] == time
    assert facts["distance"] == answer.distance
    assert facts["lower_bound"] == answer.lower_bound
    assert facts["point_b"] == answer.point_b.tolist()
    assert facts["certified"] is True
    ended = standoff("distance", passing)
    assert ended.code == 0
    _, first = query(load_scene(passing))
    assert f"distance      {first.distance:.15g} cm" in ended.out
    assert "certified     yes, tolerance 1e-10 of the pair's size" in ended.out


def test_impact(standoff: Standoff, passing: Path) -> None:
    found = first_impact(load_scene(passing), clearance=0.3)
    assert found.status.name == "IMPACT"
    facts = json.loads(standoff("impact", passing, "--clearance", "0.3", "--json").out)
    assert (facts["time"], facts["latest"]) == (found.time, found.latest)
    assert (facts["impact"], facts["clearance"]) == ("IMPACT", 0.3)
    assert facts["lower_bound"] > 0.3
    ended = standoff("impact", passing, "--clearance", 0.3)
    assert ended.code == 0
    assert f"time          {found.time:.12g} s" in ended.out
    assert f"latest        {found.latest:.12g} s" in ended.out
    ended = standoff("impact", passing, "--duration", 0.1)
    assert ended.code == 0
    assert "impact        NO_IMPACT\n" in ended.out
    assert "clearance     0 cm\n" in ended.out
    assert "latest        none" in ended.out
    for clearance in (-1.0, "inf", "nan"):
        ended = standoff("impact", passing, "--clearance", clearance)
        assert ended.code == 2
        assert f"--clearance: must be zero or more and finite, got {clearance}" in ended.err


def test_impact_needs_no_frames(standoff: Standoff, tmp_path: Path) -> None:
    """Ten samples a second; two logs whose clocks differ by a rounding here and there."""
    stamps = {
        "a": [0.1 * k for k in range(11)],
        "b": list(itertools.accumulate([0.0] + [0.1] * 10)),
    }
    assert stamps["a"] != stamps["b"]
    for name, times in stamps.items():
        rows = (f"{t!r} {0.0 if name == 'a' else 1.0} 0 0 0 0 0 1" for t in times)
        (tmp_path / f"{name}.tum").write_text("\n".join(rows) + "\n")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        "version = 1\n"
        + "".join(f'[bodies.{n}]\nshape = "sphere"\nradius = 0.1\n' for n in "ab")
        + "".join(f'[motions.{n}]\nkind = "samples"\nfile = "{n}.tum"\n' for n in "ab")
        + '[pair]\na = "a"\nb = "b"\n'
    )
    facts = json.loads(standoff("impact", scene, "--json").out)
    assert (facts["impact"], facts["latest"]) == ("NO_IMPACT", None)
    ended = standoff("impact", scene, "--start", 0.32, "--duration", 0.05)
    assert ended.code == 0
    assert f"time          {0.32 + 0.05:.12g} s" in ended.out
    ended = standoff("impact", scene, "--duration", 3.0)
    assert ended.code == 2
    assert "--duration: 3 s from 0 s end at 3 s, after the last pose sample" in ended.err
    ended = standoff("impact", scene, "--start", repr(stamps["b"][-1]))
    assert ended.code == 2
    assert "--start: no time is left after" in ended.err


def test_options_take_the_place_of_the_scene_s(standoff: Standoff, passing: Path) -> None:
    ended = standoff(
        *("track", passing, "--law", "paper", "--integrator", "rk4", "--gain", 20),
        *("--feedforward", "false", "--start", 0.5, "--duration", 0.1),
    )
    assert "law           paper, integrator rk4, gain 20 1/s, feedforward false" in ended.out
    assert "frames        6 from 0.5 s to 0.6 s, 20 ms apart" in ended.out
    # Without the feedforward the paper's law lags, and says so.
    assert ended.code == 3
    assert "TRACKING" in ended.out


@pytest.mark.parametrize(
    ("options", "piece"),
    [
        (["--law", "papper"], "--law: unknown law 'papper'; did you mean 'paper'?"),
        (["--predictor", "x"], "--predictor: unknown predictor 'x'; known here:"),
        (["--law", "paper", "--integrator", "huen"], "did you mean 'heun'?"),
        (["--law", "paper", "--gain", "0"], "--gain: must be above zero, got 0"),
        (["--law", "paper", "--gain", "-1"], "--gain: must be above zero, got -1"),
        (["--law", "paper", "--gain", "nan"], "--gain: must be a finite number, got nan"),
        (["--law", "paper", "--gain", "much"], "--gain: must be a number, got 'much'"),
        (["--gain", "30"], "--gain: is an option of the law 'paper', and law is 'predictor-c"),
        (["--law", "paper", "--predictor", "none"], "of the law 'predictor-corrector', and law"),
        (["--deadline", "2.5"], "--deadline: must be a whole number above zero, got 2.5"),
        (["--law", "paper", "--feedforward", "no"], "must be true or false, got 'no'"),
        (["--step", "0"], "--step: must be above zero, got 0"),
        (["--step", "inf"], "--step: must be a finite number"),
        (["--step", "often"], "--step: must be a number or 'samples', got 'often'"),
        (["--step", "samples"], "track.step: 'samples' needs a body that moves by pose samples"),
        (["--step", "1e-9"], "2e+09 frames"),
        (["--duration", "0"], "--duration: must be above zero"),
        (["--law", "paper", "--gain", "1e6"], "is not stable"),
        (["-o", "no/such/folder.parquet"], "the folder no/such does not exist; create it"),
        (["-o", "passing.toml"], "the ending '.toml' is not known here"),
        (["-o", "passing.toml/x.parquet"], "passing.toml is a file, not a folder"),
        (["-o", "folder.parquet"], "is a folder; name a file in it"),
        (["--plot", "x.bmp"], "ends in .png or .svg or .pdf"),
        (["--plot", "no/x.png"], "the folder no does not exist"),
    ],
)
def test_bad_options(
    standoff: Standoff,
    passing: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    piece: str,
) -> None:
    monkeypatch.chdir(passing.parent)
    Path("folder.parquet").mkdir()
    ended = standoff("track", "passing.toml", *options)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err.startswith("standoff: ")
    assert ended.err.count("\n") == 1
    assert piece in ended.err
    assert sorted(path.name for path in Path().iterdir()) == ["folder.parquet", "passing.toml"]


@pytest.mark.parametrize("command", ["track", "distance"])
def test_a_bad_scene_is_one_message(standoff: Standoff, passing: Path, command: str) -> None:
    passing.write_text(passing.read_text().replace("semi_axes", "semi_axis"))
    ended = standoff(command, passing, "--json")
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err == (
        f"standoff: {passing}: bodies.tool.semi_axis: unknown key 'semi_axis'; "
        "did you mean 'semi_axes'?\n"
    )
    ended = standoff(command, passing.with_name("other.toml"))
    assert ended.code == 2
    assert ended.err.startswith("standoff: no file ")


@pytest.mark.parametrize(
    "arguments",
    [["trak"], ["track"], ["track", "x.toml", "--bogus"], ["track", "x.toml", "--gain"]],
)
def test_bad_usage(standoff: Standoff, arguments: list[str]) -> None:
    ended = standoff(*arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err
    assert "Traceback" not in ended.err


def test_help_and_version(standoff: Standoff) -> None:
    assert standoff("--version") == (0, f"standoff {__version__}\n", "")
    for arguments in (["--help"], ["track", "--help"], []):
        ended = standoff(*arguments)
        assert ended.code == 0
        assert "usage: standoff" in ended.out


def test_interrupt(standoff: Standoff, passing: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("standoff.cli.track.record", interrupted)
    target = passing.with_name("out.parquet")
    ended = standoff("track", passing, "-o", target)
    assert ended == (130, "", "standoff: interrupted; nothing was written\n")
    assert not target.exists()


@pytest.mark.parametrize("library", ["tyro", "rich"])
def test_a_missing_extra_is_named(
    standoff: Standoff, passing: Path, monkeypatch: pytest.MonkeyPatch, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    ended = standoff("track", passing)
    assert ended.code == 2
    assert ended.err == (
        f"standoff: {library} is not installed; install the extra 'cli': "
        "pip install 'standoff[cli]'\n"
    )


@pytest.mark.parametrize(
    ("library", "option"), [("pyarrow", "-o out.parquet"), ("matplotlib", "--plot out.png")]
)
def test_a_missing_writer_is_named_before_the_run(passing: Path, library: str, option: str) -> None:
    # In a process of its own, where nothing has been imported yet.
    script = (
        f"import sys; sys.modules['{library}'] = None\n"
        "import standoff.scene.run, standoff.scene as scene\n"
        "def refuse(*_): raise AssertionError('ran')\n"
        "scene.record = refuse\n"
        "from standoff.cli import main\n"
        f"sys.exit(main(['track', {str(passing)!r}, *{option.split()!r}]))\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=passing.parent
    )
    assert ended.returncode == 2
    announced, told = ended.stderr.splitlines()
    assert announced.endswith(" ...")
    assert told.startswith(f"standoff: {library} is not installed; install the extra")
    assert [path.name for path in passing.parent.iterdir()] == ["passing.toml"]


def test_as_a_module_in_a_process_of_its_own(passing: Path) -> None:
    command = [sys.executable, "-m", "standoff.cli", "distance"]
    ended = subprocess.run([*command, passing, "--json"], capture_output=True, text=True)
    assert ended.returncode == 0
    assert json.loads(ended.stdout)["certified"] is True
    ended = subprocess.run([*command, "no.toml"], capture_output=True, text=True)
    assert ended.returncode == 2
    assert ended.stdout == ""
    assert "Traceback" not in ended.stderr


def test_a_reader_that_goes_away(passing: Path) -> None:
    script = (
        "import os, sys\n"
        "from standoff.cli import main\n"
        "read, write = os.pipe()\n"
        "os.close(read)\n"
        "os.dup2(write, 1)\n"
        "sys.stdout.reconfigure(line_buffering=True)\n"
        f"sys.exit(main(['distance', {str(passing)!r}]))\n"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert ended.returncode == 1
    assert ended.stderr.startswith("standoff: finding the distance of the pairs of ")
    assert ended.stderr.count("\n") == 1  # no complaint


def test_help_does_not_wait_for_the_kernels() -> None:
    script = (
        "import sys\n"
        "from standoff.cli.entry import main\n"
        "main(['track', '--help'])\n"
        "print(sorted(m for m in ('pyarrow', 'matplotlib') if m in sys.modules), file=sys.stderr)\n"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert ended.stderr == "[]\n"


def test_entry_point_is_the_one_declared() -> None:
    from importlib.metadata import entry_points

    (script,) = entry_points(group="console_scripts", name="standoff")
    assert script.load() is entry.main
