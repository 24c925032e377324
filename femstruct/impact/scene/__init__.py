"""Bodies, sources, feet, and what measured pulses and rebounds say of them."""
