"""Tables and pictures of campaigns."""
