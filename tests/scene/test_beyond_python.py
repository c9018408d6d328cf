"""Scenes that Python's own parsers or file calls refuse: all end in a `SceneError`."""

from __future__ import annotations

from pathlib import Path

import pytest

from standoff.cli.entry import main
from standoff.scene import SceneError, load_scene

BOX = '[bodies.a]\nshape = "box"\n{}\n'
REST = '[bodies.b]\nshape = "sphere"\nradius = 1.0\n[pair]\na = "a"\nb = "b"\n'
MOVED = BOX.format("size = [1, 1, 1]") + REST + '[motions.a]\nkind = "samples"\nfile = "{}"\n'
PATCHES = '[bodies.a]\nshape = "patches"\nfile = "patches.json"\n' + REST
HEAD = '{"format": "standoff-patches", "version": '
LONGEST = 700
"""Characters that a message may have, whatever the scene holds."""

SCENES = {
    "deep lists": (BOX.format("size = " + "[" * 3000 + "]" * 3000), "", ["'[[[", "line 4"]),
    "deep tables": (BOX.format("size = " + "{a=" * 3000 + "1" + "}" * 3000), "", ["line 4"]),
    "deep keys": (BOX.format("size" + ".a" * 3000 + " = 1"), "bodies.a.size", ["too deeply"]),
    "lists one too deep": (BOX.format("size = " + "[" * 51 + "]" * 51), "", ["more than 50"]),
    "keys one too deep": (BOX.format("size" + ".a" * 48 + " = 1"), "bodies.a.size", ["than 50"]),
    "many digits": (BOX.format(f"size = [1, 1, {'9' * 5000}]"), "", ["'999", "line 4", "1e308"]),
    "many hexadecimal digits": (
        BOX.format(f"size = [1, 1, 0x{'f' * 5000}]"),
        "bodies.a.size[2]",
        ["finite number", "0xff"],
    ),
    "long key": (BOX.format("k" * 5000 + " = 1"), "bodies.a." + "k" * 5000, ["'kkk", "'size'"]),
    "long file name": (MOVED.format("x" * 5000), "motions.a.file", ["no file 'xxx", "…"]),
    "no file name": (MOVED.format(r"a\u0000.tum"), "motions.a.file", [r"no file 'a\x00.tum'"]),
}
FILES = {
    "deep lists": ("[" * 100_000, ["'[[[", "line 1"]),
    "many digits": (HEAD + "9" * 5000 + "}", ["'999", "line 1", "1e308"]),
    "twice": (HEAD + '1, "' + "k" * 5000 + '": 1, "' + "k" * 5000 + '": 2}', ["'kkk", "twice"]),
}


def refused(file: Path) -> SceneError:
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    assert len(str(caught.value)) < LONGEST + len(str(file))
    return caught.value


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_beyond_python(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, key, pieces = SCENES[name]
    file = tmp_path / "scene.toml"
    file.write_text("version = 1\n" + text, encoding="utf-8")
    error = refused(file)
    assert error.file == file
    assert error.key == key
    for piece in pieces:
        assert piece in error.problem
    assert main(["distance", str(file)]) == 2
    assert capsys.readouterr().err.endswith(f" ...\nstandoff: {error}\n")


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_patches_beyond_python(name: str, tmp_path: Path) -> None:
    content, pieces = FILES[name]
    patches = tmp_path / "patches.json"
    patches.write_text(content, encoding="utf-8")
    (tmp_path / "scene.toml").write_text("version = 1\n" + PATCHES, encoding="utf-8")
    error = refused(tmp_path / "scene.toml")
    assert error.file == patches
    for piece in pieces:
        assert piece in error.problem


def test_the_name_of_a_scene_may_be_too_long(tmp_path: Path) -> None:
    error = refused(tmp_path / f"{'x' * 5000}.toml")
    assert "no file" in error.problem
    assert "…" in error.problem


def test_a_byte_order_mark_is_passed_over(tmp_path: Path) -> None:
    text = "version = 1\n" + BOX.format("size = [1, 1, 1]") + REST
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8-sig")
    assert load_scene(tmp_path / "scene.toml").text == text


@pytest.mark.parametrize(
    ("what", "piece"),
    [
        ('shape = "box", size = ' + "[" * 3000 + "]" * 3000, "in one another"),
        (f'shape = "box", size = [1, 1, {"9" * 5000}]', "4300 digits"),
        ("x" * 5000 + ".toml", "no file 'xxx"),
        ("x" * 5000 + ".json", "no file 'xxx"),
        ("x" * 5000, "'xxx"),
    ],
)
def test_a_shape_in_a_line(what: str, piece: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", what]) == 2
    told = capsys.readouterr().err
    assert piece in told
    assert len(told) < LONGEST


def test_a_long_line_is_a_shape(capsys: pytest.CaptureFixture[str]) -> None:
    """Longer than any file's name may be."""
    points = ", ".join(f"[{float(i)}, {float(i * i)}, {float(i**3)}]" for i in range(40))
    assert main(["check", f'shape = "polytope", vertices = [{points}]']) == 0
    assert "polytope" in capsys.readouterr().out
