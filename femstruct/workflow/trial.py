"""A model or a study computed with trial values of its parameters, and how its matrices change with each of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly, assemble
from femstruct.errors import FemstructError, Finding, InputError, InputErrors
from femstruct.language.cases import read_any, read_study
from femstruct.language.models import ModelFile
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, carry_damping, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.modal.sensitivity import (
    BACKWARD,
    CENTRED,
    FORWARD,
    ORDERS,
    MatrixSlopes,
    ModalSlopes,
    added,
    damping_slopes,
    free_shapes,
    matrix_slopes,
    modal_slopes,
)
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent, FrfRequest
from femstruct.study.results import CaseResult
from femstruct.study.structures import StructureModel
from femstruct.study.study import Plan, Study
from femstruct.units import DIMENSIONS, QuantityError, quantity_of
from femstruct.workflow.bases import (
    Places,
    Solved,
    add_cavities,
    add_cavities_for_tables,
    fingerprint,
    key_of,
    solve,
    solve_all,
    with_positions,
)
from femstruct.workflow.case import run_case
from femstruct.workflow.coupled_air import RoomTransfers
from femstruct.workflow.fit import Parameter, Values, parameter
from femstruct.workflow.provenance import Progress, Stopwatch
from femstruct.workflow.run import without_rooms
from femstruct.workflow.study_findings import all_findings

# ----------------------------------------------------------------------------------------------------------------------
# What is fitted, as the command line says it: PATH=START, or PATH=START:LOW:HIGH.
# ----------------------------------------------------------------------------------------------------------------------

_VALUE: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
_DO: Final = "write it like bodies.ball.contact.stiffness='4 kN/m' or materials.concrete.E='30 GPa:25 GPa:35 GPa'"


def parameters_of(texts: Sequence[str]) -> tuple[list[Parameter], dict[str, str]]:
    """Parameters and the unit of each, in which its start is written and its value is wanted.

    Raises InputError for texts that are none, without any, and for a path that stands there twice.

    >>> found, units = parameters_of(["materials.concrete.E=30 GPa:25000 MPa:35 GPa"])
    >>> found[0].low, found[0].high, units
    (25.0, 35.0, {'materials.concrete.E': 'GPa'})
    """
    found: list[Parameter] = []
    units: dict[str, str] = {}
    for text in texts:
        path, equals, written = (part.strip() for part in text.partition("="))
        start, *ends = written.split(":")
        read = _VALUE.fullmatch(start)
        if not equals or not path or read is None or len(ends) not in (0, 2):
            expected = "a path of the model or study, a number, and two bounds or none"
            raise InputError(f"--fit {text}", got="no PATH=START and no PATH=START:LOW:HIGH", expected=expected, do=_DO)
        if path in units:
            raise InputError(f"--fit {text}", got=f"'{path}' twice", expected="each path once")
        value, units[path] = float(read[1]), read[2]
        low, high = (_bound(text, end, value, units[path], start) for end in ends) if ends else (None, None)
        try:
            found.append(parameter(path, value, low, high))
        except InputError as error:
            got, do = _as_written(written, units[path]), _order_to_write(path, start, ends, low, high)
            raise InputError(f"--fit {text}", got=got, expected=error.expected, do=do) from None
    if not found:
        raise InputError("--fit", got="no parameter", expected="one or more PATH=START")
    return found, units


def _as_written(written: str, unit: str) -> str:
    """Start and bounds in words, each with its unit."""
    start, *ends = (one.strip() if re.search(r"[^\d.eE+-]", one) else f"{one.strip()} {unit}".rstrip()
                    for one in written.split(":"))  # fmt: skip
    return f"a start of {start}" + (f" and bounds of {ends[0]} and {ends[1]}" if ends else "")


def _order_to_write(path: str, start: str, ends: Sequence[str], low: float | None, high: float | None) -> str:
    """What to write where bounds are the wrong way round."""
    if low is None or high is None or not low > high:
        return ""
    return f"write {path}={start}:{ends[1]}:{ends[0]}"


def start_texts(texts: Sequence[str]) -> list[str]:
    """The same as changes of the files, PATH=START."""
    return [text.partition(":")[0] if "=" in text.partition(":")[0] else text for text in texts]


def refused_as_fit(texts: Sequence[str], errors: InputErrors) -> InputErrors:
    """Mistakes that name an override, as those of the parameter that it is of."""
    lines = errors.errors
    for text, start in zip(texts, start_texts(texts), strict=True):
        lines = tuple(line.replace(f"--set {start}", f"--fit {text}") for line in lines)
    return InputErrors(lines)


def _bound(text: str, end: str, start: float, unit: str, written: str) -> float:
    """A bound in the unit of the start; without a unit of its own it is in that."""
    read = _VALUE.fullmatch(end)
    if read is None:
        raise InputError(f"--fit {text}", got=f"a bound '{end}'", expected="a number", do=_DO)
    number = float(read[1])
    if read[2] in ("", unit):
        return number
    known = [*DIMENSIONS]
    try:
        (own, dimension), (first, of_start) = quantity_of(end.strip(), known), quantity_of(written.strip(), known)
    except QuantityError as error:
        raise InputError(f"--fit {text}", got=error.got, expected=f"a bound in {unit or 'SI units'}", do="") from None
    if dimension != of_start or not start:
        raise InputError(f"--fit {text}", got=f"a bound '{end}'", expected=f"one in {unit or 'SI units'}, as the start")
    return own / (first / start)


# ----------------------------------------------------------------------------------------------------------------------
# What measured data need to be computed.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Needs:
    """What measured data need of a computation: modes up to a frequency [Hz], 0 for none, of which what was measured
    ends at `top_hz`; residual vectors for frequency responses; a run of the study, with rooms or without, and with
    this sampling [Hz] and duration [s] where a history asks for a sampling; else as it is planned."""

    up_to_hz: float = 0.0
    top_hz: float = 0.0
    frfs: tuple[FrfRequest, ...] = ()
    run: bool = False
    rooms: bool = False
    sampling: float = 0.0
    duration: float = 0.0

    def __add__(self, other: Needs) -> Needs:
        return Needs(
            max(self.up_to_hz, other.up_to_hz),
            max(self.top_hz, other.top_hz),
            self.frfs + other.frfs,
            self.run or other.run,
            self.rooms or other.rooms,
            max(self.sampling, other.sampling),
            max(self.duration, other.duration),
        )

    @property
    def timing(self) -> tuple[str, ...]:
        """Changes of the study's window."""
        if not self.sampling:
            return ()
        return (f"time.sampling={self.sampling!r}", f"time.duration={self.duration!r}")


