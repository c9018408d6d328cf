"""`standoff check`: what it tells of a body, and what it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

import standoff as so
from standoff.scene import load_scene

Standoff = Callable[..., Any]

BOX = 'shape = "box", size = [1, 2, 3]'


def test_a_shape_in_a_line(standoff: Standoff) -> None:
    ended = standoff("check", BOX)
    assert (ended.code, ended.err) == (0, "")
    rows = [line.split(maxsplit=1) for line in ended.out.splitlines() if line.strip()]
    found = {what: rest[0].strip() for what, *rest in rows if rest}
    assert found["faces"] == "6, in 6 charts"
    assert (found["edges"], found["vertices"]) == ("12", "8")
    assert found["size"] == f"{14**0.5:.9g} m"


def test_json_is_the_report(standoff: Standoff) -> None:
    facts = json.loads(standoff("check", BOX, "--json").out)
    body = so.shapes.box(1, 2, 3)
    assert facts["report"] == json.loads(json.dumps(asdict(body.check())))
    assert facts["digest"] == body.digest
    assert facts["shape"] == "box"


def test_the_bodies_of_a_scene(standoff: Standoff, passing: Path) -> None:
    ended = standoff("check", passing)
    assert ended.code == 0
    assert "tool: ellipsoid" in ended.out
    assert "part: box" in ended.out
    assert " cm" in ended.out
    facts = json.loads(standoff("check", passing, "--json").out)
    assert [body["body"] for body in facts["bodies"]] == list(load_scene(passing).bodies)
    facts = json.loads(standoff("check", passing, "--json", "--body", "part").out)
    assert facts["report"]["vertices"] == 8


@pytest.mark.parametrize(
    ("arguments", "piece"),
    [
        (["nothing"], "'nothing' is no scene (.toml), no file of patches (.json) and no shape"),
        (["no.toml"], "no file 'no.toml'"),
        (["no.json"], "no file 'no.json'"),
        (["passing.toml", "--body", "tol"], "--body: unknown body 'tol'; did you mean 'tool'?"),
        (['shape = "bxo"'], "body.shape: unknown shape 'bxo'; did you mean 'box'?"),
        (['shape = "sphere", radius = -1'], "body.radius: must be above zero, got -1"),
        (["shape = box"], "is no shape as a scene writes it"),
        (['shape = "lens", radius = 1, offset = 2'], "body: Empty lens"),
    ],
)
def test_refused(
    standoff: Standoff,
    passing: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    piece: str,
) -> None:
    monkeypatch.chdir(passing.parent)
    ended = standoff("check", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("standoff: ")
    assert ended.err.count("\n") == 1
    assert piece in ended.err
