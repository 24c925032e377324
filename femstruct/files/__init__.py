"""The only code that writes results: hdf5 results stored vtkhdf, tables, audio and sound, each whole or not at all."""
