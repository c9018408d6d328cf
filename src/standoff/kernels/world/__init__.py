"""The broad phase of a world: where its pieces are, which may be near each other, and bounds."""
