"""The reproduction ledger: what the dissertation prints, beside what femstruct computes, with a computed verdict.

A module of this package that has a function `rows() -> list[Row]` is part of the ledger; `scripts/reproduce.py`
gathers them all.
"""

from ledger.row import Row as Row
