"""Sewing: patches joined along their sides into the boundary of a body.

patches.py cuts them, sides.py has their isolines, corners.py the vertices and T-junctions,
correspondence.py makes their trimming curves, shell.py checks that they close one shell and finds
which side is outside, and sew.py finds which sides lie along which and makes the parts of the body.
"""

from standoff.bodies.sewing.sew import Sewn, sew

__all__ = ["Sewn", "sew"]
