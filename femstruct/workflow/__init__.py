"""What people ask for: files inspected, studies run, cases compared; the only layer that knows all the others."""
