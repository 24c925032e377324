"""Model -> Assembly: dofs scatter ties forces, then assemble; the matrices are the noun."""
