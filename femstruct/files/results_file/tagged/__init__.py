"""Tags of stored nouns: which noun has which, in which module it is, and what older files called it."""
