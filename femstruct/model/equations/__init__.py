"""Constraints: one kind a file, each a noun that becomes equations between places."""
