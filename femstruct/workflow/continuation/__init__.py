"""Levels of rated rooms that single runs do not give: beyond the modes, and over a laboratory's places and rooms."""
