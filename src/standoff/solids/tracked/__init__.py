"""Two solids that move: their distance kept from frame to frame."""
