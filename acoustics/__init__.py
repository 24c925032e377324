"""The room and what is heard in it."""
