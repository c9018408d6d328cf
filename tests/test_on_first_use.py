"""Tables of bodies that are made when a test first asks."""

from on_first_use import OnFirstUse


def test_a_value_is_made_once_and_only_when_it_is_asked_for() -> None:
    made: list[str] = []
    table = OnFirstUse({"a": lambda: made.append("a") or [1], "b": lambda: made.append("b")})
    assert list(table) == ["a", "b"]
    assert len(table) == 2
    assert "b" in dict.fromkeys(table)
    assert made == []
    assert table["a"] is table["a"]
    assert made == ["a"]
