"""What a user gives, checked before anything is computed with it."""
