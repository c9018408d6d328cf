"""Solids in space: their leaves and tree, and the proven distance of two of them."""
