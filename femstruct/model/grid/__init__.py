"""Our own meshes: where grid lines and nodes of rectangles and bars lie."""
