"""Levels and ratings: bands, weighting, decay, single numbers of the standards."""
