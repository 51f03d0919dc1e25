"""Tournaments: everybody against everybody on the ledger of the laboratory, and who is best."""
