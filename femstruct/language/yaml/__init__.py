"""What every file of the language goes through: reading, patches, what is written where, what is wrong with it."""
