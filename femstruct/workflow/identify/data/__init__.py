"""What was measured, a kind a file: what it needs of a computation, its residuals, and their derivatives."""
