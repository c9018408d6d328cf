"""Runs as files: films, and rerun's; whole or not at all, with a word on what is missing."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.cli import main
from standoff.errors import StandoffError
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.view import save_rerun, save_video

EXAMPLES = Path(__file__).parents[2] / "examples"
AWAY = Pose(np.eye(3), [3.0, 0.0, 0.0])
LASTS = 0.4


@pytest.fixture(scope="module")
def run() -> so.Recording:
    path = ConstantTwist(Pose.identity(), Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    tracker = so.Tracker(so.shapes.sphere(0.3), so.shapes.box(1.0, 0.8, 0.6), 0.01)
    return so.track(tracker, path, AWAY, LASTS)


def test_a_gif_has_the_pictures_in_the_time_of_the_motion(
    run: so.Recording, tmp_path: Path
) -> None:
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
    told: list[tuple[int, int]] = []
    save_video(
        *(run, tmp_path / "run.gif"), pictures=3, speed=0.5, progress=lambda *n: told.append(n)
    )
    assert told == [(1, 3), (2, 3), (3, 3)]
    with image.open(tmp_path / "run.gif") as film:
        assert film.n_frames == 3
        assert film.info["duration"] == pytest.approx(1000.0 * LASTS / 0.5 / 2, abs=10.0)
        first = np.asarray(film.convert("RGB"))
        film.seek(2)
        assert (np.asarray(film.convert("RGB")) != first).any()


def test_an_mp4_has_the_pictures_in_the_time_of_the_motion(
    run: so.Recording, tmp_path: Path
) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="not installed (extra 'video')")
    save_video(run, tmp_path / "run.mp4", pictures=3, speed=0.5)
    count, seconds = ffmpeg.count_frames_and_secs(str(tmp_path / "run.mp4"))
    assert count == 3
    assert seconds == pytest.approx(3 / 2 * LASTS / 0.5, rel=0.05)
    film = ffmpeg.read_frames(str(tmp_path / "run.mp4"))
    width, height = next(film)["size"]
    first, *_, last = (np.frombuffer(picture, np.uint8).astype(int) for picture in film)
    assert first.size == 3 * width * height
    assert np.abs(first - last).max() > 50


def test_rerun_is_given_bodies_points_and_curves(run: so.Recording, tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed (extra 'rerun')")
    save_rerun(run, tmp_path / "run.rrd")
    content = (tmp_path / "run.rrd").read_bytes()
    assert content[:3] == b"RRF"
    for name in ("/A/skin", "/B/active/face", "/witness/line", "/distance", "/lower_bound"):
        assert name.encode() in content


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [
        ("run.mp4", "imageio_ffmpeg", "video"),
        ("run.gif", "matplotlib", "video"),
        ("run.rrd", "rerun", "rerun"),
        ("run.html", "viser", "view"),
    ],
)
def test_a_missing_library_is_told_with_its_extra_before_the_run(
    name: str,
    module: str,
    extra: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    for loaded in ("standoff.view.rerun_log", "standoff.view.export", "standoff.view.server"):
        monkeypatch.delitem(sys.modules, loaded, raising=False)
    target = tmp_path / name
    assert main(["track", str(EXAMPLES / "twist.toml"), "--export", str(target)]) == 2
    ended = capsys.readouterr()
    assert ended.out == ""
    assert f"is not installed; install the extra '{extra}'" in ended.err
    assert list(tmp_path.iterdir()) == []


def test_bad_files_numbers_and_recordings_are_refused_and_leave_nothing(
    run: so.Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed (extra 'rerun')")
    old = tmp_path / "old.gif"
    old.write_bytes(b"old")
    for save, bad in ((save_video, "run.avi"), (save_rerun, "run.mp4")):
        with pytest.raises(StandoffError, match="is not known here; name a"):
            save(run, tmp_path / bad)
    for given in ({"pictures": 0}, {"pictures": 2.5}, {"speed": 0.0}, {"view": (1.0,)}):
        with pytest.raises(StandoffError):
            save_video(run, old, **given)
    run.save(tmp_path / "run.parquet")
    reopened = so.open_recording(tmp_path / "run.parquet")
    for save, name in ((save_video, "old.gif"), (save_rerun, "run.rrd")):
        with pytest.raises(StandoffError, match="does not hold what moved"):
            save(reopened, tmp_path / name)

    def fails(*_: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(import_module("standoff.view.video"), "_write_gif", fails)
    with pytest.raises(OSError, match="disk is full"):
        save_video(run, old, pictures=2)
    assert old.read_bytes() == b"old"
    assert {file.name for file in tmp_path.iterdir()} == {"old.gif", "run.parquet"}


def test_the_command_writes_what_the_ending_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed (extra 'rerun')")
    scene, target = str(EXAMPLES / "twist.toml"), tmp_path / "run.rrd"
    assert main(["track", scene, "--duration", "0.1", "--export", str(target)]) == 0
    assert str(target) in capsys.readouterr().out
    assert target.read_bytes()[:3] == b"RRF"
    assert main(["track", scene, "--export", str(tmp_path / "run.avi")]) == 2
    assert "ends in .html or .mp4 or .gif or .rrd" in capsys.readouterr().err
