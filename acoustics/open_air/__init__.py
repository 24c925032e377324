"""Open air: the half space beside a surface, radiated power and energy, directivity, struck spheres."""
