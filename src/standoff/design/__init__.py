"""Bodies as functions of named parameters, and how distances change with these: ``so.Design``."""

from standoff.design.design import Design
from standoff.design.shape_gradient import ShapeGradient, shape_gradient

__all__ = ["Design", "ShapeGradient", "shape_gradient"]
