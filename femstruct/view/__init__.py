"""The only code that draws: figures in matplotlib, scenes in pyvista, tables in the terminal."""
