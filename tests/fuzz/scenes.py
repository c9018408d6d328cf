"""The law of scenes: a scene that answers, or a `SceneError` that names the place."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from fuzz.laws import Broken, refusals
from fuzz.mutation import damaged, mutated
from fuzz.toml_text import toml_text
from standoff.scene import SceneError, load_scene, query, record

MOST_FRAMES = 60
"""Longer runs are not tracked: the reader is what is tried here."""
BY_BYTES = 0.15
"""Share of inputs that are damaged as bytes, not as tables."""


def scene_input(seeds: list[bytes], random: Random) -> bytes:
    """Return a mutated scene."""
    seed = random.choice(seeds)
    if random.random() < BY_BYTES:
        return damaged(seed, random)
    try:
        tree, other = (tomllib.loads(s.decode()) for s in (seed, random.choice(seeds)))
        return toml_text(mutated(tree, random, other)).encode("utf-8", "surrogatepass")
    except (ValueError, RecursionError):  # a seed that Python does not read, once a failure
        return damaged(seed, random)


def check_scene(content: bytes, folder: Path) -> str:
    """Load, ask and run a scene from a folder; the folder's other files are its own.

    Raises
    ------
    Broken
        The law of scenes does not hold.
    """
    file = folder / "scene.toml"
    file.write_bytes(content)
    before = _listing(folder)
    said = "scene"
    with refusals((SceneError,)) as refused:
        try:
            _use(file)
        except SceneError as error:
            _check_message(error, file)
            raise
    if refused:
        said = "refused"
    if _listing(folder) != before:
        raise Broken(f"files changed: {set(_listing(folder)) ^ set(before)}")
    return said


def _use(file: Path) -> None:
    scene = load_scene(file)
    for view in scene.each():
        _, answer = query(view)
        numbers = [answer.distance, answer.lower_bound, *answer.point_a, *answer.point_b]
        if answer.certified and not np.isfinite(numbers).all():
            raise Broken(f"a certified answer that is not finite: {answer!r}")
        times = view.times()
        if not (np.isfinite(times).all() and (np.diff(times) > 0.0).all()):
            raise Broken("frame times that do not increase")
        if len(times) <= MOST_FRAMES:
            run = record(view)
            if len(run.time) != len(times):
                raise Broken("frames are missing")
            json.dumps(run.info.source)


def _check_message(error: SceneError, file: Path) -> None:
    text = str(error)
    if error.file is None or not text.startswith(str(error.file)):
        raise Broken(f"the message names no file: {text!r}") from error
    if not error.problem.strip():
        raise Broken(f"an empty message: {text!r}") from error


def _listing(folder: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def tables_of(content: bytes) -> Any:
    """A scene's tables, for those who look at the corpus."""
    return tomllib.loads(content.decode())
