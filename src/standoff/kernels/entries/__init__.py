"""What Python calls; each entry is compiled by itself."""
