"""Write `probe.pair`, a box and a ball, for `probe.c`."""

import standoff as so
from standoff.c_interface import save_pair

box = so.shapes.box(0.08, 0.06, 0.04)  # m
ball = so.shapes.sphere(0.005)

save_pair("probe.pair", so.Tracker(box, ball, dt=1e-3))
