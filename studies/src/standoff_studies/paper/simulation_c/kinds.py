"""Kinds of modes of two planar bodies: their names, and their colours in pictures."""

from __future__ import annotations

from matplotlib.artist import Artist

from standoff.tracking import Feature
from standoff_studies.paper.drawing import short_name
from standoff_studies.paper.keys import key_fill

KINDS = ("vertex–vertex", "vertex–curve", "curve–curve")
"""What a mode may be, by its number of parameters: 0, 1 or 2."""

FILLS = ("#E9A63A", "#FFFFFF", "#D3E8F6")
"""Background of each kind of mode: orange, white, pale blue; in grey print medium, white, light."""


def kind_of(feature_a: Feature, feature_b: Feature) -> int:
    """Return the number of a mode's kind: how many parameters it has."""
    return (feature_a.kind, feature_b.kind).count("edge")


def mode_name(feature_a: Feature, feature_b: Feature) -> str:
    """Return the name of a mode: A's feature, then B's."""
    return f"{short_name(feature_a)}–{short_name(feature_b)}"


def show_kinds() -> list[Artist]:
    """Return the entries of a key that explain the fills."""
    pairs = zip(KINDS, FILLS, strict=True)
    return [key_fill(kind, fill, edgecolor="black", linewidth=0.8) for kind, fill in pairs]
