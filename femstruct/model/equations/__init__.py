"""Equations between places: constraints, one kind a file, each a noun that becomes some; supports and joints."""
