"""Where the numbers of a kept polytope stand: an optional block behind a state.

A frame in penetration that follows one keeps it (``depth.kept_polytope``). All else leaves none.
"""

N_VERTICES, N_FACETS = 0, 1  # how many; no vertices: no polytope
FIRST_VERTEX = 2
# Of each vertex the points of A and of B, in their own frames.
KEPT_REALS = 6
# Smooth pairs have 30 to 50 vertices. A closed surface of triangles has 2 V - 4 of them.
KEPT_POINTS = 64
KEPT_FACETS = 2 * KEPT_POINTS - 4
FIRST_FACET = FIRST_VERTEX + KEPT_REALS * KEPT_POINTS  # a facet's three vertices as one number
N_POLYTOPE = FIRST_FACET + KEPT_FACETS
