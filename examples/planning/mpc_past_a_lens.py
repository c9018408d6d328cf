"""Model predictive control with CasADi: a long body drives past a lens, turning as it goes.

The body is a unicycle in the plane, with a bounded speed and rate of turning. At every step Ipopt
plans a horizon with the exact gradients and Hessians of the distance, and the first control is
applied. Run it as `python mpc_past_a_lens.py`; it needs the extra `casadi`.
"""

import time

import casadi as ca
import numpy as np

import standoff as so
import standoff.casadi

BODY = so.shapes.ellipsoid(0.35, 0.12, 0.12)
OBSTACLE, PLACE = so.shapes.lens(0.6, 0.27), so.Pose.exp([0.0, np.pi / 2, 0.0], [1.4, -0.1, 0.0])
GOAL = np.array([2.8, 0.0])
HORIZON, STEP, STEPS = 10, 0.2, 16
CLEARANCE = 0.05
FASTEST, QUICKEST = 1.0, 1.5
"""Bounds of the speed and of the rate of turning [length/s, rad/s]."""


def moved(state, control):
    """(x, y, heading) after a step: on a circle, taken at the middle heading."""
    middle = state[2] + 0.5 * STEP * control[1]
    way = STEP * control[0]
    return state + ca.vertcat(way * ca.cos(middle), way * ca.sin(middle), STEP * control[1])


def pose(state):
    """The 4 x 4 matrix, an expression in MX."""
    c, s = ca.cos(state[2]), ca.sin(state[2])
    turn = ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
    place = ca.vertcat(state[0], state[1], 0)
    return ca.vertcat(ca.horzcat(turn, place), ca.DM([[0, 0, 0, 1]]))


def controller(hessian="exact"):
    """Ipopt on (controls, states) of a horizon; the present state is a parameter."""
    separation = standoff.casadi.distance(OBSTACLE, BODY)
    now = ca.MX.sym("now", 3)
    controls, states = ca.MX.sym("u", 2, HORIZON), ca.MX.sym("x", 3, HORIZON)
    cost, dynamics, clear, last = 0.0, [], [], now
    for k in range(HORIZON):
        state = states[:, k]
        dynamics.append(state - moved(last, controls[:, k]))
        clear.append(separation(ca.DM(PLACE.matrix), pose(state)) - CLEARANCE)
        cost += ca.sumsqr(state[:2] - GOAL) + 0.02 * state[2] ** 2
        cost += 0.02 * ca.sumsqr(controls[:, k])
        last = state
    problem = {
        "x": ca.vertcat(ca.vec(controls), ca.vec(states)),
        "p": now,
        "f": cost,
        "g": ca.vertcat(*dynamics, *clear),
    }
    options = {"ipopt.hessian_approximation": hessian, "ipopt.print_level": 0, "print_time": False}
    return ca.nlpsol("plan", "ipopt", problem, {**options, "ipopt.sb": "yes", "ipopt.tol": 1e-6})


def drive(hessian="exact", steps=STEPS):
    """States, least clearances, iterations and seconds of a run."""
    solver = controller(hessian)
    top = np.tile([FASTEST, QUICKEST], HORIZON)
    free = np.full(3 * HORIZON, np.inf)
    state, guess = np.zeros(3), np.zeros(5 * HORIZON)
    guess[2 * HORIZON + 1 :: 3] = 0.3  # to the left, past the saddle in the middle
    states, iterations, began = [state], [], time.perf_counter()
    for _ in range(steps):
        found = solver(
            x0=guess,
            p=state,
            lbx=np.concatenate([-top, -free]),
            ubx=np.concatenate([top, free]),
            lbg=0.0,
            ubg=np.concatenate([np.zeros(3 * HORIZON), np.full(HORIZON, np.inf)]),
        )
        told = solver.stats()
        assert told["success"], told["return_status"]
        iterations.append(told["iter_count"])
        guess = found["x"].full().ravel()
        state = np.array(moved(ca.DM(state), ca.DM(guess[:2]))).ravel()
        states.append(state)
    took = time.perf_counter() - began
    poses = np.array([so.Pose.exp([0, 0, x[2]], [x[0], x[1], 0.0]).matrix for x in states])
    kept = so.distances(OBSTACLE, BODY, PLACE.matrix, poses).lower_bound
    return np.array(states), kept, np.array(iterations), took


def main():
    drive(steps=1)  # loads the kernels: not what is measured
    for hessian in ("exact", "limited-memory"):
        states, kept, iterations, took = drive(hessian)
        print(
            f"Hessian {hessian}: {len(iterations)} plans, {iterations.sum()} iterations, "
            f"{1e3 * took / len(iterations):.0f} ms a plan; least distance {kept.min():.6f}, "
            f"{np.linalg.norm(states[-1][:2] - GOAL):.3f} from the goal"
        )


if __name__ == "__main__":
    main()
