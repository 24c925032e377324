"""The kinds of rooms a study file can have: a module each, found by `known_rooms`."""
