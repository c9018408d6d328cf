"""Convex bodies: topology, sewing, convexity proofs, packing, and ready-made shapes."""
