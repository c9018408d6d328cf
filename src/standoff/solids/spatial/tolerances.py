"""Tolerances of solids in space."""

from typing import Final

DERIVATIVE_INFLATION: Final = 1e-12
"""Relative: for the rounding of norms that bound derivatives, some tens of operations."""
ROUND_KIND: Final = 1e-14
"""Relative: columns of a map that differ by less make a round cylinder, cone, sphere or torus; the
surface is then from the round one by less than a rounding of its size."""
PROOF_TOLERANCE: Final = 1e-10
"""Of the sizes of both solids: how far below the distance the proven bound may be."""
PROOF_ROUNDING: Final = 1e-14
"""Of the sizes and the distance: about fifty roundings of double numbers, for a bound that is
computed without intervals at the time of a query."""
SMOOTH_JOIN: Final = 2e-7
"""Radians: faces that join smoothly may differ by this in their normals, twice SMOOTH_ANGLE."""
CONTINUUM_LENGTH: Final = 1e-3
"""Of the sizes: nearest pairs spread less than this are one."""
COLLAPSED_FRAME: Final = 1e-6
"""Part of a vector across another below which it gives no direction."""
BENDS_LESS: Final = 3e-3
"""Of its length: a continuum that bends less is a line; pairs within the tolerance of the distance
lie to both sides of it."""
NEAREST_ALONE: Final = 1e-300
"""Length: as `minima` it asks for the features of the nearest pairs and for no others."""
LEAST_LENGTH: Final = 1e-300
"""Length: keeps a quotient by a vanished vector finite."""
SIDE_ROUNDING: Final = 1.5e-14
"""Of a chart's greatest parameter, some sixty roundings: a trim that lies no further inside a
rectangle lies along its side."""
BOX_SPARE: Final = 2e-15
"""Of the coordinates: about eight roundings of a box's extents."""
SPOT_SPARE: Final = 1e-15
"""Of the coordinates: about four roundings of a point."""
NO_AXIS: Final = 1e-3
"""Length of a sum of unit vectors below which it gives no axis of a cone."""
CONE_ROUNDINGS: Final = 1e-12
"""Radians: added to a cone round several for the rounding of angles."""
LAST_CLIMB: Final = 1e-5
"""Of the size: the last step of the ascent to a ball inside both solids."""
CONTACT_REACH: Final = 0.02
"""Of the sizes of both solids: how deep an overlap is looked for place by place where no more is
asked."""
PARTED_SPARE: Final = 1e-3
"""Relative, of the depth: how much farther than it B is moved to see whether the solids are apart;
a distance is proven the faster the greater it is."""
HELD_WAY: Final = 2.0
"""Times the depth of the deepest place: of a way out that is shorter nothing is held all round."""
LOOKS: Final = (3e-2, 3e-3, 3e-4, 3e-5)
"""Of the size: steps from a common point of both boundaries among which one inside both is
sought."""
BALL_STEPS: Final = (1.0, 0.3, 0.1)
"""Of a place's depth: the same from its points, where no larger ball was found."""
BESIDE_KNOT: Final = 1e-9
"""Of a span: how far from a knot tangents and normals on its two sides are compared; they turn by
some radians over a span."""
TANGENT_ROUNDOFF: Final = 1e-14
"""Of a point's coordinates, over a span of parameters: what roundoff may change a tangent by there,
some 50 roundoffs."""
SAME_SPOT: Final = 1e-5
"""Of the size: nearest points of one solid nearer to each other than this are one."""
CUSP: Final = 1e-6
"""Radians: of a face's corner with a smaller angle between its edges it is not known whether the
face lies between them or all around."""
PIECE_END_SPARE: Final = 1e-12
"""Radians or parameters: how far an edge's end may be from that of its trimming curve."""
MASS_TOLERANCE: Final = 1e-9
"""Relative: of the volume and the area that are compared with the maker's."""
TURN_SPARE: Final = 1e-9
"""Radians: how far past a chart's rectangle a trimming curve's image a turn away is kept."""
BEND_SPARE: Final = 1e-12
"""Relative: for the rounding of a trimming curve's second derivative."""
COLLAPSED_SIDE: Final = 1e-9
"""Of the size: a side of a face's rectangle nearer to a vertex than this is collapsed to it."""
IN_CONTACT: Final = 1e-3
"""Sine of the angle between the normals at a place of contact: where boundaries are nearer than the
tolerance their normals differ by up to its root, 1e-5, and by more where they bend sharply. At
places where they cross it is far greater."""
ONE_AXIS: Final = 1e-12
"""Sine of the angle of two axes, and part of the size between them, below which they are one: a few
roundings of their coordinates."""
TURN_ROUNDING: Final = 1e-9
"""Sine and radians: for the rounding of computed normals, and of an axis that differs from another
by `ONE_AXIS`, in the turn of an edge."""
BESIDE_CONTACT: Final = 1e-6
"""Of the sizes: around a part of a boundary that the other one holds, how far one potential has to
be between both; far more than the tolerance, far less than a part."""
BESIDE_DEPTH: Final = 14.0
"""Times what potentials may be missed by: the same where one solid is pressed into the other. A way
along the sum of two slopes leads above both if each potential grows by 4 times as much on it, and
begins 2 times as much away."""
MEETING: Final = 1e-9
"""Of the size: two faces of one boundary that come nearer than this meet; what parts may miss each
other by (`JOIN_TOLERANCE`)."""
MEETING_SLACKS: Final = 4.0
"""Times the slack: the same where the boundary is not known better; both faces have it, on either
side of where they are joined."""
PROVEN_SHARE: Final = 0.5
"""Of the length below which faces meet: how much nearer they may be where they are proven apart."""
JOINT_PARTS: Final = 32
"""Parts of an edge: nearer to it than one is long, faces that it joins are not looked at."""
VERTEX_SHARE: Final = 1e-3
"""Of the shortest edge at a vertex: nearer to it, faces that it joins are not looked at."""
JOINT_ROOM: Final = 2.0
"""Of the length below which faces meet: they do so as near as this to what joins them, where they
leave it at 30 degrees or more."""
LEAST_ANGLE: Final = 1e-6
"""Sine of the angle of two faces below which they touch rather than cross."""
SHORT_WAY: Final = 4.0
"""Of the length below which faces meet: points of one face with a shorter way along it between them
are near to each other as neighbours."""
ALONG_SCREW: Final = 1e-3
"""Relative: where the normals of a face are across the velocities of a screw motion to this, it
moves the face along itself. It only decides whether a potential is tried."""
MANY_SCREWS: Final = 1e-2
"""Relative: where a second motion is as near as this, there is no telling which is meant."""
LEAST_TURN: Final = 1e-2
"""Of a motion whose turn and velocity, over the face's size, have the length 1: below this it is a
translation."""
OFF_THREAD: Final = 1e-2
"""Sine: a face whose normals are across the velocities of a thread's screw motion to this is one of
its crests or roots."""
