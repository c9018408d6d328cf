"""Minimum distance tracking: trackers, answers, events, recordings, and gains."""
