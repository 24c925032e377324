"""results.h5: what is written, sealed and read back whole."""
