"""Kernels: Python functions that are compiled to machine code once, by numba in processes of their own, and kept.

`kernels` marks them, `byte_layout` says how values are laid out for them, `translate` makes the machine code (the
only module that imports numba), `store` keeps it, `loading` brings it into a process, `workers` compiles what is
missing.
"""

from __future__ import annotations
