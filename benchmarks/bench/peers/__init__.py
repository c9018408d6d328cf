"""What other packages do of the same frames: one file a package."""
