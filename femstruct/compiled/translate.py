"""From kernels to machine code: numba translates the Python, LLVM optimises it once, a whole unit at a time.

numba by itself optimises and emits every function, and then again in every caller. Here it emits nothing that is
used: its translation of all of a unit is taken as text, everything but the unit's own entry is made internal, and
LLVM optimises what is left. Of numba `register_jitable`, `cfunc` and the low-level extension interface are used,
and `populate_array` to make an array of an address; that one is not documented, so the versions of numba are a
range.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from typing import Any, Final

import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, typeof, types
from numba.core import cgutils
from numba.core.errors import NumbaError
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    infer_getattr,
    is_jitted,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_jitable,
    register_model,
    type_callable,
    typeof_impl,
)
from numba.np.arrayobj import populate_array

from femstruct.compiled.kernels import LEVEL, MARK, CompiledUnit, Slot, TupleLayout, call_at, kernels_of, units_called
from femstruct.errors import FemstructError

OPTIONS: Final[dict[str, Any]] = {"error_model": "numpy", "_nrt": False}
INNER: Final[dict[str, Any]] = {**OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
SUMS: Final = {"reassoc", "contract", "nsz"}
C_LIBRARY: Final = {"sqrt", "sin", "cos", "pow", "floor", "memset", "memcpy", "memmove"}
UNUSED: Final = 1  # an address
PASSES: Final = 2  # what one proves constant, as that nothing is raised, the next one removes


class ByAddress(types.Type):
    """numba's type of a named tuple that is laid out in words."""

    def __init__(self, layout: TupleLayout) -> None:
        self.layout = layout
        digest = hashlib.sha256(repr(layout).encode()).hexdigest()[:8]  # names of functions are made of it
        super().__init__(name=f"ByAddress({layout.name} {digest})")


@register_model(ByAddress)
class _Address(models.OpaqueModel):
    """A pointer to the words."""


@infer_getattr
class _Fields(AttributeTemplate):
    key = ByAddress

    def generic_resolve(self, value: ByAddress, name: str) -> types.Type | None:
        found = [slot for slot in value.layout.slots if slot.name == name]
        return _type(found[0]) if found else None


def _type(slot: Slot) -> types.Type:
    """numba's type of a slot's value."""
    if slot.inner is not None:
        return ByAddress(slot.inner)
    if slot.kind == "array":
        return typeof(np.zeros((1,) * slot.ndim, dtype=slot.dtype))
    return {"int": types.int64, "bool": types.boolean, "float": types.float64}[slot.kind]


@lower_getattr_generic(ByAddress)
def _read(context: Any, builder: Any, typ: ByAddress, value: Any, name: str) -> Any:
    """The words of a field, as numba's value of it. Nobody writes to words while a kernel runs."""
    slot = next(slot for slot in typ.layout.slots if slot.name == name)
    words = builder.bitcast(value, ir.IntType(64).as_pointer())

    def word(i: int, kind: ir.Type) -> Any:
        place = builder.gep(words, [ir.IntType(64)(slot.at + i)])
        read = builder.load(builder.bitcast(place, kind.as_pointer()))
        read.set_metadata("invariant.load", builder.module.add_metadata([]))
        return read

    if slot.inner is not None:
        return word(0, cgutils.voidptr_t)
    if slot.kind == "float":
        return word(0, ir.DoubleType())
    if slot.kind == "int":
        return word(0, ir.IntType(64))
    if slot.kind == "bool":
        return builder.icmp_signed("!=", word(0, ir.IntType(64)), ir.IntType(64)(0))
    array = _type(slot)
    out = context.make_array(array)(context, builder)
    shape = [word(1 + d, ir.IntType(64)) for d in range(slot.ndim)]
    assert slot.dtype is not None
    strides = [ir.IntType(64)(slot.dtype.itemsize)]
    for length in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], length))
    data = word(0, context.get_data_type(array.dtype).as_pointer())
    populate_array(out, data, shape, strides, ir.IntType(64)(slot.dtype.itemsize), None)
    return out._getvalue()


