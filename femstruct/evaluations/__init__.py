"""What can be asked of one recorded history: a module each, which nothing else has to name."""

from __future__ import annotations
