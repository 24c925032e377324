"""Reasons to believe results less, by what they are of."""
