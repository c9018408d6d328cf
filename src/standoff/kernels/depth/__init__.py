"""Where the bodies meet: the depth by direction, its descent and the search of all directions."""
