"""What commands print, compared with what the pages say that they do."""

import re

import numpy as np

NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]\d+)?")


def assert_same_but_roundoff(printed: str, promised: str) -> None:
    """Line by line the same words; numbers to 1e-9, but those that are themselves roundoff."""
    lines = printed.splitlines()
    for line in promised.splitlines():
        found = lines.pop(0)
        assert NUMBER.sub("#", found).split() == NUMBER.sub("#", line).split()
        if not line.startswith("worst gap"):
            numbers = [[float(x) for x in NUMBER.findall(text)] for text in (found, line)]
            np.testing.assert_allclose(*numbers, rtol=1e-9)
