"""What a sweep is of: a pair of bodies, a world or a robot, each asked for a row's distance."""
