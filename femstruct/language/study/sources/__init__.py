"""Sources as they are written: those of standards, and those that were measured."""
