"""A process that compiles: names of units come in, a line goes out for each that is done."""

from __future__ import annotations

import gc
import importlib
import os
import sys
from pathlib import Path

from femstruct.compiled.kernels import CompiledUnit
from femstruct.compiled.store import store_code


def main() -> None:
    """`python -m femstruct.compiled FOLDER`."""
    # numba optimises and emits what it translates; nobody uses that, so it shall not take long over it
    os.environ["NUMBA_OPT"] = "0"
    gc.disable()
    from femstruct.compiled.translate import machine_code

    folder = Path(sys.argv[1])
    for line in sys.stdin:
        module, _, name = line.strip().rpartition(".")
        unit = getattr(importlib.import_module(module), name)
        assert isinstance(unit, CompiledUnit), line
        store_code(unit, machine_code(unit), folder)
        print(unit.name, flush=True)


if __name__ == "__main__":
    main()
