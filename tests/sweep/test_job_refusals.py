"""What a job may not say: each refused with its key, its value and the fix."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from standoff.errors import StandoffError
from standoff.scene import SceneError
from standoff.sweep.reading import load_job
from standoff.view.gallery import scenes_in
from sweep.conftest import JOB, PARAMETERS, SCENE, TOP, Make

SOBOL = '[sampler]\nkind = "sobol"\nrows = 10\n'
GRID = '[sampler]\nkind = "grid"\n'
TURN = '[parameters.t]\nmoves = "tool"\nwhat = "turn_x"\nfrom = 0\nto = 1\n'
X = '[parameters.x]\nmoves = "tool"\nwhat = "x"\nfrom = 0.0\nto = 1.0\n'


def moved(text: str) -> str:
    return f"{TOP}[parameters.p]\n{text}\n{SOBOL}"


def kept(text: str, top: str = "") -> str:
    return f"{TOP}{top}{X}{SOBOL}[keep]\n{text}\n"


def sampled(text: str) -> str:
    return f"{TOP}{X}[sampler]\n{text}\n"


# text, key of the complaint, pieces of its sentence
REFUSED = [
    ("", "", ["'version' is missing"]),
    ("version = 2", "version", ["is 2", "version 1"]),
    ("version = true", "version", ["True"]),
    ("version = 1", "", ["'scene' is missing", "scene.toml"]),
    ("version = 1\nscen = 3", "scen", ["did you mean 'scene'?"]),
    ('version = 1\nscene = "scene.tom"', "scene", ["no file", "did you mean 'scene.toml'?"]),
    (f'{TOP}pair = "pears"\n{X}{SOBOL}', "pair", ["unknown pair"]),
    (f"{TOP}{SOBOL}", "", ["'parameters' is missing"]),
    (f"{TOP}[parameters]\n{SOBOL}", "parameters", ["no parameters"]),
    (f"{TOP}parameters = 3\n{SOBOL}", "parameters", ["must be a table"]),
    (f"{TOP}{X}", "", ["'sampler' is missing"]),
    (f"{TOP}within = 0\n{X}{SOBOL}", "within", ["above zero"]),
    (f"{TOP}within = nan\n{X}{SOBOL}", "within", ["finite", "nan"]),
    (f"{TOP}title = 3\n{X}{SOBOL}", "title", ["string in quotes"]),
    (f'{TOP}["parameters"."a b"]\n{SOBOL}', "parameters.a b", ["letters, digits"]),
    (moved(""), "parameters.p", ["'moves' is missing", 'moves = "part"']),
    (moved('moves = "tol"'), "parameters.p.moves", ["did you mean 'tool'?"]),
    (moved('moves = "tool"'), "parameters.p", ["'what' is missing"]),
    (moved('moves = "tool"\nwhat = "turnx"'), "parameters.p.what", ["did you mean 'turn_x'?"]),
    (moved('moves = "tool"\nwhat = "x"\nstep = 3'), "parameters.p.step", ["unknown key"]),
    (moved('moves = "tool"\nwhat = "x"\nsteps = 3'), "parameters.p.steps", ["unknown key"]),
    (moved('moves = "tool"\nwhat = "x"\nfrom = 0'), "parameters.p", ["'to' is missing"]),
    (moved('moves = "tool"\nwhat = "x"\nfrom = 1\nto = 1'), "parameters.p.to", ["above 'from'"]),
    (moved('moves = "tool"\nwhat = "x"\nfrom = nan\nto = 1'), "parameters.p.from", ["finite"]),
    (moved('moves = "tool"\nwhat = "x"\nfrom = 0\nto = inf'), "parameters.p.to", ["finite", "inf"]),
    (moved('moves = "tool"\nwhat = "x"\nfrom = 0\nto = "1"'), "parameters.p.to", ["a number"]),
    (
        moved('moves = "tool"\nwhat = "x"\nfrom_degrees = 0\nto_degrees = 1'),
        "parameters.p.from_degrees",
        ["'x' is a length", "'from'"],
    ),
    (
        moved('moves = "tool"\nwhat = "turn_x"\nfrom_degrees = 0\nto = 1'),
        "parameters.p",
        ["'to_degrees' is missing"],
    ),
    (
        moved('moves = "tool"\nwhat = "turn_x"\nfrom_degrees = 0\nfrom = 1'),
        "parameters.p",
        ["say the same thing"],
    ),
    (moved('moves = "tool"\nrotation = "all"'), "parameters.p.rotation", ["unknown rotation"]),
    (
        moved('moves = "tool"\nrotation = "uniform"\nwhat = "x"'),
        "parameters.p.what",
        ["unknown key"],
    ),
    (f"{TOP}{X}{X.replace('.x', '.y')}{SOBOL}", "parameters.y", ["'x' changes the same"]),
    (
        f"{TOP}{PARAMETERS}{TURN}{SOBOL}",
        "parameters.t",
        ["uniform rotation"],
    ),
    (sampled(""), "sampler", ["'kind' is missing"]),
    (sampled('kind = "sobel"'), "sampler.kind", ["did you mean 'sobol'?"]),
    (sampled('kind = "random"'), "sampler", ["'rows' is missing"]),
    (sampled('kind = "random"\nrows = 0'), "sampler.rows", ["above zero"]),
    (sampled('kind = "random"\nrows = 1.0'), "sampler.rows", ["whole number"]),
    (sampled('kind = "random"\nrows = true'), "sampler.rows", ["whole number"]),
    (sampled('kind = "random"\nrows = 9e99'), "sampler.rows", ["whole number"]),
    (sampled('kind = "random"\nrows = 2000000000000000'), "sampler.rows", ["or less"]),
    (sampled('kind = "random"\nrows = 9\nseed = -1'), "sampler.seed", ["from 0 on", "-1"]),
    (sampled('kind = "random"\nrows = 9\nseed = 1.5'), "sampler.seed", ["1.5"]),
    (sampled('kind = "random"\nrows = 9\nseed = 9223372036854775808'), "sampler.seed", ["922"]),
    (sampled('kind = "grid"\nrows = 9'), "sampler.rows", ["unknown key"]),
    (sampled('kind = "file"'), "parameters.x.from", ["unknown key"]),
    (f"{TOP}{X}{GRID}", "parameters.x.steps", ["above zero"]),
    (f"{TOP}{X}steps = 1\n{GRID}", "parameters.x.steps", ["2 or more"]),
    (f"{TOP}{X}steps = 2000000000000000\n{GRID}", "sampler.kind", ["2000000000000000 rows"]),
    (f"{TOP}{PARAMETERS}{GRID}", "parameters.x.steps", ["above zero"]),
    (
        f'{TOP}[parameters.p]\nmoves = "tool"\nrotation = "uniform"\n{GRID}',
        "parameters.p.rotation",
        ["'grid'"],
    ),
    (kept("wurst = 3"), "keep.wurst", ["did you mean 'worst'?"]),
    (kept("worst = 0"), "keep.worst", ["above zero"]),
    (kept("worst = 20000000"), "keep.worst", ["10000000 or less"]),
    (kept("below = nan"), "keep.below", ["finite"]),
    (kept("most_below = 3"), "keep.most_below", ["goes with 'below'"]),
    (kept("below = 2.0", "within = 1.0\n"), "keep.below", ["horizon"]),
    (kept("histogram = 3"), "keep.histogram", ["must be a table"]),
    (kept("histogram = { from = 0, to = 1 }"), "keep.histogram", ["'bins' is missing"]),
    (kept("histogram = { from = 1, to = 1, bins = 3 }"), "keep.histogram.to", ["above 'from'"]),
    (kept("histogram = { from = 0, to = 1, bins = 0 }"), "keep.histogram.bins", ["above zero"]),
    (f"{TOP}{X}{SOBOL}[shards]\nrows = 0", "shards.rows", ["above zero"]),
    (f"{TOP}{X}{SOBOL}[shards]\nrow = 5", "shards.row", ["did you mean 'rows'?"]),
]


@pytest.mark.parametrize(("text", "key", "pieces"), REFUSED)
def test_refused(make: Make, text: str, key: str, pieces: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        make(text)
    error = caught.value
    assert error.key == key, error
    assert error.file is not None
    for piece in pieces:
        assert piece in str(error)


def test_scenes_that_have_no_such_pair(make: Make) -> None:
    two = (
        SCENE.replace("[pair]\n", '[[pairs]]\nname = "one"\n') + '[[pairs]]\na = "part"\nb = "tool"'
    )
    with pytest.raises(SceneError, match='the scene has 2 pairs: add a line such as: pair = "one"'):
        make(f"{TOP}{X}{SOBOL}", two)
    assert make(f'{TOP}pair = "part-tool"\n{X}{SOBOL}', two).scene.pair == ("part", "tool")
    with pytest.raises(SceneError, match=r"\[world\] and no \[pair\]"):
        make(f"{TOP}{X}{SOBOL}", SCENE.partition("[pair]")[0] + "[world]\n")
    planar = SCENE.replace('shape = "ellipsoid"\nsemi_axes = [3.0, 1.0, 0.8]', 'shape = "point"')
    planar = planar.replace(
        'shape = "ellipsoid"\nsemi_axes = [2.0, 2.5, 1.5]',
        'shape = "planar_loop"\n'
        'curves = [{ kind = "ellipse", centre = [0, 0], semi_axes = [1, 2] }]',
    ).replace("7.0]\nrotation_vector = [0.3, -0.2, 0.4]", "0.0]")
    with pytest.raises(SceneError, match="'x', 'y' and 'turn_z' alone"):
        make(TOP + X.replace('what = "x"', 'what = "z"') + SOBOL, planar)
    assert make(f"{TOP}{X}{SOBOL}", planar).distances(0, 10).certified.all()
    half = SCENE.replace('"ellipsoid"', '"halfspace"')
    half = "\n".join(line for line in half.splitlines() if "semi_axes" not in line)
    with pytest.raises(SceneError, match="half-space"):
        make(f"{TOP}{X}{SOBOL}", half)


def test_a_scene_is_no_job_and_a_job_no_scene(make: Make, tmp_path: Path) -> None:
    two = SCENE.replace("[pair]\n", '[[pairs]]\nname = "one"\n')
    make(f'{TOP}pair = "one"\n{X}{SOBOL}', two)
    with pytest.raises(SceneError, match=r'bodies: this is a scene, .* scene = "scene\.toml"'):
        load_job(tmp_path / "scene.toml")
    assert list(scenes_in(tmp_path)) == ["scene"]


FILE = """{top}[parameters.x]
moves = "tool"
what = "x"
[parameters.t]
moves = "part"
what = "turn_y"
degrees = true
[sampler]
kind = "file"
file = "{name}"
"""


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("rows.txt", "x,t\n1,2\n", "ends in '.txt'"),
        ("rows.csv", "x,y\n1,2\n", "no column 't'"),
        ("rows.csv", "x,t,x\n1,2,3\n", "several columns 'x'"),
        ("rows.csv", "x,t\n1,two\n", "line 2 is not a number"),
        ("rows.csv", "x,t\n1\n", "line 2"),
        ("rows.csv", "x,t\n", "has no rows"),
        ("rows.npy", "no such thing", "not an NPY file"),
        ("rows.parquet", "no such thing", "not a readable Parquet file"),
    ],
)
def test_files_that_are_refused(
    make: Make, tmp_path: Path, name: str, content: str, told: str
) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(SceneError, match=told.replace("(", r"\(")) as caught:
        make(FILE.format(top=TOP, name=name))
    assert caught.value.key == "sampler.file"


def test_numbers_of_a_file_that_are_refused(make: Make, tmp_path: Path) -> None:
    np.save(tmp_path / "rows.npy", np.zeros((4, 3)))
    with pytest.raises(SceneError, match=r"shape \(4, 3\): give numbers of shape \(n, 2\)"):
        make(FILE.format(top=TOP, name="rows.npy"))
    np.save(tmp_path / "rows.npy", np.array([[1.0, 2.0], [3.0, np.nan], [np.inf, 0.0]]))
    job = make(FILE.format(top=TOP, name="rows.npy"))
    with pytest.raises(StandoffError, match="row 1, from 0, is missing or nan in 't'"):
        job.distances(0, 3)
    with pytest.raises(StandoffError, match="row 2, from 0, is inf in 'x'"):
        job.distances(2, 3)
    with pytest.raises(SceneError, match="is 4, but the file has 3 rows"):
        make(FILE.format(top=TOP, name="rows.npy") + "rows = 4\n")


def test_mangled_jobs_are_read_or_refused(make: Make, tmp_path: Path) -> None:
    """Bytes and lines changed at random: never another error than a scene's."""
    make()
    rng, words = (
        random.Random(4),
        ["nan", "-1", '""', "[[", "1e999", "{}", "true", "\x1b", "=", "\n"],
    )
    file = tmp_path / "job.toml"
    refused: list[SceneError] = []
    for _ in range(300):
        text = list(JOB)
        for _ in range(rng.randint(1, 3)):
            at = rng.randrange(len(text))
            text[at : at + rng.choice([0, 1, 3])] = rng.choice(words)
        file.write_text("".join(text), encoding="utf-8")
        try:
            load_job(file)
        except SceneError as error:
            refused.append(error)
    assert len(refused) > 200
    assert all(str(error).isprintable() for error in refused)
