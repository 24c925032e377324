"""What can be said against a structure before its modes are known: materials, arrangement, theories that do not fit."""
