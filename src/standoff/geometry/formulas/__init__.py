"""Surfaces and curves from formulas: read safely, differentiated, compiled, bounded."""

from standoff.errors import FormulaError
from standoff.geometry.formulas.curve import FormulaCurve
from standoff.geometry.formulas.surface import FormulaSurface

__all__ = ["FormulaCurve", "FormulaError", "FormulaSurface"]
