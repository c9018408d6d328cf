"""The nearest points of two leaves over boxes of parameters, by Newton's method within bounds; and
the potential through them."""

from math import atan2, cos, sin

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, cross, dot, norm, scale, sub, unit
from standoff.kernels.compiler.decorators import kernel, reals_on_stack, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import (
    ZERO,
    leaf_ints,
    leaf_jet,
    outward_normal,
)
from standoff.kernels.solids.spatial_tolerances import (
    FIRST_DAMPING,
    LEAST_GAIN,
    LEAST_MOVE,
    LEAST_PIVOT,
    PARALLEL_TANGENTS,
    UNDAMPED_STEP,
)
from standoff.kernels.solids.torus_potential import TORUS_THROUGH, Potential

MOST_STEPS = 40
# Where a feature has no extent in a direction, any curvature up to this over its span serves.
SHARP_BEND = 50.0


@kernel
def fill_system(ja, jb, g, H):
    """Gradient (4) and second derivatives (4 x 4) of |y - x|² / 2."""
    delta = sub(jb[0], ja[0])
    for i in range(2):
        g[i] = -dot(delta, ja[1 + i])
        g[2 + i] = dot(delta, jb[1 + i])
        for j in range(2):
            H[4 * i + j] = dot(ja[1 + i], ja[1 + j]) - dot(delta, ja[3 + i + j])
            H[4 * (2 + i) + 2 + j] = dot(jb[1 + i], jb[1 + j]) + dot(delta, jb[3 + i + j])
            H[4 * i + 2 + j] = -dot(ja[1 + i], jb[1 + j])
            H[4 * (2 + j) + i] = H[4 * i + 2 + j]


@kernel
def solved(H, g, free, damping, scales, out):
    """Solve (H + damping D) out = -g over the free ones by Cholesky; False: not positive."""
    m = reals_on_stack(16)
    for i in range(4):
        for j in range(4):
            both = free[i] > 0.0 and free[j] > 0.0
            m[4 * i + j] = H[4 * i + j] if both else 0.0
        m[5 * i] = m[5 * i] + damping * scales[i] if free[i] > 0.0 else 1.0
    for i in range(4):
        for j in range(i + 1):
            s = m[4 * i + j]
            for k in range(j):
                s -= m[4 * i + k] * m[4 * j + k]
            if i == j:
                if s <= LEAST_PIVOT * scales[i] and free[i] > 0.0:
                    return False
                m[5 * i] = sqrt(s)
            else:
                m[4 * i + j] = s / m[5 * j]
    for i in range(4):
        s = -g[i] if free[i] > 0.0 else 0.0
        for k in range(i):
            s -= m[4 * i + k] * out[k]
        out[i] = s / m[5 * i]
    for i in range(3, -1, -1):
        s = out[i]
        for k in range(i + 1, 4):
            s -= m[4 * k + i] * out[k]
        out[i] = s / m[5 * i]
    return True


@kernel
def jets_at(a, leaf_a, b, leaf_b, q):
    return leaf_jet(a, leaf_a, q[0], q[1]), leaf_jet(b, leaf_b, q[2], q[3])


@kernel
def half_square(ja, jb):
    delta = sub(jb[0], ja[0])
    return 0.5 * dot(delta, delta)


@shared
def nearest(a, leaf_a, box_a, b, leaf_b, box_b, start, counts):
    """(parameters (4), distance) of a local minimum of the distance over two boxes."""
    lo = (box_a.u0, box_a.v0, box_b.u0, box_b.v0)
    hi = (box_a.u1, box_a.v1, box_b.u1, box_b.v1)
    q, trial, step = reals_on_stack(4), reals_on_stack(4), reals_on_stack(4)
    g, H, free, scales = reals_on_stack(4), reals_on_stack(16), reals_on_stack(4), reals_on_stack(4)
    for i in range(4):
        q[i] = min(max(start[i], lo[i]), hi[i])
    ja, jb = jets_at(a, leaf_a, b, leaf_b, q)
    energy = half_square(ja, jb)
    damping = 0.0
    for _ in range(MOST_STEPS):
        counts[1] += 1
        fill_system(ja, jb, g, H)
        for i in range(4):
            j = ja[1 + i] if i < 2 else jb[i - 1]
            scales[i] = dot(j, j)
            held = (q[i] <= lo[i] and g[i] >= 0.0) or (q[i] >= hi[i] and g[i] <= 0.0)
            free[i] = 0.0 if held or scales[i] == 0.0 or hi[i] <= lo[i] else 1.0
        taken, moved = False, 0.0
        while damping < 1e10:
            if solved(H, g, free, damping, scales, step):
                moved = 0.0
                for i in range(4):
                    at = q[i] + (step[i] if free[i] > 0.0 else 0.0)
                    trial[i] = min(max(at, lo[i]), hi[i])
                    moved += abs(trial[i] - q[i]) * sqrt(scales[i])
                ka, kb = jets_at(a, leaf_a, b, leaf_b, trial)
                after = half_square(ka, kb)
                if after < energy:
                    taken = True
                    break
                if moved * moved <= LEAST_MOVE * (energy + moved):
                    break
            damping = max(10.0 * damping, FIRST_DAMPING)
        if not taken:
            break
        small = energy - after <= LEAST_GAIN * energy
        for i in range(4):
            q[i] = trial[i]
        ja, jb, energy = ka, kb, after
        damping = 0.1 * damping if damping > UNDAMPED_STEP else 0.0
        if small or energy == 0.0:
            break
    return (q[0], q[1], q[2], q[3]), sqrt(2.0 * energy)


