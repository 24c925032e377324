"""What an impact brought: histories, shares of energy, blow by blow, findings."""
