"""Assembly -> ModalBasis: factor solve residuals outputs, then reduction; analytic bases; damping and frf."""
