"""What is known from measurements: structure-borne sources in place, coverings on floors."""