# ----------------------------------------------------------------------------------------------------------------------
# A model or a study computed with trial values of its parameters, and how its matrices change with each of them.
# ----------------------------------------------------------------------------------------------------------------------

STEP: Final = 1e-2  # of a parameter, between assemblies: polynomials are exact, others to its fourth power
KEPT: Final = 4  # trials


@dataclass(frozen=True, eq=False)
class Moded:
    """The modes of a trial. bare : without damping and air. assembly is None where derivatives of the matrices are not
    those of the modes: closed forms, air between surfaces, walls at edges. solved : then the structure with its
    modes. reference : modes of the file as it is, of whose numbers some have a damping of their own; None without."""

    structure: StructureModel
    damping: Damping
    places: Places
    model: Model | None
    assembly: Assembly | None
    bare: ModalBasis
    solved: Solved | None = None
    reference: ModalBasis | None = None

    @cached_property
    def undamped(self) -> ModalBasis:
        """The modes as tables show them, with the air between surfaces."""
        return self.bare if self.solved is None else add_cavities_for_tables(self.bare, self.solved)

    @cached_property
    def damped(self) -> ModalBasis:
        """What frequency responses are made of. Damping of single modes follows them by shape, as between cases."""
        if self.reference is None:
            basis = with_damping(self.bare, self.damping)
        else:
            basis = carry_damping(self.damping, self.reference, self.bare)
        return basis if self.solved is None else add_cavities(basis, self.solved)

    @cached_property
    def free(self) -> Floats:
        """Shapes on the free degrees of freedom [n_free, k]."""
        assert self.assembly is not None
        return free_shapes(self.assembly, self.bare)


@dataclass(frozen=True, eq=False)
class Change:
    """Derivatives of a trial by one parameter: of its matrices, None where they do not change, and in its modes.

    of_damping : whether those of damping are known, too.
    """

    matrices: MatrixSlopes | None
    modal: ModalSlopes
    of_damping: bool


