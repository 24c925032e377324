"""What is recorded of a run: histories, their peaks, stresses, cycles."""
