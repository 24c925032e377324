"""What was measured on a structure, and how it fits a model."""
