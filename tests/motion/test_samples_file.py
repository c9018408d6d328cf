"""Files of pose samples: both formats, the real recording, and what is refused where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from standoff.motion import Pose, read_pose_samples

RECORDING = Path(__file__).parents[3] / "shared" / "data" / "freiburg1_xyz_groundtruth.tum"

TUM = """\
# timestamp tx ty tz qx qy qz qw

1.0 0.1 0.2 0.3 0 0 0 1
1.5 1 2 3 0.6 0 0 0.8
  # a remark
1.75 4 5 6 0.6001 0 0 0.8001
"""
CSV = "t,x,y,z,qx,qy,qz,qw\n1,0.1,0.2,0.3,0,0,0,1\n1.5,1,2,3,0.6,0,0,0.8\n"
SCALAR_FIRST = "qw, qx, qy, qz, t, x, y, z\n1,0,0,0,1,0.1,0.2,0.3\n0.8,0.6,0,0,1.5,1,2,3\n"


def write(folder: Path, name: str, content: str) -> Path:
    file = folder / name
    file.write_text(content, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.tum", TUM),
        ("a.txt", TUM.replace(" ", "\t")),
        ("a.csv", CSV),
        ("b.CSV", SCALAR_FIRST),
        ("c.csv", "\ufeff" + CSV.replace("\n", "\r\n")),
        ("d.csv", "# measured today\n" + CSV),
    ],
)
def test_both_formats_read_alike(tmp_path: Path, name: str, content: str) -> None:
    samples = read_pose_samples(str(write(tmp_path, name, content)))
    np.testing.assert_array_equal(samples.times[:2], [1.0, 1.5])
    np.testing.assert_array_equal(samples.poses[0].matrix[:3, 3], [0.1, 0.2, 0.3])
    expected = Pose.from_xyzw((0.6, 0.0, 0.0, 0.8), (1.0, 2.0, 3.0))
    np.testing.assert_array_equal(samples.pose(1.5).matrix, expected.matrix)
    assert samples.repaired == (0 if name.lower().endswith("csv") else 1)


def test_the_real_recording() -> None:
    if not RECORDING.is_file():
        pytest.skip(f"the recording {RECORDING.name} is not beside this checkout")
    samples = read_pose_samples(RECORDING)
    assert len(samples.poses) == 3000
    steps = np.diff(samples.times)
    assert 0.009 < np.median(steps) < 0.011
    assert steps.max() > 1.05 * np.median(steps)
    # Four decimals a component: nearly every quaternion is off unit norm by more than rounding.
    assert samples.repaired > 0.9 * len(samples.poses)
    np.testing.assert_array_equal(samples.pose(samples.start).translation, [1.3563, 0.6305, 1.6380])
    middle = 0.5 * (samples.times[100] + samples.times[101])
    step = 1e-3
    shifted = samples.starting_at(0.0)
    t = middle - samples.start
    difference = shifted.pose(t + step).translation - shifted.pose(t - step).translation
    np.testing.assert_allclose(shifted.twist(t).v, difference / (2 * step), atol=1e-6)


BAD_LINES = [
    ("a.tum", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n", 2, r"7 columns, not 8: give timestamp tx"),
    ("a.tum", "0 0 0 0 0 0 0 1 9\n", 1, r"9 columns, not 8"),
    ("a.tum", "# x\n0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n", 3, r"time 0\.0 does not come after 0\.0"),
    ("a.tum", "2 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n", 2, r"time 1\.5 does not .* 2\.0.*sort"),
    ("a.tum", "0 0 nan 0 0 0 0 1\n", 1, r"y is 'nan'; leave out"),
    ("a.tum", "inf 0 0 0 0 0 0 1\n", 1, r"t is 'inf'"),
    ("a.tum", "0 0 0 high 0 0 0 1\n", 1, r"z is 'high', not a number"),
    ("a.tum", "0 0 0 5_0 0 0 0 1\n", 1, r"z is '5_0', not a number; write it like"),
    ("a.csv", "t,x,y,z,qx,qy,qz,qw\n0,0,0,5_0,0,0,0,1\n", 2, r"z is '5_0', not a number"),
    ("a.tum", "0 0 0 \u0661\u0662 0 0 0 1\n", 1, r"z is '\u0661\u0662', not a number"),
    ("a.tum", f"0 0 0 {'9_' * 5000}9 0 0 0 1\n", 1, r"z is '9_9_.{190,200}…, not a number"),
    ("a.tum", "0 0 0 0x1 0 0 0 1\n", 1, r"z is '0x1', not a number"),
    ("a.tum", "0 0 0 0 0 0 0 1\n1 0 0 0 0.1 0 0 1\n", 2, r"norm 1\.00498756.*qx qy qz qw"),
    ("a.tum", "0 0 0 0 0 0 0 1\n", 0, r"1 samples do not make a motion"),
    ("a.tum", "# nothing\n", 0, r"0 samples do not make a motion"),
    ("a.csv", "", 1, r"the header is ''.*t,x,y,z,qx,qy,qz,qw"),
    ("a.csv", "t,x,y,z,qx,qy,qz\n", 1, r"the header is 't,x,y,z,qx,qy,qz'"),
    ("a.csv", "t,x,y,z,qx,qy,qz,w\n", 1, r"the header is"),
    ("a.csv", "t,x,y,z,qx,qy,qz,qw,qw\n", 1, r"each once and no other"),
    ("a.csv", "0,0,0,0,0,0,0,1\n", 1, r"the header is '0,0,0"),
    ("a.csv", CSV + "2,0,0,0,0,0,1\n", 4, r"7 columns, where the header names 8"),
    ("a.csv", CSV + "\n0.5,0,0,0,0,0,0,1\n", 5, r"time 0\.5 does not come after 1\.5"),
    ("a.csv", CSV + "2,0,0,0,0,0,,1\n", 4, r"qz is '', not a number"),
    ("a.csv", SCALAR_FIRST + "1,0,0,nan,2,0,0,0\n", 4, r"qz is 'nan'"),
]


@pytest.mark.parametrize(("name", "content", "line", "message"), BAD_LINES)
def test_faults_name_file_line_and_fix(
    tmp_path: Path, name: str, content: str, line: int, message: str
) -> None:
    file = write(tmp_path, name, content)
    with pytest.raises(ValueError, match=message) as caught:
        read_pose_samples(file)
    place = f"{file}, line {line}: " if line else f"{file}: "
    assert str(caught.value).startswith(place)


def test_half_turn_between_lines_names_the_file(tmp_path: Path) -> None:
    file = write(tmp_path, "a.tum", "0 0 0 0 0 0 0 1\n1 0 0 0 1 0 0 0\n")
    with pytest.raises(ValueError, match="half turn") as caught:
        read_pose_samples(file)
    assert str(caught.value).startswith(str(file))


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none\.tum: no such file"):
        read_pose_samples(tmp_path / "none.tum")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(IsADirectoryError, match=r"folder\.csv is a folder"):
        read_pose_samples(tmp_path / "folder.csv")
    with pytest.raises(ValueError, match=r"the ending '\.bag' is not a format"):
        read_pose_samples(write(tmp_path, "a.bag", TUM))
    (tmp_path / "binary.tum").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(ValueError, match=r"binary\.tum: not a text file"):
        read_pose_samples(tmp_path / "binary.tum")


def test_numbers_as_files_write_them(tmp_path: Path) -> None:
    line = "1e0 +1 -.5 2. 0 0 0 1E+00\n"
    samples = read_pose_samples(write(tmp_path, "a.tum", "0 0 0 0 0 0 0 1\n" + line))
    np.testing.assert_array_equal(samples.poses[1].translation, [1.0, -0.5, 2.0])


def test_names_that_no_file_has(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="…: no such file"):
        read_pose_samples(tmp_path / f"{'x' * 5000}.tum")
    with pytest.raises(FileNotFoundError, match="no such file"):
        read_pose_samples("a\0.tum")
    for value in (0.1, None, b"a.tum", [1.0]):
        with pytest.raises(TypeError, match=r"file is .*: give a file name"):
            read_pose_samples(value)  # type: ignore[arg-type]
