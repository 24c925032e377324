"""Plots of histories, spectra, levels and maps."""
