"""Where two bodies meet: all pairs of witness points, and all directions of equal depth."""
