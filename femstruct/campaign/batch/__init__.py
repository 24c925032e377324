"""Rows of many samples at once, by the batch engine."""
