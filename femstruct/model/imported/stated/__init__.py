"""What mesh files state beside their cells: what of it no reader makes, and what no part of a structure uses."""
