"""What flat elements of shells are made of: axes, strains, motion inside, rigidities."""
