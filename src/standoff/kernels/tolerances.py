"""Every tolerance of the kernels: its name, unit, value and reason.

Lengths are compared with the pair's scale: the sum of the diameters plus the distance.
"""

EPS = 2.220446049250313e-16

# Relative pivot of H in the metric of the tangents (dimensionless). Above it the plain factor is
# the paper's law; below it the pair is nearly parallel and H is decomposed.
PIVOT = 1e-10
# Squares of tangents (length² per parameter²) below which an entry of H is kept as it is, and not
# rounded to eps, which is 2e-4 of this: Newton's method loses no step to it.
SHORT_TANGENT = 2.0**-40
# Roundings (eps) that a pivot may have lost, times what the elimination has multiplied them by.
PIVOT_ROUNDINGS = 64.0

# Pivots all above LEAN (relative, in the same metric) pass that rule: no l² is then more than
# 1 / LEAN, and PIVOT_ROUNDINGS eps (1 + 3 / LEAN) is 4e-8, PIVOT less.
LEAN = 1e-6

# Eigenvalues below -NEGATIVE take their magnitude (dimensionless, relative to the largest).
NEGATIVE = 1e-10

# A component of dR along a unit tangent below GRADIENT_NOISE eps scale (length) is the roundoff of
# dR, not a slope.
GRADIENT_NOISE = 16.0

# A descent is at rest where |g| (length) is below AT_REST eps scale: a few roundings of dR. Less
# than GRADIENT_NOISE, as a direction that is not flat can still use the digits between.
AT_REST = 4.0

# Longest step along a direction without curvature, in scales. A flat direction with a slope is
# walked to the boundary of its face, which is never farther than one diameter.
REACH = 4.0

# Directions of H above STIFF of its largest eigenvalue (dimensionless) are stiff: the walls of a
# valley, to whose floor a long step along it is brought back, in VALLEY_STEPS Newton steps.
STIFF = 1e-3
VALLEY_STEPS = 2

# A diagonal of the whitened H above SHARP (dimensionless: the distance over a radius of curvature)
# is scaled to 1 before the rank rule: across a crease it has no bound.
SHARP = 1e4

# Armijo's sufficient decrease (dimensionless): small, as Newton steps are nearly always right.
ARMIJO = 1e-4
MAX_HALVINGS = 30

# Energy noise, in eps scale |dR| (length²): a rise below it is roundoff, not a rise.
ENERGY_NOISE = 8.0

# Least slope (dimensionless: a sine of an angle) that releases a feature; SLOPE_NOISE eps
# scale/d is added, the roundoff of the direction of dR.
SLOPE = 1e-10
SLOPE_NOISE = 8.0

# A pcurve hit may lie this far (radians or parameter units) outside its range: at a corner the
# line must not slip between two edges.
PCURVE_OVERLAP = 1e-12
# Of the spread of a Bezier curve's points: a line so far off their hull meets neither the curve nor
# what `PCURVE_OVERLAP` adds to it at a degree of at most 9.
HULL_SPARE = 1e-9

# A point known no better than this (parameter units, relative) may lie outside by roundoff.
PARAMETER_NOISE = 1e-14
# Parameters so many times those of a face (dimensionless) are not on it: what they are known to is
# more than the face is wide.
FAR_OUT = 1e6
# Crossings of a ray this near to each other (relative) are one: a face without area has two.
SAME_CROSSING = 1e-12
# How far (parameter units) along a tangent a curve stays within PARAMETER_NOISE of it: a line that
# starts on a curve and touches it this near touches it at its start.
TOUCH_WIDTH = 1e-6
# A conic is looked at more closely where a line cuts into it by less than this part of it
# (relative).
NEAR_TANGENT = 1e-8
# Roundings (eps of its ends' magnitudes) below which a root's bracket is a point.
BRACKET_ROUNDINGS = 4.0

# Rays tried to tell inside from outside: one suffices but where it grazes a corner.
RAYS = 6
# Where on a boundary curve a ray is aimed (part of its range, dimensionless): the first, and how
# much farther each next. All RAYS stay off the ends, no two are the same place, and none is a half,
# third or quarter, where patches have their corners and symmetric faces their symmetry.
AIM_FIRST = 0.2371
AIM_STEP = 0.1113
# A ray with a smaller sine to the curve that it is aimed at is not cast: its crossings would be
# ends of curves.
ALONG_AIM = 1e-9
# Nor is one that is aimed at less of a curve than this part of its way there (dimensionless): it
# may pass through a gap between curves that meet but for a file's tolerance.
SLIVER_AIM = 1e-6

