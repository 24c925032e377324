"""Cases beside their baseline, limits and their verdicts."""
