"""Pictures of bodies by Matplotlib: one with all its features, or two with their witness points."""