@dataclass(frozen=True, eq=False)
class Trial:
    """What was computed with some values: its modes, and its case of the study, run. origin : the trial at the starts;
    None for itself. kept : what data made of it."""

    values: Values
    modes: Moded | None
    result: CaseResult | None
    origin: Trial | None = None
    kept: dict[str, Any] = field(default_factory=dict)

    def once(self, name: str, make: Callable[[], Any]) -> Any:
        """What `make` returns, made once."""
        if name not in self.kept:
            self.kept[name] = make()
        return self.kept[name]


class Trials:
    """Computes trials of a model or study file, and keeps the first and the last ones.

    parameters : what varies, with the unit of each in `units`. overrides : changes of the files for all trials.
    """

    def __init__(
        self,
        file: Path,
        parameters: Sequence[Parameter],
        units: Mapping[str, str],
        needs: Needs,
        case: str = "",
        overrides: Sequence[str] = (),
        progress: Progress = lambda line: None,
    ) -> None:
        self.file, self.needs, self.case, self.overrides, self.progress = file, needs, case, tuple(overrides), progress
        self.parameters = {one.name: one for one in parameters if one.name in units}
        self.units = units
        self.rooms, self.runs = RoomTransfers(), 0
        self._bases: dict[str, Solved] = {}
        self._trials: dict[tuple[float, ...], Trial] = {}
        self._origin: Trial | None = None
        self._as_it_is: ModalBasis | None = None

    def at(self, values: Values) -> Trial:
        """The trial with these values."""
        key = tuple(values[name] for name in self.parameters)
        if key not in self._trials:
            self.runs += 1
            self.progress(f"identify {', '.join(self.parameters)}: run {self.runs}")
            source = self._read(values)
            with with_positions(source):
                modes = self._with_reference(*_described(source)) if self.needs.up_to_hz else None
                result = self._run(source, estimated=False) if self.needs.run and isinstance(source, Plan) else None
            self._trials = {
                **dict([*self._trials.items()][1 - KEPT :]),
                key: Trial(values, modes, result, self._origin),
            }
            self._origin = self._origin or self._trials[key]
        return replace(self._trials[key], values=values)

    def findings(self, values: Values) -> tuple[Finding, ...]:
        """What is to be known of the structure, or of the run with the error of its integration, with these values."""
        if self.needs.run:
            source = self._read(values)
            assert isinstance(source, Plan)
            with with_positions(source):
                return self._run(source, estimated=True).findings
        own, frfs = self.at(values).modes, self.needs.frfs
        assert own is not None
        solved = own.solved or Solved("", own.structure, own.model, own.places, own.bare)
        return all_findings(solved, own.damped if frfs else own.undamped, (), frfs, self.needs.top_hz)

    def change(self, values: Values, name: str) -> Change | None:
        """Derivatives of the modes by one parameter; None where they are not known, as where places move."""
        moded, one = self.at(values).modes, self.parameters.get(name)
        if moded is None or moded.assembly is None or one is None:
            return None
        step = STEP * abs(one.scale) * max(abs(values[name] / one.scale), 0.1)
        sides = CENTRED
        if values[name] - 2.0 * step < one.low:
            sides = FORWARD
        elif values[name] + 2.0 * step > one.high:
            sides = BACKWARD

        @cache
        def described(value: float) -> tuple[StructureModel, Damping]:
            return _described(self._read({**values, name: value}))

        @cache
        def modelled(value: float) -> Model:
            structure, _ = described(value)
            assert isinstance(structure, Structure)
            return mesh_structure(structure)

        def assembled(value: float) -> Assembly:
            return assemble(modelled(value))

        try:
            ends = sorted(values[name] + side * step for side in sides[:2])
            (structure, less), (_, more) = (described(value) for value in ends)
            matrices = None
            if _name_of(structure) != _name_of(moded.structure):
                matrices = matrix_slopes(assembled, moded.assembly, values[name], step, sides)
                if matrices is None or not all(self._as_placed(modelled(value), moded) for value in ends):
                    return None
        except FemstructError:
            return None  # a step leads out of what the language allows: differences keep within the bounds
        return _change(moded, matrices, less, more, ends[1] - ends[0])

    def _as_placed(self, model: Model, moded: Moded) -> bool:
        """Whether frequency responses are driven and measured through the same weights: matrices do not change where a
        point moves, but what is read there does."""
        other = Places(model.points, model.surfaces, model.parts)
        return all(_same(*both) for both in zip(self._probes(other), self._probes(moded.places), strict=True))

    def _probes(self, places: Places) -> list[Probe]:
        """Where frequency responses are driven and measured, of motions."""
        spots = {str(end): end for one in self.needs.frfs for end in (one.drive, one.response)}
        moving = [end for end in spots.values() if not end.what.startswith("force")]
        return [places.point(end.name, "--frf").probe(end.what) for end in moving]

    def _read(self, values: Values) -> ModelFile | Plan:
        changed = tuple(f"{name}={values[name]!r} {self.units[name]}".rstrip() for name in self.parameters)
        return read_source(self.file, (*self.overrides, *changed, *self.needs.timing), self.case)

    def _with_reference(self, structure: StructureModel, damping: Damping) -> Moded:
        """Modes, with those of the file as it is where single modes are damped by their numbers."""
        found = self._moded(structure, damping)
        if not (damping.modes and self.needs.frfs):
            return found
        if self._as_it_is is None:
            self._as_it_is = self._moded(*_described(read_source(self.file, self.overrides, self.case))).bare
        return replace(found, reference=self._as_it_is)

    def _moded(self, structure: StructureModel, damping: Damping) -> Moded:
        """Modes with the residual vectors that derivatives need, where there are derivatives."""
        extent = Extent(up_to_hz=self.needs.up_to_hz)
        asking = Study("", structure, damping, extent, frf=self.needs.frfs)
        if isinstance(structure, Structure) and not structure.cavities:
            model = mesh_structure(structure)
            assembly = assemble(model)
            if not assembly.growing:
                places = Places(model.points, model.surfaces, model.parts)
                bare = modal_basis(assembly, up_to=extent.up_to_hz, probes=self._probes(places), orders=ORDERS)
                return Moded(structure, damping, places, model, assembly, bare)
        solved = solve(structure, extent, (asking,))
        return Moded(structure, damping, solved.places, solved.model, None, solved.basis, solved)

    def _run(self, plan: Plan, estimated: bool) -> CaseResult:
        """The baseline of a study, run.

        Parameters
        ----------
        estimated : bool
            Whether the error of its integration is, by a second simulation.
        """
        plan = plan if self.needs.rooms else without_rooms(plan)
        case = next(one for one in plan.cases if one.name == plan.baseline)
        key = key_of(case.study)
        if key not in self._bases:
            self._bases = {**dict([*self._bases.items()][1 - KEPT :]), key: solve_all((case,))[case.name]}
        clock = Stopwatch(lambda line: None)
        return run_case(case, {case.name: self._bases[key]}, case, clock, transfers=self.rooms, estimated=estimated)