# An atlas's chart is left when |u| or |v| passes RECHART (dimensionless, gnomonic).
RECHART = 1.2

# A point of a body this far (in sizes) in front of a plane at one of its vertices is not roundoff.
FRONT = 1e-9

# Points of each coedge, and of a grid over the loop's bounds, among which the middle of a face is
# looked for; halvings of a side of the rectangle about it: to 1e-6 of the face's parameters.
INNER_SAMPLES = 8
INNER_GRID = 9
INNER_HALVINGS = 20

# Corrections (steps) that the smooth frame makes before it leaves a frame to the general one: the
# first ends a frame that was predicted by twists, the second most others.
SMOOTH_CORRECTIONS = 3
# Evaluations of both surfaces that a smooth cold query makes before it leaves a row to the general
# one. Most take six; those that go on in other charts, or halve a step as near contact, take more.
SMOOTH_LOOKS = 24
# It halves a step from where it went on in another chart so often, to stay in that.
STAYING = 4

# Surfaces closer than TOUCHING scales, with no positive lower bound, touch or overlap.
TOUCHING = 1e-13

# Newton steps whose gain in E is below its noise: at first MAX_POLISH are free, then each must
# bring |g| below POLISH_RATIO of the last to be worth another.
MAX_POLISH = 2
POLISH_RATIO = 0.5
# Beside a crease so many are free while the slope is above SLOPE: each brings the parameter a few
# orders of magnitude nearer.
SHARP_POLISH = 60

# Releases of one descent that may fail to lower E before it ends where it is.
MAX_STALLS = 3

# Bound on iterations of one descent and on passes of release: far above what was ever seen.
MAX_ITERATIONS = 400

# A tangent shorter than COLLAPSED scales has collapsed to a point (a cone's apex): the
# direction is frozen.
COLLAPSED = 1e-13

# Roundings (eps times the size) of a tangent that is summed from control points or from a formula.
NORMAL_NOISE = 16.0
# Most that this may take from a bound, in scales, and the answer still be called certified: a
# witness point nearer to a collapsed side than some 1e-8 of the size.
BLUR = 1e-6

# Rows of a rotation matrix may miss being orthonormal by this (dimensionless): what a rotation
# written with ten digits keeps.
ROTATION = 1e-9
# Below this angle (radians) series replace quotients that lose their digits: the first term left
# out is smaller than eps.
SMALL_ANGLE = 1e-4

# Largest gap (relative to the pair's size) with which a start counts as found: far below any
# far-side minimum's, however loose the tracker's tolerance is.
START_GAP = 1e-6

# Distance (in scales) below which an uncertified answer is polished in the contact-regular form:
# above it H is regular to PIVOT and the direction of dR is good to 1e-12.
NEAR_CONTACT = 1e-3
# Newton steps of that polish: it starts near its root and converges quadratically.
CONTACT_STEPS = 12

# Positions (length) must stay below this: squares of distances must not overflow. What Python reads
# number by number (checks.numbers.GREATEST) stays below it by far.
FARTHEST = 1e100
# Entries of R (dimensionless): a planar body's pose may be tilted by this, the roundoff of
# composing rotations.
PLANE_TILT = 1e-12
# Parameters that a frame of the paper's law changes by more than this have overflowed: fourth
# powers of them must not, and no patch is so wide (parameter units; on a half-space lengths).
LONGEST_CHANGE = 1e50
# How far (in spans) from the other body's foot a witness point on a half-space may go: the nearest
# point is under the body, and a law that has left it so far behind would only run away.
FOOT_REACH = 4.0

# Off a crease the curvature falls from infinity: the first parameter inside is sought between
# CREASE_FIRST and CREASE_LAST (gnomonic, dimensionless) in CREASE_STEPS halvings of its logarithm.
CREASE_FIRST = 1e-110
CREASE_LAST = 0.5
CREASE_STEPS = 30
# |u| and |v| are kept from 0 by this where an exponent is below 2 (dimensionless): powers of it
# stay finite, and it is far below any parameter that matters.
CREASE_FLOOR = 1e-120

# Directions tried around an apex or in a wide sector, before refinement.
FAN_SCAN = 24
# Golden-section steps: they shrink the bracket by 1e-12, the fan's own roundoff (radians).
FAN_REFINE = 60

# Lengths of the certificate carry a few roundings each; the bound is lowered by this many eps
# of the largest coordinate met, so that it stays a bound in floating point.
BOUND_ROUNDINGS = 16.0
# Witness points nearer than this (length) coincide: the squares of such lengths underflow.
COINCIDENT = 1e-140
# A vector square to an edge is made a unit vector where the square of its length (dimensionless: a
# unit vector's part) exceeds FLAT_PART: at most 1.4 times its roundoff is then along the edge.
FLAT_PART = 0.5

