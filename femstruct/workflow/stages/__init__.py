"""The stages of a case, from the basis to the sound."""
