"""The kinds of parts a model file can have: a module each, found by `known_parts`."""
