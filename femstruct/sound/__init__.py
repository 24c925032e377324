"""The crossing from structures to the air: moving surfaces, air that pushes back, radiated power, striking bodies."""
