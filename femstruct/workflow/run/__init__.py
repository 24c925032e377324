"""A study from its cases to its files: run, watched, with what it took."""
