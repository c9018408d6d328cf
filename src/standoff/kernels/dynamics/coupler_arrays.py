"""Where everything of a virtual coupler is: its numbers, its state, and a device's reading."""

# Why a coupler let go.
(
    NO_FAULT,
    MISSING,
    LATE,
    NON_FINITE,
    MALFORMED,
    OUT_OF_ORDER,
    INVALID,
    HALF_TURN,
    TOOL,
) = range(9)

# Radian between handle and tool, at which the coupler lets go. At pi the shorter way round changes
# its side, and the torque would turn round. To cross what is left from one tick to the next, 0.28
# rad, a hand would have to turn at 280 rad/s at 1 kHz; it reaches 20.
LET_GO_ANGLE = 3.0

# A coupler: spring and damper, limits, times, the device's own damping, the passivity controller,
# and how many wrenches on the handle are remembered until their work is seen.
Q_STIFFNESS, Q_DAMPING, Q_TURN_STIFFNESS, Q_TURN_DAMPING = range(4)
Q_FORCE, Q_TORQUE, Q_FORCE_RATE, Q_TORQUE_RATE = range(4, 8)
Q_ENGAGE, Q_AGE, Q_LAG, Q_SLOW = range(8, 12)
Q_FRICTION, Q_TURN_FRICTION = range(12, 14)
Q_CONTROLLED, Q_TOLERANCE, Q_AT_HANDLE, Q_TURN_AT_HANDLE, Q_AT_TOOL, Q_TURN_AT_TOOL = range(14, 20)
Q_HELD = 20
N_COUPLER = 21

# Its counts, in the order of ``simulation.coupler_state.CouplerCounts``.
(
    K_TICKS,
    K_ENGAGED,
    K_REPEATED,
    K_SKIPPED,
    K_FORCE_LIMITS,
    K_TORQUE_LIMITS,
    K_FORCE_RISES,
    K_TORQUE_RISES,
    K_CONTROLLED,
    K_CONTROL_LIMITS,
    K_SLOW,
    K_FAULTS,
) = range(12)
N_COUNTS = 12

# Its state. Energies: into it at the handle and at the tool, taken by the device's own damping, the
# least of their sum; lost in its damper. Motions are a pose (12) and a twist (6), world axes.
# Last come the wrenches on the handle whose work is still to be seen, oldest first.
C_ENGAGED, C_FAULT, C_RAMP, C_CLOCK, C_TIME, C_SEQUENCE, C_SEEN = range(7)
C_DEVICE, C_GIVEN, C_RUBBED, C_LEAST, C_DAMPED, C_STORED = range(7, 13)
C_COUNTS = 13
C_HANDLE = C_COUNTS + N_COUNTS
C_TOOL = C_HANDLE + 18
C_ON_DEVICE = C_TOOL + 18
C_ON_TOOL = C_ON_DEVICE + 6
C_HELD = C_ON_TOOL + 6

# A reading: what its driver found wrong with it, its stamp, whether it has a twist, pose and twist.
G_FAULT, G_TIME, G_SEQUENCE, G_TWIST, G_MOTION = range(5)
N_READING = G_MOTION + 18
