"""Machine code of units into this process, by LLVM's own linker."""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p
from threading import Lock
from typing import Any, Final

import llvmlite.binding as llvm

from femstruct.impact.compiled.kernels import Unit, units_called
from femstruct.impact.compiled.workers import code_of

_TYPES: Final[dict[str, Any]] = {"int": c_int64, "bool": c_int64, "float": c_double, "tuple": c_void_p}
_LOCK = Lock()
_ENGINES: Final[list[llvm.ExecutionEngine]] = []  # their code lives as long as they do


def native(unit: Unit[..., Any]) -> Any:
    """A unit's C function; the units it calls are loaded with it, or compiled where no run before has.

    Threads go on while it runs.
    """
    with _LOCK:  # of several threads that need a unit for the first time one compiles it
        code = code_of((unit, *units_called(unit)))
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        engine = llvm.create_mcjit_compiler(
            llvm.parse_assembly(""), llvm.Target.from_default_triple().create_target_machine()
        )
        for piece in code.values():
            engine.add_object_file(llvm.ObjectFileRef.from_data(piece))
        engine.finalize_object()
        address = engine.get_function_address(unit.symbol)
        _ENGINES.append(engine)
    assert address, unit.symbol
    return CFUNCTYPE(c_int64, *(_TYPES[slot.kind] for slot in unit.slots))(address)
