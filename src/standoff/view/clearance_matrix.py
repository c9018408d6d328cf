"""The clearances of a world's pairs as a small picture that follows them: an SVG of the page.

`standoff clearance` draws a larger one by matplotlib, which is too slow for each look.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import NamedTuple

from standoff.clearance.verdicts import Verdict, verdict_of
from standoff.view.gap_colours import FAR, OF_VERDICT, STOPS, css, gap_colours, writing_on
from standoff.wording import at_least, printable
from standoff.world import WorldAnswer

NamePair = tuple[str, str]

MOST_BODIES = 24
"""Bodies of the matrix: of more, those of the nearest pairs. Thinner rows are not told apart."""

WIDTH = 296.0
"""Of the picture in pixels: that of the panel."""

LETTER, FONT = 5.2, 9.5
"""Width of a letter and height of a line of names, pixels."""

MOST_LETTERS = 15
"""Letters of a name beside the matrix."""

CELL = 34.0
"""Side of a cell at most, pixels."""

SMALLEST = 5.0
"""Height of a number in pixels below which it is left out: the cell says it when pointed at."""


class PairCell(NamedTuple):
    """What is known of a pair.

    Attributes
    ----------
    verdict : Verdict
    gap : float
        Length; minus the depth where the bodies overlap, the proven bound where they are far.
    far : bool
        Beyond the horizon.
    """

    verdict: Verdict
    gap: float
    far: bool

    @property
    def text(self) -> str:
        """In the cell."""
        if self.far:
            return f"≥{at_least(self.gap, 2)}"
        return "touch" if self.verdict is Verdict.TOUCHING else at_least(self.gap, 2)

    def told(self, unit: str) -> str:
        """When it is pointed at."""
        if self.far:
            return f"at least {at_least(self.gap)} {unit}".rstrip() + " apart, beyond the horizon"
        word = "depth" if self.gap < 0.0 else "gap"
        return f"{self.verdict.name.lower()}, {word} {abs(self.gap):.6g} {unit}".rstrip()


def drawn_bodies(answer: WorldAnswer) -> list[str]:
    """Return the names beside the matrix, in the world's order; of many those of the nearest
    pairs."""
    names = [name for name, _ in answer.model.listed]
    if len(names) <= MOST_BODIES:
        return names
    pairs = answer.pairs
    nearest = [pairs.names[k] for k in pairs.distance.argsort(kind="stable")[: MOST_BODIES**2]]
    kept = list(dict.fromkeys([*(name for pair in nearest for name in pair), *names]))
    chosen = set(kept[:MOST_BODIES])
    return [name for name in names if name in chosen]


def cells_of(answer: WorldAnswer, names: Sequence[str]) -> dict[NamePair, PairCell]:
    """Return the cell of each pair of these bodies that counts.

    Parameters
    ----------
    answer : WorldAnswer
    names : sequence of str
        In the world's order.
    """
    body, rules = answer.model.names.body, answer.model.search.rules
    found = {}
    for k, second in enumerate(names):
        for first in names[:k]:
            if rules.counts(body(first, "pair"), body(second, "pair")):
                pair = answer[first, second]
                gap = pair.lower_bound if pair.far else pair.distance
                found[first, second] = PairCell(verdict_of(pair), gap, pair.far)
    return found


def matrix_picture(answer: WorldAnswer, unit: str, end: float) -> str:
    """Return the matrix as SVG, to stand in the page.

    Parameters
    ----------
    answer : WorldAnswer
    unit : str
        Label of lengths.
    end : float
        Gap of the palest colour [length].
    """
    names = drawn_bodies(answer)
    if len(names) < 2:
        return _framed([], WIDTH, FONT)
    cells = cells_of(answer, names)
    letters = max(min(len(name), MOST_LETTERS) for name in names)
    beside = LETTER * letters + 6.0
    side = min(CELL, (WIDTH - beside - 2.0) / (len(names) - 1))
    parts = []
    for i, second in enumerate(names[1:]):
        parts.append(_row_name(second, beside - 4.0, (i + 0.5) * side))
        for j, first in enumerate(names[: i + 1]):
            at = beside + j * side, i * side
            parts.append(_drawn(cells.get((first, second)), (first, second), at, side, unit, end))
    below = (len(names) - 1) * side + 4.0
    parts += [
        _column_name(name, beside + (j + 0.5) * side, below) for j, name in enumerate(names[:-1])
    ]
    # Names turned by 45 degrees reach so far down.
    height = below + 0.72 * LETTER * letters + FONT
    parts.append(_legend(cells, unit, end, height))
    height += 2.2 * FONT
    left = len(answer.model.listed) - len(names)
    if left:
        told = f"the {len(names)} bodies of the nearest pairs; {left} more are left out"
        parts.append(_text(told, 2.0, height))
        height += 0.6 * FONT
    return _framed(parts, WIDTH, height)


def _drawn(
    cell: PairCell | None,
    names: NamePair,
    at: tuple[float, float],
    side: float,
    unit: str,
    end: float,
) -> str:
    x, y = at
    if cell is None:
        middle = f'cx="{x + 0.5 * side:.1f}" cy="{y + 0.5 * side:.1f}"'
        told = _told(names, "does not count")
        return f'<circle {middle} r="1.2" fill="currentColor" opacity=".35">{told}</circle>'
    colour = _colour(cell, end)
    square = (
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{side - 1.0:.1f}" height="{side - 1.0:.1f}" '
        f'fill="{css(colour)}"/>'
    )
    size = min(8.5, 1.5 * side / len(cell.text))
    number = ""
    if size >= SMALLEST:
        number = (
            f'<text x="{x + 0.5 * (side - 1.0):.1f}" y="{y + 0.5 * side + 0.33 * size:.1f}" '
            f'text-anchor="middle" font-size="{size:.1f}" fill="{writing_on(colour)}">'
            f"{escape(cell.text)}</text>"
        )
    kind = "far" if cell.far else cell.verdict.name.lower()
    return f'<g class="{kind}">{square}{number}{_told(names, cell.told(unit))}</g>'


def _colour(cell: PairCell, end: float) -> tuple[int, ...]:
    if cell.far:
        return FAR
    if cell.verdict in OF_VERDICT:
        return OF_VERDICT[cell.verdict]
    return tuple(gap_colours([cell.gap], end)[0].tolist())


def _told(names: NamePair, text: str) -> str:
    return f"<title>{escape(f'{printable(names[0])} - {printable(names[1])}: {text}')}</title>"


def _short(name: str) -> str:
    name = printable(name)
    return name if len(name) <= MOST_LETTERS else f"{name[: MOST_LETTERS - 1]}…"


def _row_name(name: str, x: float, y: float) -> str:
    return _text(_short(name), x, y + 0.33 * FONT, 'text-anchor="end"')


def _column_name(name: str, x: float, y: float) -> str:
    turned = f'text-anchor="end" transform="rotate(-45 {x:.1f} {y:.1f})"'
    return _text(_short(name), x, y + 0.5 * FONT, turned)


def _text(text: str, x: float, y: float, more: str = "") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{FONT}" fill="currentColor" {more}>'
        f"{escape(text)}</text>"
    )


def _legend(cells: Mapping[NamePair, PairCell], unit: str, end: float, y: float) -> str:
    """A line that says what the colours are: those that there are."""
    stops = "".join(
        f'<stop offset="{k / (len(STOPS) - 1):.2f}" stop-color="{css(stop)}"/>'
        for k, stop in enumerate(STOPS)
    )
    bar = 46.0
    upto = f"{end:.3g} {unit}".rstrip()
    found = [
        f'<defs><linearGradient id="gaps">{stops}</linearGradient></defs>',
        _text("0", 2.0, y + 0.8 * FONT),
        f'<rect x="11" y="{y:.1f}" width="{bar}" height="{FONT}" fill="url(#gaps)"/>',
        _text(upto, 14.0 + bar, y + 0.8 * FONT),
    ]
    x = 24.0 + bar + LETTER * len(upto)
    entries: list[tuple[tuple[int, ...], str]] = []
    if any(cell.far for cell in cells.values()):
        entries.append((FAR, "far, at least"))
    some = {cell.verdict for cell in cells.values()}
    entries += [
        (colour, verdict.name.lower()) for verdict, colour in OF_VERDICT.items() if verdict in some
    ]
    for colour, word in entries:
        found.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{FONT}" height="{FONT}" fill="{css(colour)}"/>'
        )
        found.append(_text(word, x + FONT + 3.0, y + 0.8 * FONT))
        x += FONT + 10.0 + LETTER * len(word)
    return "".join(found)


def _framed(parts: Sequence[str], width: float, height: float) -> str:
    return (
        f'<svg data-of="matrix" viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        'aria-label="matrix of clearances" style="display:block;margin:.5em auto;width:94%;'
        f'font-family:sans-serif">{"".join(parts)}</svg>'
    )
