"""Hulls of points: polyhedra whose faces, edges and vertices are arrays, proven and packed whole.

Qhull finds the facets (``qhull``); those of one plane become one face (``merging``, ``outlines``);
their planes, edges and angles are computed at once (``polyhedron``, ``joints``); every given point
is then compared with every plane (``heights``), which is all that a body's certificate needs, and
the two arrays are written (``packed``). `build` calls them in turn. The parts as objects are made
when somebody asks for one (``made_parts``).
"""
