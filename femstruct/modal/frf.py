"""Frequency responses: modal sums with residual vectors, and the direct solution as their check."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array

from femstruct.arrays import Floats, Integers, frozen
from femstruct.assembly.matrices import Assembly
from femstruct.declared import expect
from femstruct.errors import InputError, NotConverged
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.by_frequency import loss_terms, without_walls
from femstruct.modal.coupled_damping import CoupledModes
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Rayleigh
from femstruct.modal.residuals import AXES
from femstruct.model.materials import LossByFrequency, loss_at
from femstruct.model.probe import Probe
from femstruct.sparse import FASTEST, SOLVERS, Factored, ZeroPivot, aligned

# ----------------------------------------------------------------------------------------------------------------------
# Harmonic motion as a sum of modes: modal coordinates along frequency, and what is read off them.
# ----------------------------------------------------------------------------------------------------------------------

Complex = NDArray[np.complex128]
Rows = tuple[Complex, Complex, Complex]
"""What is read off modal coordinates at omega: (rows[0] + omega rows[1] + omega^2 rows[2]) . q, each [k]."""
Tell = Callable[[int], None]
_CHUNK: Final = 2**22  # complex numbers held at once: 64 MB


def amplitudes(basis: ModalBasis, pushed: Floats, omega: Floats) -> Iterator[tuple[Integers, Complex]]:
    """Modal coordinates under harmonic modal forces [k]: numbers of some lines and theirs [lines, k], as many at once
    as memory allows, until all have been.

    Raises InputError for a line at the natural frequency of a mode without damping, where they are infinite.
    """
    squared, k = basis.omega**2, len(basis.omega)
    if any(np.any(A - np.diag(np.diag(A))) for A in (basis.viscous, basis.hysteretic)):
        yield from CoupledModes(squared, basis.viscous, basis.hysteretic).along(pushed, omega)
        return
    step = max(1, _CHUNK // max(1, k))
    for start in range(0, len(omega), step):
        lines = np.arange(start, min(start + step, len(omega)))
        w = omega[lines, None]
        losses = w * np.diag(basis.viscous) + np.diag(basis.hysteretic)
        dynamic = squared - w**2 + 1j * losses
        met = np.argwhere((dynamic == 0.0) & (pushed != 0.0))
        if len(met):
            got = f"{omega[lines[met[0, 0]]] / (2.0 * np.pi):g} Hz, a natural frequency without damping"
            do = "give the model a 'damping', or take lines beside it"
            raise InputError("frf frequency", got=got, expected="a finite response", do=do)
        yield lines, np.divide(pushed, dynamic, out=np.zeros_like(dynamic), where=dynamic != 0.0)


def superpose(basis: ModalBasis, pushed: Floats, rows: Rows, omega: Floats, tell: Tell = lambda done: None) -> Complex:
    """What `rows` read of the motion under harmonic modal forces [k], at each omega [nf].

    Parameters
    ----------
    tell : Tell
        Is given the number of lines that are done.
    """
    answer: Complex = np.empty(len(omega), dtype=np.complex128)
    done = 0
    for lines, q in amplitudes(basis, pushed, omega):
        answer[lines] = read_rows(rows, q, omega[lines])
        done += len(lines)
        tell(done)
    return answer


def read_rows(rows: Rows, q: Complex, omega: Floats) -> Complex:
    """What `rows` read of modal coordinates [lines, k] at omega [lines]."""
    w = omega[:, None]
    found: Complex = ((rows[0] + w * rows[1] + w**2 * rows[2]) * q).sum(axis=1)
    return found


def of_force(basis: ModalBasis, row: ForceRow) -> Rows:
    """Rows of a force of the structure: losses of its parts act as + j hysteretic, those of dashpots with omega.

    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, _ = oscillator(4.0, stiffness=100.0)
    >>> of_force(basis, basis.outputs["ground.x"])[0].real
    array([50.])
    """
    structural = np.divide(row.hysteretic, basis.omega, out=np.zeros_like(basis.omega), where=basis.omega > 0)
    return (
        np.asarray(row.stiffness + 1j * row.hysteretic, dtype=np.complex128),
        np.asarray(1j * (row.damping - structural), dtype=np.complex128),
        np.asarray(-row.inertia, dtype=np.complex128),
    )


def of_motion(row: Floats) -> Rows:
    """Rows of a displacement, from its values in the shapes [k]."""
    still = np.zeros_like(row, dtype=np.complex128)
    return row.astype(np.complex128), still, still


# ----------------------------------------------------------------------------------------------------------------------
# Frequency responses.
# ----------------------------------------------------------------------------------------------------------------------

FrfKind = Literal["receptance", "mobility", "accelerance", "transmissibility"]
_PER_SECOND: Final[dict[FrfKind, str]] = {"receptance": "", "mobility": "s", "accelerance": "s^2"}
KINDS: Final[tuple[FrfKind, ...]] = (*_PER_SECOND, "transmissibility")
A_PROBE: Final = 'model.points["NAME"].probe("z") is one'
_LAWS: Final = "damping of the whole structure: loss_factor, rayleigh or from: materials; dashpots act beside it"
_UNMOVED = 1e-12  # of the largest motion of the structure: rounding


def frf(
    basis: ModalBasis,
    drive: Probe,
    response: Probe | ForceRow,
    frequency_hz: ArrayLike,
    kind: FrfKind = "receptance",
    tell: Tell = lambda done: None,
) -> Complex:
    """Frequency response [nf] at `response` to a harmonic unit force at `drive`, by superposition of modes.

    Parameters
    ----------
    frequency_hz : ArrayLike [nf]
        >= 0 [Hz]; zero is refused when there are rigid modes.
    kind : FrfKind
        Receptance displacement / force [m/N], mobility velocity / force, accelerance acceleration / force;
        transmissibility: for a ForceRow (say `basis.outputs["ground.z"]`) that force over the driving force, for a
        Probe its displacement over the displacement at the drive point [1]. A ForceRow has no other kind.
    tell : Tell
        Is given the number of lines that are done.

    Raises
    ------
    InputError
        For a kind that does not fit, a negative frequency, zero with rigid modes, or a probe that no mode of the basis
        moves.

    Notes
    -----
    Motion is e^{+j omega t}, loss factors K (1 + j eta). With residual vectors for both probes in the basis and modes
    up to 2.5 times the highest frequency the error is below 1e-3 of the largest response (measured, `direct_frf`).

    Examples
    --------
    At its resonance an oscillator moves 1 / (k eta), a quarter of a period late:

    >>> from femstruct.modal.closed_form import oscillator
    >>> from femstruct.modal.damping import Damping, LossFactor, with_damping
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> damped, here = with_damping(basis, Damping(LossFactor(0.04))), points["m"].probe("x")
    >>> resonance = frf(damped, here, here, basis.frequency_hz)[0]
    >>> round(float(resonance.imag), 12), bool(abs(resonance.real) < 1e-12)
    (-0.5, True)
    """
    expect("frf basis", basis, ModalBasis, "modal_basis makes one of an Assembly")
    expect("frf drive", drive, Probe, A_PROBE)
    expect("frf response", response, Probe | ForceRow, A_PROBE)
    omega = _omega(frequency_hz)
    if basis.n_rigid and (omega == 0).any():
        raise InputError("frf frequency", got="0 Hz", expected="a frequency > 0: the structure is free")
    _check_kind(response, kind)
    for role, probe in (("drive", drive), ("response", response)):
        if isinstance(probe, Probe) and not moves_probe(basis, probe):
            raise InputError(
                f"frf {role}", got="a direction without motion in any mode", expected="a direction with motion"
            )
    pushed = drive.of(basis.shapes)
    if isinstance(response, ForceRow):
        return superpose(basis, pushed, of_force(basis, response), omega, tell) + response.direct.meets(drive)
    answer = superpose(basis, pushed, of_motion(response.of(basis.shapes)), omega, tell)
    if kind == "transmissibility":
        return answer / superpose(basis, pushed, of_motion(pushed), omega)
    return answer * _rate(kind, omega)


def modal_amplitudes(basis: ModalBasis, drive: Probe, frequency_hz: ArrayLike) -> Complex:
    """Modal coordinates [k, nf] of the response to a harmonic unit force at `drive` [sqrt(kg) m/N].

    Parameters
    ----------
    frequency_hz : ArrayLike [nf]
        > 0 where there are rigid modes [Hz].

    Examples
    --------
    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, points = oscillator(4.0, stiffness=100.0)
    >>> modal_amplitudes(basis, points["m"].probe("x"), [0.0]).real
    array([[0.02]])
    """
    omega = _omega(frequency_hz)
    if basis.n_rigid and (omega == 0).any():
        raise InputError("frf frequency", got="0 Hz", expected="a frequency > 0: the structure is free")
    answer: Complex = np.empty((len(basis.omega), len(omega)), dtype=np.complex128)
    for lines, q in amplitudes(basis, drive.of(basis.shapes), omega):
        answer[:, lines] = q.T
    return answer


def moves_probe(basis: ModalBasis, probe: Probe) -> bool:
    """Whether any mode of the basis moves a probe: a rod known along its axis does not move across it.

    >>> from femstruct.modal.closed_form import rod
    >>> basis, points = rod(2.0, 206e9, 7850.0, 3.14e-4, modes=3, points={"tip": 2.0})
    >>> moves_probe(basis, points["tip"].probe("x")), moves_probe(basis, points["tip"].probe("z"))
    (True, False)
    """
    largest = np.abs(basis.shapes).max(axis=0)[probe.components]
    return bool((np.abs(probe.of(basis.shapes)) > _UNMOVED * (np.abs(probe.weights) @ largest)).any())


def frf_unit(kind: FrfKind, drive: str, response: str) -> str:
    """Unit of a frequency response: `drive` and `response` are directions (x y z n, rx ry rz), or "force_z".

    A moment drives a rotation; a force as response is one over what drives.

    >>> frf_unit("accelerance", "rx", "rx"), frf_unit("receptance", "ry", "z"), frf_unit("mobility", "n", "rx")
    ('rad/(N m s^2)', 'm/(N m)', 'rad/(N s)')
    >>> frf_unit("transmissibility", "z", "force_z"), frf_unit("transmissibility", "z", "rx")
    ('1', 'rad/m')
    """
    turned, turning = drive.startswith("r"), response.startswith("r")
    if response.startswith("force"):
        return "1/m" if turned else "1"
    motion = "rad" if turning else "m"
    if kind == "transmissibility":
        return "1" if turned == turning else f"{motion}/{'rad' if turned else 'm'}"
    below = " ".join(part for part in ("N m" if turned else "N", _PER_SECOND[kind]) if part)
    return f"{motion}/({below})" if " " in below else f"{motion}/{below}"


def direct_frf(
    assembly: Assembly,
    drive: Probe,
    response: Probe | str,
    frequency_hz: ArrayLike,
    damping: Damping,
    kind: FrfKind = "receptance",
) -> Complex:
    """The same response [nf] by factorising K (1 + j eta) + j omega C - omega^2 M at every frequency: the check.

    Parameters
    ----------
    response : Probe | str
        A probe, or the name of a force with its axis, "ground.z".
    damping : Damping
        LossFactor, Rayleigh or FromMaterials without exceptions; ratios belong to modes and are refused, except zero.
        With FromMaterials only forces of parts with a loss factor of their own can be had.

    Raises
    ------
    InputError
        For a damping or force it cannot have, NotConverged if a line keeps a residual above 1e-8.
    """
    omega = _omega(frequency_hz)
    stiffness, dashpots, eta, law = _complex_stiffness(without_walls(assembly), damping)
    load = _dense_row(assembly, drive)
    through = _passed_on(assembly, response, drive) if isinstance(response, str) else 0.0
    _check_kind(response, kind)
    parts = loss_terms(assembly, isinstance(law, FromMaterials))
    pattern, (springs, losses, inertia, *others) = aligned(
        [stiffness, dashpots, assembly.M, *(part.stiffness for part in parts)]
    )
    analysis = SOLVERS[FASTEST](pattern)
    answers = np.empty(len(omega), dtype=np.complex128)
    for line, w in enumerate(omega):
        row: Complex = (
            _force_row(assembly, response, w, eta, law)
            if isinstance(response, str)
            else _dense_row(assembly, response).astype(np.complex128)
        )
        values = springs + 1j * w * losses - w**2 * inertia
        for part, part_springs in zip(parts, others, strict=True):
            values = values + part.factor(w) * part_springs
        try:
            factor = analysis.factor(values)
        except ZeroPivot as error:
            raise NotConverged("direct_frf", got=f"a singular matrix at {w / (2 * np.pi):.4g} Hz") from error
        shape = _solve_line(pattern.matrix(values), factor, load, w)
        answers[line] = row @ shape + through
        if kind == "transmissibility" and not isinstance(response, str):
            answers[line] /= load @ shape
    return answers if kind == "transmissibility" else answers * _rate(kind, omega)


def _solve_line(A: csc_array, factor: Factored, load: Floats, omega: float) -> Complex:
    """A^-1 load for a complex symmetric A, with one step of refinement."""
    shape = _complex(factor.solve(_complex(load)))
    shape = shape + _complex(factor.solve(_complex(load - A @ shape)))
    left = float(np.linalg.norm(load - A @ shape) / np.linalg.norm(load))
    terms = float(np.linalg.norm(abs(A) @ np.abs(shape)) / np.linalg.norm(load))
    if not left <= 1e-8 * max(1.0, 1e-6 * terms):
        raise NotConverged("direct_frf", got=f"a residual of {left:.1e} at {omega / (2 * np.pi):.4g} Hz")
    return shape


def lossy_matrices(assembly: Assembly, damping: Damping) -> tuple[csc_array, csc_array]:
    """K with its losses and C of an assembly with a law of damping, without what depends on frequency (`loss_terms`);
    InputError for ratios and single modes."""
    stiffness, dashpots, _, _ = _complex_stiffness(without_walls(assembly), damping)
    return stiffness, dashpots


def _complex_stiffness(
    assembly: Assembly, damping: Damping
) -> tuple[csc_array, csc_array, float, Rayleigh | FromMaterials | None]:
    """(K with its losses, C, eta, law): the matrices of a line, and what force rows need of the law."""
    law = damping.base
    if damping.modes:
        raise InputError("damping.modes", got="damping of single modes", expected=_LAWS, do="remove 'modes'")
    if isinstance(law, LossFactor):
        return csc_array((1.0 + 1j * law.value) * assembly.K), assembly.C, law.value, None
    if isinstance(law, Rayleigh):
        dashpots = csc_array(assembly.C + law.alpha * assembly.M + law.beta * assembly.K)
        return csc_array(assembly.K.astype(np.complex128)), dashpots, 0.0, law
    if isinstance(law, FromMaterials):
        lossy = csc_array(assembly.K.astype(np.complex128))
        for part, stiffness in assembly.part_stiffness.items():
            loss = assembly.loss_factors.get(part, 0.0)
            if not isinstance(loss, LossByFrequency):
                lossy = csc_array(lossy + 1j * loss * stiffness)
        return lossy, assembly.C, 0.0, law
    if law.value:
        do = f"write loss_factor: {200.0 * law.value:g} %, the same at each natural frequency"
        raise InputError("damping.ratio", got="one damping ratio of all modes", expected=_LAWS, do=do)
    return csc_array(assembly.K.astype(np.complex128)), assembly.C, 0.0, None


def _force_row(
    assembly: Assembly, name: str, omega: float, eta: float, law: Rayleigh | FromMaterials | None
) -> Complex:
    """A force of the structure on the free degrees of freedom at one frequency [n_free]."""
    part, _, axis = name.rpartition(".")
    force, i = assembly.forces[part], AXES.index(axis)
    stiffness, damping, inertia = (matrix.toarray()[i] for matrix in (force.stiffness, force.damping, force.inertia))
    if isinstance(law, FromMaterials):
        if part not in assembly.loss_factors:
            raise InputError("direct_frf response", got=f"'{name}'", expected="a force of a part with a loss factor")
        eta = float(loss_at(assembly.loss_factors[part], omega / (2.0 * np.pi)))
    if isinstance(law, Rayleigh):
        damping = damping + law.alpha * inertia + law.beta * stiffness
    return _complex((1.0 + 1j * eta) * stiffness + 1j * omega * damping - omega**2 * inertia)


def _passed_on(assembly: Assembly, name: str, drive: Probe) -> float:
    """What a force of the structure gets of a unit load without any motion."""
    part, _, axis = name.rpartition(".")
    if part not in assembly.forces or axis not in AXES:
        expected = " or ".join(assembly.forces) + " with .x .y .z"
        raise InputError("direct_frf response", got=f"'{name}'", expected=expected)
    row = drive.row(len(assembly.points))
    return float((assembly.forces[part].direct @ row.T).toarray()[AXES.index(axis), 0])


def _dense_row(assembly: Assembly, probe: Probe) -> Floats:
    row: Floats = (probe.row(len(assembly.points)) @ assembly.dofs.T).toarray()[0]
    return row


def _omega(frequency_hz: ArrayLike) -> Floats:
    frequency = frozen("frf frequency", np.atleast_1d(np.asarray(frequency_hz)), (None,))
    if (frequency < 0).any():
        raise InputError("frf frequency", got=f"{frequency.min():g} Hz", expected="frequencies >= 0")
    return 2.0 * np.pi * frequency


def _check_kind(response: Probe | ForceRow | str, kind: str) -> None:
    if kind not in KINDS:
        raise InputError("frf kind", got=f"'{kind}'", expected=" or ".join(KINDS))
    if not isinstance(response, Probe) and kind != "transmissibility":
        raise InputError(
            "frf kind", got=f"'{kind}' of a force", expected="transmissibility", do="forces are over the driving force"
        )


def _rate(kind: FrfKind, omega: Floats) -> Complex:
    """What turns a displacement into the kind's motion."""
    power = {"receptance": 0, "mobility": 1, "accelerance": 2}[kind]
    return _complex((1j * omega) ** power)


def _complex(values: ArrayLike) -> Complex:
    return np.asarray(values, dtype=np.complex128)
