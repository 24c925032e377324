"""The collocation march: steps through Gauss points, events between them."""
