"""Every input that once failed, and the seeds, once more; then a few new ones of each target."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import standoff as so
from draws import draws
from fuzz.laws import Broken, refusals, watchdog
from fuzz.mutation import mutated
from fuzz.targets import TARGETS, check_once
from fuzz.toml_text import toml_text

KEPT = [(name, file) for name, target in TARGETS.items() for file in sorted(target.corpus())]
SEEDS_ANSWER = {"scene", "body", "path", "pose", "curve", "surface", "read"}


@pytest.mark.parametrize(("name", "file"), KEPT)
def test_the_corpus_keeps_the_laws(name: str, file: str) -> None:
    target = TARGETS[name]
    with watchdog():
        word = check_once(target, file, target.corpus()[file])
    if file.startswith("seed-"):
        assert word in SEEDS_ANSWER


@pytest.mark.parametrize("name", sorted(TARGETS))
@settings(max_examples=draws(12), suppress_health_check=list(HealthCheck))
@given(number=st.integers(0, 2**32 - 1))
def test_new_inputs_keep_the_laws(name: str, number: int) -> None:
    """Hypothesis only numbers the draws: shrinking a mutation's seed would tell nothing."""
    target = TARGETS[name]
    file, content = target.draw(target.corpus(), Random(number))
    with watchdog():
        check_once(target, file, content)


TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=12,
)


@settings(max_examples=draws(30), suppress_health_check=list(HealthCheck))
@given(tree=st.dictionaries(st.sampled_from(["version", "bodies", "pair", "track"]), TREES))
def test_tables_of_anything_are_refused(tree: dict[str, object]) -> None:
    """What no mutation of a good scene comes to."""
    text = toml_text(tree).encode("utf-8", "surrogatepass")
    with watchdog():
        assert check_once(TARGETS["scene"], "scene.toml", text) == "refused"


NUMBERS = st.floats() | st.integers(-(10**6), 10**6) | st.sampled_from([True, "1", None, 1j])


@settings(max_examples=draws(30), suppress_health_check=list(HealthCheck))
@given(
    make=st.sampled_from(["ellipsoid", "box", "lens", "cylinder", "cone", "cap", "spindle", "egg"]),
    numbers=st.lists(NUMBERS, min_size=3, max_size=3),
)
def test_shapes_of_any_numbers(make: str, numbers: list[object]) -> None:
    """A body or a refusal, for numbers that Hypothesis shrinks."""
    count = 3 if make in ("ellipsoid", "box") else 2
    with watchdog(), refusals((ValueError,)):
        body = getattr(so.shapes, make)(*numbers[:count])
        assert np.isfinite(body.size)


def test_a_broken_law_is_told() -> None:
    """The judges themselves: each kind of fault is seen."""
    with pytest.raises(Broken, match="undocumented: KeyError"), refusals((ValueError,)):
        {}["x"]
    with pytest.raises(Broken, match="not meant"), refusals((ValueError,)):
        float("x")
    with pytest.raises(Broken, match="RuntimeWarning"), refusals((ValueError,)):
        np.array([1e308]) * 10.0
    with pytest.raises(Broken, match="no end"), watchdog(0.05):
        time.sleep(10.0)
    with refusals((ValueError,)) as refused:
        so.shapes.sphere(-1.0)
    assert refused == ["radius = -1.0: must be zero or positive."]


def test_mutations_are_of_every_kind() -> None:
    """A hundred draws of one tree differ, and leave the tree as it was."""
    tree = json.loads((TARGETS["geometry"].folder / "seed-box.json").read_text())
    before = json.dumps(tree)
    drawn = {json.dumps(mutated([tree], Random(k), [tree])) for k in range(100)}
    assert json.dumps(tree) == before
    assert len(drawn) > 60


def test_the_corpus_is_small() -> None:
    """It is read at every run."""
    folder = Path(sys.modules["fuzz.targets"].__file__ or "").parent / "corpus"
    assert sum(p.stat().st_size for p in folder.rglob("*") if p.is_file()) < 400_000
