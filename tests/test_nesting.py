"""How deep files may be nested: a limit of our own, counted without a parser."""

from __future__ import annotations

import json
import sys
import time
import tomllib

import pytest

from standoff.nesting import DEEPEST_NESTING, JSON, TOML, text_problem, value_problem

MOST = DEEPEST_NESTING


@pytest.mark.parametrize(("count", "deep"), [(MOST, False), (MOST + 1, True), (100_000, True)])
def test_brackets_are_counted(count: int, deep: bool) -> None:
    lists, tables = "[" * count + "]" * count, '{"a":' * count + "1" + "}" * count
    for text in (lists, tables, lists[:count]):
        assert bool(text_problem(text, JSON)) == deep
    for text in (f"x =\n {lists}", "{a=" * count + "1" + "}" * count):
        problem = text_problem(text, TOML)
        assert bool(problem) == deep
        assert not deep or f"more than {MOST} in one another" in problem
        assert len(problem) < 200
    assert not deep or "on line 2" in text_problem(f"x =\n {lists}", TOML)
    # One beside another is not one in another.
    assert not text_problem("[1], " * count, JSON)


@pytest.mark.parametrize(
    "text",
    [
        'x = "{}"',
        "x = '{}'",
        'x = """\n{}\n"""',
        "x = '''\n{}\n'''",
        "x = 1  # {}",
        r'x = "\"{}"',
        'x = """a\\"{}"""',
        'x = [""" " ""{} """]',
    ],
)
def test_brackets_in_texts_and_comments_do_not_count(text: str) -> None:
    whole = text.format("[" * 1000)
    tomllib.loads(whole)
    assert not text_problem(whole, TOML)
    if "#" not in text and "'" not in text and '"""' not in text:
        assert not text_problem(json.dumps({"x": "[" * 1000 + '"'}), JSON)


@pytest.mark.parametrize(
    "text",
    [
        "x = ['''a'''', {}]",
        'x = ["""a"""", {}]',
        'x = ["""a""""", {}]',
        "x = ['', {}]",
        'x = ["", {}]',
        "x = ['\\', {}]",
        'x = ["\\\\", {}]',
        "# it's a\nx = {}",
        'x = ["it\'s", {}]',
    ],
)
def test_brackets_behind_a_text_count(text: str) -> None:
    assert tomllib.loads(text.format("[1]"))
    assert text_problem(text.format("[" * 60 + "]" * 60), TOML)


def test_values_are_counted_with_the_keys_on_the_way() -> None:
    for count, deep in ((MOST, False), (MOST + 1, True), (100_000, True)):
        lists: object = 1
        tables: object = 1
        for k in range(count):
            lists, tables = [lists], {f"k{count - k}": tables}
        assert bool(value_problem(lists)[0]) == deep
        problem, keys = value_problem(tables)
        assert bool(problem) == deep
        assert keys[:3] == (["k1", "k2", "k3"] if deep else [])
    assert value_problem({"a": [[1] * 1000] * 1000, "b": ({},) * 100}) == ("", [])


def test_the_limit_is_far_below_the_interpreters() -> None:
    """Within it the parsers work, whatever the depth that the interpreter allows."""
    deepest = "[" * MOST + "]" * MOST
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(limit // 2)
    try:
        assert tomllib.loads(f"x = {deepest}")
        assert json.loads(deepest) is not None
    finally:
        sys.setrecursionlimit(limit)


@pytest.mark.parametrize(
    "piece", ['""', "'", '"""', '"\\', '"""\\', "'''", "#", "\\", "[]", '"\n', "'''' ", '"""" \\']
)
def test_the_time_grows_with_the_length_alone(piece: str) -> None:
    text = piece * 100_000 + "\\"
    started = time.perf_counter()
    for form in (TOML, JSON):
        text_problem(text, form)
    assert time.perf_counter() - started < 20.0
