"""The kinds of parts a structure is made of, one file each; `femstruct.model.part` says what a kind has to offer."""
