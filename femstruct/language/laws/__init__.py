"""The contact laws of a study file: a module each, found by `registry`."""
