"""Families of random pairs: every body twice, as an oracle's shape and as the library's own."""
