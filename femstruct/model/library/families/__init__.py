"""One family of materials or products a file: its entries, each value with its source."""