# Unit normals that are opposite up to this (the sine between them): from there on their roundoff
# hides on which side of them an edge's other normals lie.
OPPOSITE = 64.0 * EPS

# How strongly a restart's direction is mixed with those before it, a start (dimensionless).
MIXING = 0.3
# A length in the place of 0 where a direction is divided by it: what is 0 stays 0.
LEAST_DIVISOR = 1e-300

# The edge's point closest to a Voronoi test's point is bracketed between samples (convex arcs
# have one or two minima), then refined: bisection alone halves 2/16 of the edge to roundoff.
CLOSEST_SAMPLES = 16
CLOSEST_STEPS = 60
# Voronoi tests of one frame: a point may cross a face, an edge and a vertex of each body.
MAX_VORONOI_PASSES = 8

# In contact the pair is shifted out along its normal until it stands this far apart (in contact
# scales: both sizes and radii): H is regular there, and a greater gap would slow the descent.
SHIFTED_GAP = 0.05
# The least such gap: still far above START_GAP, by which far-side minima are recognised.
LEAST_GAP = 1e-5
# Steps of the descent of s(n): each lowers the depth; Newton's method ends it, mostly at once.
MAX_SHIFTS = 40
# How far, in steps, the next one may start ahead at corners.
MAX_LEAP = 16.0
# How many times less far Newton's step of s(n) may go after one that went too far.
LESS_REACH = 8.0
# Steps after which the pair moves in, the gap less by MAX_LEAP.
MOVE_IN = 6
# Newton's method is tried where a step of that descent has turned n by less than this (chord).
NEWTON_TURN = 0.3
# Residual (relative to the span) at which the contact-regular form is solved.
CONTACT_RESIDUAL = 1e-12
# Witness points in contact are at rest where they are off the normal by less than this (spans).
ALIGNED = 1e-9
# A flat direction's radius of curvature, in spans: as good as infinite.
FLAT_RADIUS = 1e12
# The part of the greater radius that the lesser one may be off by: 16 roundings.
ROUNDED_RADIUS = 3.6e-15
# A minimum whose least radius exceeds the depth by less than this (relative) may be none.
FOCAL_MARGIN = 1e-9
# Restarts of one query from which on its depths are sought without more of them: where witness
# points stay uncertified beside a thin body's collapsed side, none of them would help.
MAX_RESTARTS = 60
# How far (chord) the normal is turned off a stationary direction that is not a minimum.
NUDGE = 1e-3
# Steps in which s must have fallen below such a direction's, else that is the minimum.
SADDLE_SHIFTS = 6

# A depth is global when no direction's can be less by more than this part of it: near one minimum
# any direction within acos(1 - 1e-3) = 2.6 degrees is as good, so the polytope may be coarse.
DEPTH_PROOF = 1e-3
# Of the span: how far from its body a witness point may be. Roundoff is 16 eps of it at most
# (BOUND_ROUNDINGS); a point that counts as on a face by PARAMETER_NOISE may stand off its rim by
# that times the speed of the patch, which is then allowed to be a hundred spans.
OVERLAP_NOISE = 1e-12
# Steps of the proof of an overlap: each adds one of its points to the polytope.
OVERLAP_ROUNDS = 60
# Points that the search of all depths may add to its polytope: smooth pairs take 20 to 40, a ring
# of equal minima 100 to 300.
MAX_PROBES = 320
# Closer than this (in spans) a certified pair is polished in the contact-regular form: the
# direction between its witness points has lost more than six digits.
POLISHED = 1e-5
# Other minima that a proven search still tries, where one might be less by DEPTH_PROOF.
MAX_RIVALS = 8
# Other minima that a frame tries which goes on from the polytope of the last: more were before.
KEPT_RIVALS = 2
# Minima nearer to each other than this (chord) are one.
SAME_MINIMUM = 0.06
# A point is above a facet from here on (in contact scales): below it is coplanar.
COPLANAR = 1e-11
# Roundings (eps size) of a facet's plane, times how much its corners lean on its longest side.
FACET_ROUNDINGS = 4.0
# Half the length of the prism over a planar difference, in contact scales: no depth reaches it.
PRISM = 2.0

# Evaluations that steps with a deadline may spend on a start before another one is tried.
PATIENCE = 48.0
# Frames that were cut off in contact before the other method has its turn.
CUT_TURN = 8

