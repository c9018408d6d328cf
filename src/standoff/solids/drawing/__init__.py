"""Pictures of solids that need not be convex, and of the answers about them."""
