"""Bulk data files of Nastran: cards, what they state, and the tables of those that make nothing."""
