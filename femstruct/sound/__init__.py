"""From structures to the air: moving surfaces, two-way coupling, radiated power, the own sound of striking bodies."""
