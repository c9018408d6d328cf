"""The paper, reproduced: its five simulations, every figure, its gains and its automata.

Patoglu and Gillespie, "Feedback Stabilized Minimum Distance Maintenance for Convex Parametric
Surfaces", IEEE Transactions on Robotics 2005. ``standoff paper`` writes it all.
"""
