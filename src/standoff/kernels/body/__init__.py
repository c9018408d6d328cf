"""One body: where its numbers stand, jets of its surfaces and curves, features, boundaries."""
