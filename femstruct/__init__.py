"""Impact vibration of structures and the sound it makes."""
