"""Two features held: pair system, solve, descent, switching, lower bound, global start."""
