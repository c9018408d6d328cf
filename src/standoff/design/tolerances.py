"""Tolerances of derivatives by design, each with its unit and its reason."""

DESIGN_STEP = 1e-3
"""Of a parameter, or of the body's size where it is NO_SCALE: the differences' step. With NODES
their truncation is 3e-14 of the fifth derivative, their roundoff some 2e-13 of the size over the
parameter."""
NO_SCALE = 1e-9
"""Of the body's size: a parameter below it is no scale of its step, which would be roundoff."""
UNBOUNDED_SIZE = 1.0
"""In place of the size of a half-space, which has none; its normal is a unit vector."""
ROUGH = 1e-3
"""Of a rate (or of the body's size over the parameter): differences of second and of fourth order
agree to 1e-6 of it where a boundary moves smoothly, and not at all where it jumps."""
OTHER_PLACE = 1e-6
"""Of a body's size: farther from the place that an answer names than this its witness point is of
another body. Solids tell witness points to 1e-9 of their size or better."""
