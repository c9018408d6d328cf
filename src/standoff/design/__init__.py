"""Bodies as functions of named parameters, and how distances change with these: ``so.Design``."""

from standoff.design.design import Design
from standoff.design.shape_gradient import ShapeGradient, ShapeGradientArrays, shape_gradient

__all__ = ["Design", "ShapeGradient", "ShapeGradientArrays", "shape_gradient"]
