"""The dissertation's small systems as functions, shared by the numbered scripts and the ledger."""