# The integral part of a PI feedback commands at most the error of WOUND_UP spans (dimensionless:
# a cosine times the pair's span over it): of an error of one span, the greatest that there can be,
# it has then seen ten times what the gains make of it. More comes of a loop that diverges.
WOUND_UP = 10.0
# A frame whose parameters change by less, relative to patches of [0, 1], has gone out to a boundary
# and back: an edge's parameter and its pcurve give the point back but for a few roundings.
STANDSTILL = 1e-12

# The covariant solve's step is cut where its second-order part along the surface, which belongs to
# the parametrisation, exceeds this part of the first-order one: beside a collapsed side a small
# step turns the parameter along that side through all its range.
MOST_BENT = 0.5

# How many times a frame of the paper's law may hold a boundary and be solved again: both bodies
# from a face over an edge to a vertex.
MOST_HELD = 4

# Radians between level and tilted, where a flat contact of simulated bodies ends: far above the
# tilt of bodies at rest on each other (depth over size), far below that of one that has tipped.
FLAT_TILT = 0.02

# Radians: the most that a body turns between two looks at the springs of a flat contact, so that
# their difference is the slope of what they hold, which bends over FLAT_TILT.
SHARED_TURN = 0.1 * FLAT_TILT

# Jacobi's sweeps end where the squares off the diagonal sum to this part of those on it: by then a
# rotation changes no digit.
JACOBI_REST = 1e-36
# At most so many sweeps: 4 x 4 and 8 x 8 matrices take five to nine.
JACOBI_SWEEPS = 30

# Derivatives: least over greatest pivot of the contact-regular system, in lengths over the span and
# parameters by arc length. Below it fewer than seven digits of a derivative would be left.
SINGULAR_SYSTEM = 1e-9
# Residual of that system (dimensionless): Newton's method from here ends at the same optimum, and
# answers of a law that is still converging are recognised.
SETTLED = 1e-4
# Newton's corrections (steps) of a converged answer: two reach roundoff.
NEWTON_ROUNDS = 3
# A correction below this (dimensionless, scaled as the system) changes no digit that counts.
SETTLED_STEP = 1e-13
# A null direction of that system (of length 1, scaled as the system) with more than this of it in
# the normal: the witness points may be off by a fourth of the span along it, and the normal then
# has no nine digits. In flat contact this part is roundoff; between two cylinders it is the angle
# of their axes; at a focal point, where depths stop being least, it is the span over a radius.
TURNING_NORMAL = 3e-9
# Radians: a turn about an axis this near to square to (delta x n), delta a way that witness points
# may go, moves all of them alike along n. The gradient's component is then right to this part of
# the sizes, as much as what counts as parallel decides.
SQUARE_AXIS = 1e-9
# Radians, and of the body's size: a witness point this near another feature lies on both.
BESIDE_FEATURE = 1e-9
# Of the greater curvature, at least of 1 / the size: curvatures this near to each other are one.
# The same surface from both sides of a seam has 1e-12; a Hessian right to this has nine digits.
SAME_BEND = 1e-9
# Of the body's size: how far inside both faces, and off an edge's ends, curvatures are compared.
# Above the roundoff of a knot that the edge lies on; it changes a curvature by less than SAME_BEND.
BEND_INSIDE = 1e-11
# Of the span: cores that are nearer than this touch, and the normal may not be unique.
TOUCHING_CORES = 1e-12
# Radians: normals nearer to each other than this are one. Normal cones narrower than this, as of
# polytopes with thousands of facets, are not seen.
AROUND = 1e-3
# Of the size: widths of overlap (support sums) closer than this are the same. At AROUND one that
# grows with a radius of curvature of 2e-4 of the size differs by more.
SAME_WIDTH = 1e-10
# Chord of the unit sphere: a normal that roundoff may turn by more than this is useless. That is so
# beside a collapsed side, within about 1e-12 of the patch.
MOST_TURNED = 1e-3
# Part of the way from an edge's end to its middle: there a patch whose side has collapsed at the
# end has a plane, turned from that at the end by no more than the edge itself turns on the way.
OFF_COLLAPSED = 1e-3

# Ellipsoids in lanes: at most so many steps of Newton's method for the normal (ordinary ones need
# four, discs of one fiftieth of their width up to twenty), none by more than LONGEST_TURN (tangent
# of an angle). The last is one of less than TURNED, as the next would be its square.
LANE_TURNS = 20
LONGEST_TURN = 0.5
TURNED = 1e-5
# A step that does not raise the value of the support functions is tried again, SHORTENED; NO_GAIN
# (relative to the ellipsoids' heights) is the roundoff of that value.
SHORTENED = 0.25
NO_GAIN = 1e-15
