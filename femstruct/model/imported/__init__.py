"""Meshes that come from files: their nodes, cells and named sets, and what their makers stated about them."""
