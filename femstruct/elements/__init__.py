"""Element matrices, batched arrays in and out: polynomials quadrature, plate laminate, membrane shell, frame, solid."""
