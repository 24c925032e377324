"""What a study file can ask of one recorded history: a module each, which nothing else has to name."""
