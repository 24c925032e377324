"""Input files of Abaqus and CalculiX: keywords, what they state, and the tables of those that make nothing."""
