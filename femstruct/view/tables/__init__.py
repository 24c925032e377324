"""Tables and lines a person reads in the terminal."""
