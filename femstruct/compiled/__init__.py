"""Kernels: Python functions that are compiled to machine code once, by numba in processes of their own, and kept.

`kernels` marks them and lays values out for them, `records` has what they read, `translate` makes the machine code (the
only module that imports numba), `store` keeps it, and compiles in processes of their own what is missing.
"""

from __future__ import annotations
