"""Materials and products with their sources: values, ranges, and where each of them is printed."""