def read_source(file: Path, overrides: Sequence[str], case: str) -> ModelFile | Plan:
    """A model, or a study with the case that is fitted as its baseline."""
    source = read_any(file, overrides)
    if isinstance(source, ModelFile) and case:
        raise InputErrors((f"--case: got '{case}' of a model, expected a study; leave it out",))
    return source if isinstance(source, ModelFile) or not case else read_study(file, overrides, only=case)


def _described(source: ModelFile | Plan) -> tuple[StructureModel, Damping]:
    if isinstance(source, ModelFile):
        return source.structure, source.damping
    study = next(one.study for one in source.cases if one.name == source.baseline)
    return study.structure, study.damping


def _same(one: Probe, other: Probe) -> bool:
    return all(np.array_equal(getattr(one, word), getattr(other, word)) for word in ("nodes", "components", "weights"))


def _name_of(structure: StructureModel) -> str:
    try:
        return fingerprint(structure)
    except TypeError:
        return ""


def _change(moded: Moded, matrices: MatrixSlopes | None, less: Damping, more: Damping, apart: float) -> Change:
    """The derivatives in the modes, of what changes: matrices, the law of damping, or both."""
    none = np.zeros_like(moded.bare.viscous)
    modal, known = ModalSlopes(none, none, none, none), not moded.damping.modes
    if known and less != more:
        modal = damping_slopes(moded.bare, less, more, apart)
    if matrices is not None:
        own = modal_slopes(moded.bare, moded.damping, moded.free, matrices)
        known = known and own is not None
        own = own or modal_slopes(moded.bare, Damping(), moded.free, matrices)
        assert own is not None
        modal = added(own, modal)
    return Change(matrices, modal, known)
