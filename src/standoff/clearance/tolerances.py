"""The tolerance of a verdict, with its unit and reason."""

from __future__ import annotations

from typing import Final

TOUCHING_PART: Final = 1e-9
"""Of the larger body's size: a gap or a depth up to this, beside the bodies' own slack, counts as
touching. Placements written with nine digits meet no better, and an answer's own error, some 1e-14
of the size, is far below it."""

SHOWN_ABOVE: Final = 1e-9
"""Relative: a lower bound may be shown as a rounder number that is so much above it. The answers'
own error leaves bounds of 0.04 at 0.04 less 1e-14, which nobody wants to read as 0.0399999."""
