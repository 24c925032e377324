"""What frames are made of: their lines as straight pieces, their bars between nodes."""
