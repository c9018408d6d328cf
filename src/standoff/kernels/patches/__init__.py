"""Of convex bodies: a few pairs of points that span where the gap is hardly wider than it is."""
