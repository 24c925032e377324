"""Tables of results for machines: JSON, HDF5 and spreadsheets."""
