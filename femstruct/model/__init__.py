"""What a structure is and its mesh: material section parts, mesh probe model, planning mesher and what they need."""
