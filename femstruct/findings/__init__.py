"""What can be found against a result: the catalogue of all codes, their ranks, and how a code is explained."""
