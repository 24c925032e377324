"""Reasons to trust results less, by their subject."""
