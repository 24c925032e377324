"""What the command line asks of models and studies without running them."""
