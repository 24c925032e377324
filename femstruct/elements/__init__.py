"""Element matrices, batched arrays in and out: polynomials quadrature, plate, frame and its placement."""
