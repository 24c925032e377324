"""What can be asked of one recorded history: a module each, which nothing else has to name."""
