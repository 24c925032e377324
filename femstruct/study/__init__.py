"""The nouns of a study: what is asked (study) and what came of it (result)."""