@typeof_impl.register(CompiledUnit)
def _external(unit: CompiledUnit[..., Any], _: Any) -> types.Type:
    """A unit that another one calls is a C function of this name."""
    return types.ExternalFunction(unit.symbol, _signature(unit))


@type_callable(call_at)
def _typed(_: Any) -> Callable[..., types.Type]:
    def typer(address: types.Type, x: types.Type, y: types.Type, numbers: types.Type) -> types.Type:
        return types.float64

    return typer


@lower_builtin(call_at, types.Integer, types.Float, types.Float, types.Array)
def _called(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    """A jump to the address."""
    address, x, y, numbers = args
    double = ir.DoubleType()
    kind = ir.FunctionType(double, [double, double, double.as_pointer()])
    first = context.make_array(signature.args[3])(context, builder, numbers).data
    return builder.call(builder.inttoptr(address, kind.as_pointer()), [x, y, first])


@cache
def own_code(function: Callable[..., float], takes_rate: bool, count: int) -> Any:
    """numba's C function of a user's f(depth, rate, parameters), or f(depth, parameters); its `address` is for
    `call_at`, with count parameters behind the pointer. It is kept as long as this process lives, and not on disk.

    Raises FemstructError for what numba cannot compile.
    """
    inner = function if is_jitted(function) else njit(error_model="numpy")(function)

    def with_rate(depth, rate, first):  # type: ignore[no-untyped-def]
        return inner(depth, rate, carray(first, count))

    def without(depth, rate, first):  # type: ignore[no-untyped-def]
        return inner(depth, carray(first, count))

    number = types.float64
    try:
        signature = number(number, number, types.CPointer(number))
        return cfunc(signature, error_model="numpy")(with_rate if takes_rate else without)
    except NumbaError as error:
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        raise FemstructError(
            f"own law {getattr(function, '__name__', 'function')}",
            got=f"what numba cannot compile: {' '.join(lines)[:200]}",
            expected="a function of numbers and an array of parameters that returns a number",
            do="numba.njit(function) says more",
        ) from None


def _signature(unit: CompiledUnit[..., Any]) -> Any:
    return types.int64(*(_type(slot) for slot in unit.slots))


@cache
def _inner(function: Callable[..., Any]) -> None:
    """Let compiled code call a kernel."""
    sums = {"fastmath": SUMS} if getattr(function, MARK) else {}
    register_jitable(**INNER, **sums)(function)


def machine_code(unit: CompiledUnit[..., Any]) -> bytes:
    """The object file of a unit: one C function of its symbol, that calls other units and C's library.

    Raises numba's errors for what it cannot translate; RuntimeError where the code needs anything else at run time.
    """
    for one in (unit, *units_called(unit)):
        for function in kernels_of(one)[1:]:
            _inner(function)
    for one in units_called(unit):
        llvm.add_symbol(one.symbol, UNUSED)  # numba links what it translates, though nobody runs it
    translated = cfunc(_signature(unit), **OPTIONS)(unit.python)
    module = llvm.parse_assembly(translated.inspect_llvm())
    module.get_function(translated.native_name).name = unit.symbol
    for found in (*module.functions, *module.global_variables):
        if not found.is_declaration and found.name != unit.symbol:
            found.linkage = "internal"
    machine = _this_processor()
    for _ in range(PASSES):
        _optimise(module, machine)
    needed = {found.name for found in module.functions if found.is_declaration and not found.name.startswith("llvm.")}
    strangers = needed - C_LIBRARY - {other.symbol for other in units_called(unit)}
    if strangers:
        raise RuntimeError(f"{unit.name} needs {', '.join(sorted(strangers))} at run time")
    return bytes(machine.emit_object(module))


def _optimise(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    options = llvm.create_pipeline_tuning_options(LEVEL)
    options.loop_vectorization = options.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)


def _this_processor() -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    intel = target.triple.startswith("x86")
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=LEVEL,
        reloc="static" if intel else "pic",
        codemodel="large" if intel else "jitdefault",
    )
