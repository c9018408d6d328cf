"""What goes in and out of a frame as flat arrays, and the same by name."""
