"""Meshes of triangles: read and checked, as bodies where they are convex, as hulls or convex pieces
where that is asked for by name; what those add and lose is measured."""
