"""A package outside femstruct that adds a kind of part, with an element of its own, and a contact law."""
