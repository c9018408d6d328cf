"""``standoff sweep``: what it prints, exit codes, one row, the estimate, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cli.conftest import Standoff, lines_of
from cli.test_hostile_names import OBEYED, hostile, obeyed, toml
from standoff.sweep import run as runs
from standoff.sweep.folder import locked
from standoff.sweep.reading import load_job
from standoff.wording import at_least
from sweep.conftest import JOB, SCENE, TOP
from sweep.shape_jobs import SHAPE_JOB, TOOL_AND_BALL
from sweep.test_subjects import OF_ROBOT


def test_a_sweep_and_its_report(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ended = standoff("sweep", job, "-o", out)
    assert ended.code == 3  # rows are below the length
    facts = json.loads((out / "report.json").read_text())
    said = lines_of(ended.out)
    assert said["sweep"] == "Two ellipsoids: tool and part"
    assert said["parameters"] == (
        "x (x of tool), z (z of tool), any (uniform rotation of tool), tilt (turn_y of part)"
    )
    assert said["rows"] == "3 000, sobol, seed 5"
    assert said["certified"] == "3 000 of 3 000 rows, 100 %"
    assert said["distance"].startswith(f"{facts['distance']['min']:.6g} cm (row ")
    assert f"mean {facts['distance']['mean']:.6g} cm" in said["distance"]
    assert said["worst"].startswith(f"row {facts['worst']['row'][0]}: ")
    assert said["below"] == (
        f"{facts['below']['count']} rows are not proven to be 0.5 cm apart; the report lists the "
        "first 100"
    )
    assert said["wrote"] == str(out / "report.json")
    # 50 bins are printed as 10 of five each, and the rows outside of them
    told = [int(line.split()[-1]) for line in ended.out.splitlines() if " ... " in line]
    counts = facts["histogram"]["counts"]
    assert told == [sum(counts[k : k + 5]) for k in range(0, 50, 5)] == told[:10]
    assert len(facts["histogram"]["edges"]) == 51

    again = standoff("sweep", job, "-o", out, "--json")
    short = json.loads(again.out)
    assert len(short["worst"]["row"]) == 10
    assert short["worst"]["row"] == facts["worst"]["row"][:10]
    assert short["folder"] == str(out)


def test_a_sweep_that_holds(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    job.write_text(JOB.replace("below = 0.5", "below = -50.0"), encoding="utf-8")
    ended = standoff("sweep", job, "-o", tmp_path / "out")
    assert ended.code == 0
    assert lines_of(ended.out)["below"] == "no row: all are proven to be -50 cm or more apart"


def test_an_uncertified_row_is_told(
    standoff: Standoff, job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job.write_text(JOB.replace("below = 0.5\nmost_below = 100\n", ""), encoding="utf-8")
    from standoff.sweep.rows import Rows

    def all_but_two(first: int, answers: Any) -> Any:
        rows = real(first, answers)
        rows.status[(rows.row == 12) | (rows.row == 2999)] = 3
        return rows

    real = Rows.of
    monkeypatch.setattr(Rows, "of", all_but_two)
    ended = standoff("sweep", job, "-o", tmp_path / "out")
    assert ended.code == 3
    said = lines_of(ended.out)
    assert said["certified"] == "2 998 of 3 000 rows, 99.93 %; not certified: 12, 2999"
    assert "2 NOT_CERTIFIED" in said["status"]
    facts = json.loads((tmp_path / "out" / "report.json").read_text())
    assert facts["uncertified"]["row"] == [12, 2999]
    assert facts["holds"] is False


def test_one_row(standoff: Standoff, job: Path) -> None:
    found = load_job(job)
    ended = standoff("sweep", job, "--row", 1234)
    answer = found.distances(1234, 1235)[0]
    said = lines_of(ended.out)
    assert ended.code == 0
    assert said["row"] == "1234 of 3000"
    assert said["distance"] == f"{answer.distance:.17g} cm"
    assert float(said["tilt"].split()[0]) == found.numbers(1234, 1235)[0, 5]
    assert said["tilt"].endswith(" deg, turn_y of part")
    facts = json.loads(standoff("sweep", job, "--row", 1234, "--json").out)
    assert facts["distance"] == answer.distance
    assert list(facts["parameters"].values()) == found.numbers(1234, 1235)[0].tolist()
    assert facts["poses"] == answer.as_dict()["poses"]
    assert facts["status"] == answer.status.name


def test_shapes_that_change_are_told(standoff: Standoff, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(TOOL_AND_BALL, encoding="utf-8")
    file, page, out = tmp_path / "job.toml", tmp_path / "page.html", tmp_path / "out"
    text = SHAPE_JOB.replace("worst = 5", "worst = 1").replace("rows = 60", "rows = 12")
    scale = '[parameters.s]\nshapes = "tool"\nwhat = "scale"\nfrom = 0.5\nto = 2.0\n[sampler]'
    file.write_text(text.replace("[sampler]", scale), encoding="utf-8")
    said = lines_of(standoff("sweep", file, "--row", 3).out)
    assert said["a"].endswith(" cm, semi_axes.1 of tool")
    assert said["s"].split()[1:] == ["scale", "of", "tool"]  # without a unit
    ended = standoff("sweep", file, "-o", out, "--page", page)
    assert lines_of(ended.out)["parameters"].startswith("r (radius of ball), a (semi_axes.1 of")
    facts = json.loads((out / "report.json").read_text())
    assert facts["parameters"]["r"]["shapes"] == "ball"
    assert "<th" in page.read_text()
    assert ">r (cm)<" in page.read_text()
    assert ">s<" in page.read_text()
    file.write_text(text, encoding="utf-8")
    assert "shapes" not in standoff("sweep", file, "--estimate").err
    file.write_text(text.replace("to = 4.0", "to = 4.5"), encoding="utf-8")
    ended = standoff("sweep", file, "-o", out)
    assert (ended.code, "parameters.a.to was 4.0 and is 4.5" in ended.err) == (2, True)


def test_one_row_tells_joints_and_pair(standoff: Standoff, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    file = tmp_path / "job.toml"
    file.write_text(OF_ROBOT, encoding="utf-8")
    job = load_job(file)
    found = job.alone(5)
    ended = standoff("sweep", file, "--row", 5)
    assert ended.code == 0
    joints = ended.out.partition("\nq  ")[2].splitlines()[0].split()
    assert [float(number) for number in joints] == found.state["q"]
    assert "rad, joint j2\n" in ended.out
    assert "deg, joint j1\n" in ended.out
    a, b = found.names
    assert f"from {a} to {b}\n" in ended.out
    facts = json.loads(standoff("sweep", file, "--row", 5, "--json").out)
    assert facts["names"] == [a, b]
    assert facts["q"] == found.state["q"]
    swept = standoff("sweep", file, "-o", tmp_path / "out").out
    assert "the MuJoCo model 'arm beside a shelf'" in swept
    first = job.alone(json.loads((tmp_path / "out/report.json").read_text())["worst"]["row"][0])
    assert f", {first.names[0]} to {first.names[1]}, {first.nearest.status.name}, " in swept


def test_the_estimate_writes_nothing(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    text = JOB.replace("rows = 3000", "rows = 2_000_000_000").replace("rows = 700", "rows = 300")
    job.write_text(text.replace("rows = 300\n", "rows = 1_000_000\n"), encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    ended = standoff("sweep", job, "--estimate")
    assert ended.code == 0
    assert sorted(tmp_path.iterdir()) == before
    said = lines_of(ended.out)
    assert said["shards"] == "2 000 of 1 000 000 rows"
    assert said["tried"].startswith("8192 rows, ")
    assert said["time"].endswith(" with 1 process")
    one = json.loads(standoff("sweep", job, "--estimate", "--json").out)
    assert one["seconds"] == pytest.approx(2e9 * one["row_seconds"])
    assert (one["rows"], one["shards"], one["uncertified"]) == (2_000_000_000, 2000, 0)


def test_the_estimate_of_the_disk_is_near(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    told = json.loads(standoff("sweep", job, "--estimate", "--json").out)
    standoff("sweep", job, "-o", tmp_path / "out")
    size = sum(file.stat().st_size for file in (tmp_path / "out" / "shards").iterdir())
    assert told["size"] == pytest.approx(size, rel=0.15)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ([], "-o: name the folder for shards and report, such as: -o swept"),
        (["-o", ""], "-o: name the folder"),
        (["-o", "out", "--workers", "0"], "--workers: must be 1 or more, got 0"),
        (["--row", "3000"], "--row: the job has rows 0 to 2999, got 3000"),
        (["--row", "-1"], "--row: the job has rows 0 to 2999, got -1"),
        (["--row", "1", "--estimate"], "--estimate and --row: give one of them"),
        (["--row", "1", "--page", "a.html"], "--page: is of a whole sweep, and --row is not"),
        (["-o", "out", "--page", "a.htm"], "--page a.htm: the ending '.htm' is not known"),
        (["--row", "1", "-o", "out"], "-o: --row writes nothing; leave it out"),
        (["--estimate", "-o", "out"], "-o: --estimate writes nothing; leave it out"),
        (["--estimate", "--plot", "a.png"], "--plot: --estimate writes nothing; leave it out"),
        (["--row", "1", "--plot", "a.bmp"], "--plot a.bmp: the ending '.bmp' is not known"),
        (["-o", "out", "--cluster", "a", "--workers", "2"], "--cluster and --workers"),
        (["-o", "job.toml"], "-o job.toml: is a file, not a folder"),
        (["-o", "."], "-o"),
    ],
)
def test_options_that_are_refused(
    standoff: Standoff,
    job: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    given: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    ended = standoff("sweep", job, *given)
    assert (ended.code, ended.out) == (2, "")
    assert told in ended.err
    assert sorted(tmp_path.iterdir()) == before


def test_a_folder_that_is_in_use_or_of_another_job(
    standoff: Standoff, job: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    with locked(out):
        ended = standoff("sweep", job, "-o", out)
    assert ended.code == 2
    assert f"-o {out}: another sweep runs in this folder" in ended.err
    standoff("sweep", job, "-o", out)
    job.write_text(JOB.replace("seed = 5", "seed = 6"), encoding="utf-8")
    ended = standoff("sweep", job, "-o", out)
    assert ended.code == 2
    assert "was begun by another job: sampler.seed was 5 and is 6" in ended.err


def test_a_damaged_shard_is_told(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    standoff("sweep", job, "-o", tmp_path / "out")
    (tmp_path / "out" / "shards" / "000000002.json").write_text("{}")
    ended = standoff("sweep", job, "-o", tmp_path / "out")
    assert ended.code == 3
    assert "000000002.json cannot be used, it is not a whole file: it is computed" in ended.err


@pytest.mark.parametrize(
    ("raised", "code", "told"),
    [
        (OSError(28, "No space left on device"), 1, "No space left on device; what is whole stays"),
        (KeyboardInterrupt(), 130, "interrupted; the same command goes on where it was"),
    ],
)
def test_ends_in_the_middle(
    standoff: Standoff,
    job: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    raised: BaseException,
    code: int,
    told: str,
) -> None:
    def failing(*_: object) -> None:
        raise raised

    with monkeypatch.context() as patch:
        patch.setattr(runs, "make_shard", failing)
        ended = standoff("sweep", job, "-o", tmp_path / "out")
    assert ended.code == code
    assert told in ended.err
    assert standoff("sweep", job, "-o", tmp_path / "out").code == 3


def test_a_job_and_a_scene_do_not_speak_to_the_terminal(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = hostile(SCENE)
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    file, out = tmp_path / "job.toml", tmp_path / "out"
    shown = JOB
    for name in ("tool", "part"):
        shown = shown.replace(f'"{name}"', toml(f"{OBEYED} {name}"))
    file.write_text(f"title = {toml(OBEYED)}\n{shown}", encoding="utf-8")
    for given in (["-o", out], ["-o", out, "--json"], ["--row", 3], ["--row", 3, "--json"]):
        ended = standoff("sweep", file, *given)
        assert ended.code in (0, 3), ended.err
        assert obeyed(ended.out + ended.err) == []
    ended = standoff("sweep", file, "--estimate")
    assert obeyed(ended.out + ended.err) == []
    file.write_text(f"title = {toml(OBEYED + 'x')}\n{shown}", encoding="utf-8")
    ended = standoff("sweep", file, "-o", out)
    assert "title was" in ended.err
    assert obeyed(ended.err) == []
    text = shown.replace("scene = ", "world = ").replace("worst = 40", "worst = 2")
    file.write_text(f"title = {toml(OBEYED)}\n{text}".replace("= 3000", "= 30"), encoding="utf-8")
    page = tmp_path / "page.html"
    for given in (["-o", tmp_path / "world", "--page", page], ["--row", 3], ["--row", 3, "--json"]):
        ended = standoff("sweep", file, *given)
        assert ended.code in (0, 3), ended.err
        assert obeyed(ended.out + ended.err) == []
    assert obeyed(page.read_text(encoding="utf-8")) == []


def test_pictures(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    picture = tmp_path / "histogram.png"
    assert standoff("sweep", job, "-o", tmp_path / "out", "--plot", picture).code == 3
    assert picture.read_bytes().startswith(b"\x89PNG")
    row = tmp_path / "row.svg"
    assert standoff("sweep", job, "--row", 5, "--plot", row).code == 0
    assert "<svg" in row.read_text("utf-8")
    job.write_text(JOB.replace("histogram = ", "# "), encoding="utf-8")
    ended = standoff("sweep", job, "-o", tmp_path / "new", "--plot", picture)
    assert ended.code == 2
    assert "keeps no histogram; add to [keep] a line such as: histogram = {" in ended.err
    assert not (tmp_path / "new").exists()


def test_the_bars_are_the_counts(job: Path, tmp_path: Path) -> None:
    report = runs.run_sweep(load_job(job), tmp_path / "out")
    from matplotlib.colors import to_rgba

    from standoff.sweep.plot import FAR, NEAR, histogram_figure

    (axes,) = histogram_figure(report).axes
    heights = [bar.get_height() for bar in axes.patches]
    under, over, _ = report.found.outside.tolist()
    assert heights == [*report.found.bins.tolist(), *(n for n in (under, over) if n)]
    # those wholly below the length have another colour
    assert len({bar.get_facecolor() for bar in axes.patches[:5]}) == 1
    assert axes.patches[4].get_facecolor() == to_rgba(NEAR) != to_rgba(FAR)
    assert axes.patches[5].get_facecolor() == axes.patches[49].get_facecolor() == to_rgba(FAR)


def test_the_page(standoff: Standoff, job: Path, tmp_path: Path) -> None:
    """One file that needs no other: totals, histogram, the worst rows drawn and listed."""
    text = JOB.replace("rows = 3000", "rows = 60").replace("worst = 40", "worst = 3")
    job.write_text(text.replace(TOP, f'title = "<b>a & b</b>"\n{TOP}'), encoding="utf-8")
    page = tmp_path / "page.html"
    ended = standoff("sweep", job, "-o", tmp_path / "out", "--page", page)
    assert f"wrote         {page}\n" in ended.out
    told = page.read_text(encoding="utf-8")
    facts = json.loads((tmp_path / "out" / "report.json").read_text())
    assert told.count("<figure>") == 3
    assert told.count("data:image/png;base64,") == 4
    assert "<b>" not in told
    assert "Sweep: &lt;b&gt;a &amp; b&lt;/b&gt;" in told
    assert "Rows that are not certified: 0." in told
    assert f"{facts['below']['count']} rows are not proven to be 0.5 cm apart." in told
    for key in ("distance", "lower_bound"):
        assert f">{at_least(facts[key]['min'])} cm<" in told
        assert f">{facts[key]['sum'] / 60:.6g} cm<" in told
    for k, row in enumerate(facts["worst"]["row"]):
        distance = facts["worst"]["distance"][k]
        assert f"<figcaption>row {row}: {at_least(distance)} cm, A tool, B part, " in told
        cells = [f"{facts['worst']['parameters'][name][k]:.6g}" for name in ("x", "z", "any.1")]
        assert "".join(f'<td class="number">{cell}</td>' for cell in cells) in told
    assert "src=" not in told.replace('src="data:', "")
    assert "http" not in told.replace("http-equiv", "")


def test_the_page_lists_rows_that_are_not_certified(job: Path) -> None:
    from standoff.sweep.page import page_of
    from standoff.sweep.report import Report

    text = JOB.replace("rows = 3000", "rows = 40").replace("worst = 40", "worst = 1")
    job.write_text(text, encoding="utf-8")
    small = load_job(job)
    found = small.kept(0, 40)
    rows = small.answers(7, 8)
    found.uncertified.add(rows._replace(status=rows.status * 0 + 3))
    told = page_of(Report(small, found))
    assert '<span class="bad">1 row is not certified</span>' in told
    _, _, listed = told.partition("<h2>Rows that are not certified</h2>")
    assert "<td>7</td>" in listed
    assert "NOT_CERTIFIED" in listed
