"""Findings on the losses of parts."""
