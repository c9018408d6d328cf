"""Volume, first and second moments of a body as integrals over its boundary, with a bound.

`flux` defines what is integrated, `cells` how; `faces`, `directions` and `skin` cut the boundary
into cells, each a rectangle of two parameters: faces by Green's theorem, ellipsoidal faces by their
directions from the centre, and what a swept ball adds along edges and at vertices.
"""
