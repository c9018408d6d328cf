"""The pages' commands print what they say, and the diagrams are what their script draws."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from printed import assert_same_but_roundoff
from standoff.cli import main

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
QUICK_START = (DOCS / "quick-start.md").read_text("utf-8")


def block_after(words: str, language: str) -> str:
    """The first block of a language after some words of the quick start."""
    rest = QUICK_START[QUICK_START.index(words) :]
    (block,) = re.findall(rf"^```{language}\n(.*?)^```$", rest, re.DOTALL | re.MULTILINE)[:1]
    return str(block)


def test_demo_prints_what_the_quick_start_says(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    recipe = (ROOT / "Makefile").read_text("utf-8")
    (command,) = re.findall(r"\$\(BIN\)/standoff (track .*)", recipe)
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)
    assert main(command.split()) == 0
    assert_same_but_roundoff(capsys.readouterr().out, block_after("`make demo` tracks it", "text"))
    assert (tmp_path / "build" / "demo.png").exists()
    assert (tmp_path / "build" / "demo.parquet").exists()


def test_scene_of_the_quick_start_prints_what_it_says(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "helix.toml").write_text(block_after("## A scene", "toml"), encoding="utf-8")
    command = block_after("\nand run\n", "sh").split()
    assert command[0] == ".venv/bin/standoff"
    assert main(command[1:]) == 0
    assert_same_but_roundoff(capsys.readouterr().out, block_after("\nand run\n", "text"))


def commands_with_their_output() -> list[tuple[str, str, str]]:
    """(page, arguments, promised) of every block of one `standoff` command with a text block."""
    fence = re.compile(r"^```sh\nstandoff ([^\n]*)\n```\n\n```text\n(.*?)^```$", re.S | re.M)
    return [
        (page.name, arguments, promised)
        for page in sorted(DOCS.rglob("*.md"))
        for arguments, promised in fence.findall(page.read_text("utf-8"))
    ]


@pytest.mark.parametrize(("page", "arguments", "promised"), commands_with_their_output())
def test_commands_print_what_the_pages_say(
    page: str,
    arguments: str,
    promised: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(ROOT)
    assert main(arguments.split()) == 0
    assert_same_but_roundoff(capsys.readouterr().out, promised)


def test_diagrams_are_what_their_script_draws(tmp_path: Path) -> None:
    script = DOCS / "images" / "draw_diagrams.py"
    subprocess.run([sys.executable, str(script), str(tmp_path)], check=True)
    drawn = sorted(tmp_path.iterdir())
    assert len(drawn) == 3
    for file in drawn:
        assert file.read_bytes() == (script.parent / file.name).read_bytes(), file.name


def test_laws_table_has_the_integrators_and_their_limits() -> None:
    from standoff.kernels.paper.integrators import NAMES, STABILITY_LIMITS, STAGES

    page = (DOCS / "laws.md").read_text("utf-8")
    rows = re.findall(r"^\| `(\w+)` \| (\d) \|.*\| ([\d.]+) \|$", page, re.MULTILINE)
    limits = zip(NAMES, STAGES, STABILITY_LIMITS, strict=True)
    assert rows == [(name, str(stages), f"{limit:.4g}") for name, stages, limit in limits]


def test_symbols_table_names_what_is_in_the_code() -> None:
    """Every function that the table of symbols names in a kernel is there."""
    page = (DOCS / "symbols.md").read_text("utf-8")
    rows = [row for row in page.splitlines() if row.startswith("|") and ".py`" in row]
    assert len(rows) > 30
    for row in rows:
        cells = [cell.strip() for cell in row.split("|")[1:-1]]
        (file,) = re.findall(r"`([\w/]+\.py)`", cells[-1])
        folder = ROOT / "src" if file.startswith("standoff") else ROOT / "src/standoff/kernels"
        source = (folder / file).read_text("utf-8")
        for name in re.findall(r"`(\w+)`", cells[1] + cells[-1]):
            assert re.search(rf"\b{name}\b", source), f"{file} has no {name}: {row}"


def folders_and_files(page: str) -> set[str]:
    """What a page names below `src/standoff`, such as `kernels/pair/` or `bodies/packing.py`."""
    return set(re.findall(r"`([a-z_]+/(?:\w+/)*(?:\w+\.py)?)`", (ROOT / page).read_text("utf-8")))


@pytest.mark.parametrize("page", ["docs/architecture.md", "docs/wheels.md", "CONTRIBUTING.md"])
def test_folders_and_files_that_a_page_names_exist(page: str) -> None:
    places = (ROOT, ROOT / "studies/src", ROOT / "src/standoff")
    named = folders_and_files(page)
    assert len(named) > 4
    assert not [name for name in sorted(named) if not any((x / name).exists() for x in places)]


def test_the_architecture_names_every_folder() -> None:
    page = folders_and_files("docs/architecture.md")
    own = [f for f in (ROOT / "src/standoff").iterdir() if (f / "__init__.py").exists()]
    kernels = [f for f in (ROOT / "src/standoff/kernels").iterdir() if (f / "__init__.py").exists()]
    named = {f"{f.name}/" for f in own} | {f"kernels/{f.name}/" for f in kernels}
    assert named - page == {"voronoi/"}  # it only hands out names


def test_the_architecture_draws_files_that_exist() -> None:
    drawing = (DOCS / "images" / "architecture.svg").read_text("utf-8")
    files = re.findall(r"[a-z]+/\w+\.py", drawing)
    assert len(files) > 15
    places = (ROOT / "src/standoff", ROOT / "src/standoff/kernels")
    assert not [file for file in files if not any((x / file).exists() for x in places)]
