"""The kinds of contact laws a study file can have: a module each, found by `known_laws`."""
