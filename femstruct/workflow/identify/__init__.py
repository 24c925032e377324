"""Numbers of a study found from measured histories."""
