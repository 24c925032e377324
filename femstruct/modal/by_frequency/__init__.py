"""What of a structure depends on frequency: walls at edges, loss factors, each mode at its own."""
