"""Boxes whose walls move, too: every wall as the ceiling of the box turned."""
