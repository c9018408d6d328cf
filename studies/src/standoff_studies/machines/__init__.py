"""Parts of machines: threads, gears, and a key with its lock."""
