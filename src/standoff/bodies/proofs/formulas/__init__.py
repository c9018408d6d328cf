"""Exact algebra and interval bounds behind the proofs of formulas."""
