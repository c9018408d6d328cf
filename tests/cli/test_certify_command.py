"""``standoff certify``: verdicts, exit codes, files, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("mujoco")

from standoff.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples" / "robots"
MODEL, PATH = EXAMPLES / "arm.xml", EXAMPLES / "reach.csv"
ROWS = PATH.read_text("utf-8").splitlines()


def run(*given: object) -> int:
    return main(["certify", *map(str, given)])


def test_proven(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(MODEL, PATH) == 0
    said = capsys.readouterr().out
    assert "verdict   PROVEN" in said
    assert "44 pairs" in said


def test_not_proven(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out, plot = tmp_path / "proof.json", tmp_path / "proof.png"
    assert run(MODEL, PATH, "--clearance", "0.03", "--json", "-o", out, "--plot", plot) == 3
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == "VIOLATED"
    assert found["witness"]["names"] == ["board", "right finger"]
    assert found["files"] == [str(out), str(plot)]
    assert 1.9 < found["time"] <= found["latest"] < 2.0
    assert plot.read_bytes().startswith(b"\x89PNG")
    steps = json.loads(out.read_text("utf-8"))["steps"]
    assert len(steps["start"]) == len(steps["how"]) == found["counts"]["steps"]
    assert set(steps["how"]) <= {"FAR", "REACH", "CHORD"}


SWING = """<mujoco><worldbody>
<geom name="grazed" type="sphere" size="0.05" pos="1.105 0 0"/>
<geom name="hit" type="sphere" size="0.05" pos="0 1 0"/>
<body><joint name="turn" axis="0 0 1"/><geom name="tip" type="sphere" size="0.05" pos="1 0 0"/>
</body></worldbody></mujoco>"""
"""A ball that passes another at 5 mm exactly, and then meets a third."""


def test_an_undecided_instant_is_told_before_the_violation(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    model, path = tmp_path / "swing.xml", tmp_path / "swing.csv"
    model.write_text(SWING, "utf-8")
    for end, verdict, pair in ((2.0, "VIOLATED", "hit"), (1.0, "UNDECIDED", "grazed")):
        path.write_text(f"turn\n-0.5\n{end}\n", "utf-8")
        assert run(model, path, "--clearance", "0.005") == 3
        said = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
        assert said["verdict"] == verdict
        assert pair in said["pair"]
        assert said["undecided"].startswith("grazed and tip from ")


def test_columns_in_any_order_and_without_names(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    told = []
    bare = "\n".join(",".join(row.split(",")[1:]) for row in ROWS[1:])
    turned = "\n".join(",".join([row.split(",")[0], *row.split(",")[:0:-1]]) for row in ROWS)
    for text in ("\n".join(ROWS), turned, "# by hand\n\n" + bare):
        file = tmp_path / "path.csv"
        file.write_text(text, "utf-8")
        assert run(MODEL, file, "--json") == 0
        found = json.loads(capsys.readouterr().out)
        told.append((found["proven"], found["counts"]))
    assert told[0] == told[1] == told[2]


def test_obstacles_of_a_scene(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    scene = tmp_path / "ball.toml"
    scene.write_text(
        'version = 1\ntitle = "Balls"\n[bodies.ball]\nshape = "sphere"\nradius = 0.3\n'
        '[bodies.far]\nshape = "sphere"\nradius = 0.1\n'
        "[placements.ball]\nposition = [0.4, 0.0, 0.7]\n"
        "[placements.far]\nposition = [4.0, 0.0, 0.7]\n"
        '[world]\nfixed = ["ball", "far"]\n',
        "utf-8",
    )
    assert run(MODEL, PATH, "--obstacles", scene) == 3
    assert "ball" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no rows"),
        (ROWS[0] + "\n", "0 waypoint"),
        ("\n".join(ROWS[:2]), "1 waypoint: give two or more"),
        (ROWS[1] + "\n" + ROWS[2], "line 1: has 8 columns, but 7 are asked for"),
        ("\n".join(ROWS).replace("1.2,", "up,", 1), "line 2: 'up' is not a number"),
        ("\n".join(ROWS).replace("1.2,", "nan,", 1), "Waypoint 0: .*NaN"),
        ("\n".join(ROWS).replace("1.2,", "3.0,", 1), "joint 'j4' .* is 3.0 at 0.0 s, outside"),
        ("\n".join(ROWS).replace("j4", "J4", 1), "no joint 'J4'. Did you mean 'j4'"),
        ("\n".join(ROWS).replace("j4", "j3", 1), "has 'j3' twice"),
        ("\n".join(row.rsplit(",", 1)[0] for row in ROWS), "has no column 'j7'"),
        ("\n".join(ROWS).replace("\n1.0", "\n5.0"), "increasing times"),
    ],
)
def test_bad_paths(
    text: str, said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    import re

    file = tmp_path / "path.csv"
    file.write_text(text, "utf-8")
    assert run(MODEL, file) == 2
    assert re.search(said, capsys.readouterr().err)


def test_bad_options(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for given, said in (
        ((MODEL, tmp_path / "none.csv"), "cannot be read"),
        ((tmp_path / "none.xml", PATH), "none.xml"),
        ((PATH, PATH), "give an MJCF file"),
        ((MODEL, PATH, "--clearance", "-1"), "--clearance: "),
        ((MODEL, PATH, "--max-steps", "0"), "--max-steps: "),
        ((MODEL, PATH, "-o", tmp_path / "x.txt"), "'.txt' is not known here"),
        ((MODEL, PATH, "--plot", tmp_path / "no" / "x.png"), "does not exist"),
    ):
        assert run(*given) == 2
        assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
