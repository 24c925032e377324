"""What meets what: bodies, sources, feet, and what measured pulses and rebounds say of them."""