@kernel
def direction(a, leaf_a, ja, b, leaf_b, jb, least):
    """The unit direction from A to B at a pair of points."""
    delta = sub(jb[0], ja[0])
    length = norm(delta)
    if length > least:
        return scale(1.0 / length, delta)
    if a.own[leaf_ints(a, leaf_a) + S.DIM] == 2:
        return outward_normal(a, leaf_a, ja)
    if b.own[leaf_ints(b, leaf_b) + S.DIM] == 2:
        return scale(-1.0, outward_normal(b, leaf_b, jb))
    n = unit(cross(ja[1], jb[1]))
    return n if dot(n, delta) >= 0.0 else scale(-1.0, n)


@kernel
def across(n):
    """(e1, e2), a right-handed frame with n."""
    if abs(n[0]) <= abs(n[1]) and abs(n[0]) <= abs(n[2]):
        e = (1.0, 0.0, 0.0)
    elif abs(n[1]) <= abs(n[2]):
        e = (0.0, 1.0, 0.0)
    else:
        e = (0.0, 0.0, 1.0)
    e1 = unit(cross(n, e))
    return e1, cross(n, e1)


@kernel
def shape(side, leaf, jet, toward, frame, held, span):
    """(S11, S12, S22) of a leaf on two directions: positive where it bulges along `toward`.

    held: (mu_u, mu_v), extra second derivatives of a parameter that is held at the side of a box.
    """
    e1, e2 = frame
    dim = side.own[leaf_ints(side, leaf) + S.DIM]
    sharp = SHARP_BEND / span
    if dim == 0:
        return sharp, 0.0, sharp
    a, c = dot(jet[1], e1), dot(jet[1], e2)
    if dim == 1:
        square = a * a + c * c
        if square <= 0.0:
            return sharp, 0.0, sharp
        k = (-dot(toward, jet[3]) + held[0]) / square
        a2, ac, c2 = a * a / square, a * c / square, c * c / square
        return k * a2 + sharp * c2, (k - sharp) * ac, k * c2 + sharp * a2
    b, d = dot(jet[2], e1), dot(jet[2], e2)
    det = a * d - b * c
    if abs(det) <= PARALLEL_TANGENTS * (a * a + b * b + c * c + d * d):
        return sharp, 0.0, sharp
    uu, uv, vv = (
        -dot(toward, jet[3]) + held[0],
        -dot(toward, jet[4]),
        -dot(toward, jet[5]) + held[1],
    )
    # rows of the inverse of [[a, b], [c, d]]: parameters per length along e1 and e2
    p, q, r, s = d / det, -b / det, -c / det, a / det
    s11 = uu * p * p + 2.0 * uv * p * r + vv * r * r
    s12 = uu * p * q + uv * (p * s + q * r) + vv * r * s
    s22 = uu * q * q + 2.0 * uv * q * s + vv * s * s
    return s11, s12, s22


@kernel
def principal(S3):
    """(l1, l2, c, s): eigenvalues of (S11, S12, S22), and the first one's direction (c, s)."""
    a, b, d = S3
    angle = 0.5 * atan2(2.0 * b, a - d)
    c, s = cos(angle), sin(angle)
    return (
        a * c * c + 2.0 * b * c * s + d * s * s,
        a * s * s - 2.0 * b * c * s + d * c * c,
        c,
        s,
    )


@kernel
def matrix_of(l1, l2, c, s):
    return l1 * c * c + l2 * s * s, (l1 - l2) * c * s, l1 * s * s + l2 * c * c


@kernel
def carried(S3, d):
    """S (1 + d S / 2)⁻¹."""
    l1, l2, c, s = principal(S3)
    one, other = 1.0 + 0.5 * d * l1, 1.0 + 0.5 * d * l2
    l1 = l1 / one if one > 0.1 else l1
    l2 = l2 / other if other > 0.1 else l2
    return matrix_of(l1, l2, c, s)


@kernel
def torus_between(x, y, n, frame, sa, sb, limit):
    """The torus potential half way, whose curvatures lie between both shapes."""
    e1, e2 = frame
    d = dot(sub(y, x), n)
    sa, sb = carried(sa, max(d, 0.0)), carried(sb, max(d, 0.0))
    l1, l2, c, s = principal((sa[0] + sb[0], sa[1] + sb[1], sa[2] + sb[2]))
    D = matrix_of(min(0.5 * l1, limit), min(0.5 * l2, limit), c, s)
    size_a = abs(sa[0]) + abs(sa[1]) + abs(sa[2])
    if size_a <= abs(sb[0]) + abs(sb[1]) + abs(sb[2]):
        T = (sa[0] - D[0], sa[1] - D[1], sa[2] - D[2])
    else:
        T = (D[0] - sb[0], D[1] - sb[1], D[2] - sb[2])
    k1, k2, c, s = principal(T)
    first = add(scale(c, e1), scale(s, e2))
    other = add(scale(-s, e1), scale(c, e2))
    return Potential(TORUS_THROUGH, scale(0.5, add(x, y)), first, other, n, k1, k2, 1.0)


@kernel
def plane_between(x, y, n):
    return Potential(TORUS_THROUGH, scale(0.5, add(x, y)), ZERO, ZERO, n, 0.0, 0.0, 1.0)
