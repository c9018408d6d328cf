"""Bodies of a test file, each made when a test first asks for it.

Every process that runs tests imports every file of them, so what a file makes as it is imported is
made in each process, wherever its tests run.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any


class OnFirstUse(Mapping[str, Any]):
    """What each name's function returns; it is called once."""

    def __init__(self, makers: Mapping[str, Callable[[], Any]]) -> None:
        self._makers = dict(makers)
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = self._makers[name]()
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)
