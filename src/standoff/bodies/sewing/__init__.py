"""Sewing: patches joined along their sides into the boundary of a body.

patches.py cuts them, sides.py has their isolines, corners.py the vertices and T-junctions,
matching.py finds which sides lie along which, correspondence.py makes their trimming curves,
shell.py checks that they close one shell and finds which side is outside, and sew.py makes the
parts of the body.
"""

from standoff.bodies.sewing.sew import Sewn, sew

__all__ = ["Sewn", "sew"]
