"""Structures known in closed form, with the same interface: oscillator, rod, beam, and modes given as numbers.

Each function returns a ModalBasis and its named points. There is no mesh: the points of the basis are the named
ones, then evenly spaced stations, enough to tell the mode shapes apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal

import numpy as np

from femstruct.arrays import Floats
from femstruct.conventions import N_COMPONENTS, RY, UX, UZ
from femstruct.declared import expect
from femstruct.errors import InputError
from femstruct.modal.basis import ForceRow, Kind, ModalBasis
from femstruct.model.probe import Point

# ----------------------------------------------------------------------------------------------------------------------
# Bending of a uniform beam in closed form: wave numbers and shapes between any two classical ends.
# ----------------------------------------------------------------------------------------------------------------------

End = Literal["pinned", "free", "clamped"]
CONDITIONS: Final[dict[str, tuple[int, int]]] = {"pinned": (0, 2), "free": (2, 3), "clamped": (0, 1)}
"""Orders of the derivatives of w that vanish at an end."""


def rigid_shapes(ends: tuple[End, End]) -> tuple[tuple[float, float], ...]:
    """a + b x / L of the rigid motions the ends allow, orthogonal over the beam."""
    if set(ends) == {"free"}:
        return ((1.0, 0.0), (-1.0, 2.0))
    if set(ends) == {"pinned", "free"}:
        return ((0.0, 1.0),) if ends[0] == "pinned" else ((1.0, -1.0),)
    return ()


def roots(ends: tuple[End, End], count: int) -> Floats:
    """beta L of the first elastic modes: Newton from the roots without the exponentially small terms."""
    n = np.arange(1, count + 1, dtype=np.float64)
    kinds = {*ends}
    if kinds == {"pinned"}:
        return n * np.pi
    if "pinned" in kinds:  # tan z = tanh z
        z = (n + 0.25) * np.pi
        for _ in range(8):
            z = z - (np.sin(z) - np.tanh(z) * np.cos(z)) / (
                np.cos(z) + np.tanh(z) * np.sin(z) - np.cos(z) * _sech(z) ** 2
            )
        return z
    sign = 1.0 if kinds == {"clamped", "free"} else -1.0  # cos z = -+ 1 / cosh z
    z = (n - 0.5) * np.pi if sign > 0 else (n + 0.5) * np.pi
    for _ in range(8):
        z = z - (np.cos(z) + sign * _sech(z)) / (-np.sin(z) - sign * np.tanh(z) * _sech(z))
    return z


def _sech(z: Floats) -> Floats:
    return 2.0 * np.exp(-z) / (1.0 + np.exp(-2.0 * z))


def terms(root: float, s: Floats, order: int) -> Floats:
    """The order-th derivative by s of cos, sin, e^{-z s} and e^{-z (1 - s)} at s [n] -> [n, 4], z = root."""
    phase = root * s[:, None] + order * np.pi / 2.0
    decay, rise = np.exp(-root * s[:, None]), np.exp(-root * (1.0 - s[:, None]))
    return root**order * np.concatenate([np.cos(phase), np.sin(phase), (-1.0) ** order * decay, rise], axis=1)


def amplitudes_of(ends: tuple[End, End], root: float) -> Floats:
    """Amplitudes of the four terms that meet the conditions at both ends."""
    rows = [
        terms(root, np.array([s]), order)[0] / root**order
        for s, end in ((0.0, ends[0]), (1.0, ends[1]))
        for order in CONDITIONS[end]
    ]
    amplitudes: Floats = np.linalg.svd(np.array(rows))[2][-1]
    return amplitudes


def sign_of(shape: Floats) -> float:
    """The sign of the largest value, of the first where several are alike to 0.1 %."""
    size = np.abs(shape)
    return float(np.sign(shape[np.argmax(size >= 0.999 * size.max())]))


# ----------------------------------------------------------------------------------------------------------------------
# Structures known in closed form, with the same interface.
# ----------------------------------------------------------------------------------------------------------------------

Axis = Literal["x", "y", "z"]
Points = dict[str, Point]
_AXES: Final = ("x", "y", "z")


def oscillator(
    mass: float,
    *,
    frequency_hz: float | None = None,
    stiffness: float | None = None,
    points: Sequence[str] = ("m",),
    axis: Axis = "x",
) -> tuple[ModalBasis, Points]:
    """A mass on a spring to the ground, moving along one axis; "ground.AXIS" is the spring's force on the ground.

    mass [kg]; frequency_hz [Hz] or stiffness [N/m], zero for a free mass.

    Parameters
    ----------
    points : Sequence[str]
        Names, all at the mass.

    Examples
    --------
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> basis.omega, points["m"].probe("x").of(basis.shapes).round(6)
    (array([5.]), array([0.707107]))
    """
    _positive("oscillator.mass", mass)
    if (frequency_hz is None) == (stiffness is None):
        raise InputError("oscillator", got="both or neither", expected="one of frequency and stiffness")
    for name, value in (("frequency", frequency_hz), ("stiffness", stiffness)):
        expect(f"oscillator.{name}", value, float | None)
    expect("oscillator.axis", axis, Axis)
    k = stiffness if stiffness is not None else mass * (2.0 * np.pi * (frequency_hz or 0.0)) ** 2
    if not (np.isfinite(k) and k >= 0):
        raise InputError("oscillator", got=f"stiffness {k:g} N/m", expected="a value >= 0")
    omega = np.array([np.sqrt(k / mass)])
    component = _AXES.index(axis)
    shapes = np.zeros((len(points), N_COMPONENTS, 1))
    shapes[:, component] = 1.0 / np.sqrt(mass)
    places = np.zeros((len(points), 3))
    momentum = np.zeros((3, 1))
    momentum[component] = np.sqrt(mass)
    outputs = {f"ground.{axis}": _row(np.array([k / np.sqrt(mass)]))} if k > 0 else {}
    basis = _basis(omega, shapes, places, momentum, mass, np.inf, outputs)
    return basis, _points(tuple(points), places)


def rod(
    length: float, E: float, rho: float, area: float, modes: int, points: Mapping[str, float] | None = None
) -> tuple[ModalBasis, Points]:
    """A free-free rod along x, moving along x: f_r = r c / 2 L, c = sqrt(E / rho); mode 1 is rigid.

    length [m], E [Pa], rho [kg/m^3], area [m^2].

    Parameters
    ----------
    modes : int
        How many, the rigid one counted.
    points : Mapping[str, float] | None
        Name to x [m].

    Notes
    -----
    Modal masses rho A L (rigid) and rho A L / 2 are divided out. A local contact converges slowly with the
    number of modes: 50 of them leave about 1 % in the energy of a short impact.

    Examples
    --------
    >>> basis, _ = rod(2.0, 206e9, 7850.0, 3.14e-4, modes=3)
    >>> basis.frequency_hz.round(1)
    array([   0. , 1280.7, 2561.3])
    """
    for name, value in (("length", length), ("E", E), ("rho", rho), ("area", area), ("modes", modes)):
        _positive(f"rod.{name}", value)
    number = np.arange(modes)
    omega = number * np.pi * np.sqrt(E / rho) / length
    total = rho * area * length
    places = _stations("rod", length, modes, points)
    shapes = np.zeros((len(places), N_COMPONENTS, modes))
    scale = np.sqrt(np.where(number == 0, 1.0, 2.0) / total)
    shapes[:, UX] = scale * np.cos(np.outer(places[:, 0], number) * np.pi / length)
    momentum = np.zeros((3, modes))
    momentum[0, 0] = np.sqrt(total)
    above = modes * np.sqrt(E / rho) / (2.0 * length)
    basis = _basis(omega, shapes, places, momentum, total, above, {})
    return basis, _points(tuple(points or {}), places)


def beam(
    length: float,
    EI: float,
    mass_per_length: float,
    ends: tuple[End, End],
    modes: int,
    points: Mapping[str, float] | None = None,
) -> tuple[ModalBasis, Points]:
    """A uniform Euler-Bernoulli beam along x, bending along z (RY = -dw/dx), between any two ends.

    length [m], EI [N m^2], mass_per_length [kg/m].

    Parameters
    ----------
    ends : tuple[End, End]
        Each "pinned", "free" or "clamped", at x = 0 and x = L.
    modes : int
        How many, rigid ones counted (two if free-free, one if pinned-free).
    points : Mapping[str, float] | None
        Name to x [m]. "ground.z" is the force of the supported ends on the ground, of a motion that is free between
        them.

    Notes
    -----
    Shapes are sums of cos, sin and exponentials that decay from either end, so nothing overflows; the
    wave_numbers of the frequency equation are found by Newton's method on its bounded form, to rounding.

    Source: R. D. Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1.

    Examples
    --------
    >>> basis, _ = beam(0.4, 5.9, 0.3, ("pinned", "free"), modes=6)
    >>> basis.frequency_hz.round(2)
    array([   0.  ,   68.01,  220.41,  459.87,  786.4 , 1200.01])
    """
    for name, value in (("length", length), ("EI", EI), ("mass_per_length", mass_per_length), ("modes", modes)):
        _positive(f"beam.{name}", value)
    for end in ends:
        if end not in CONDITIONS:
            raise InputError("beam.ends", got=f"'{end}'", expected=" or ".join(CONDITIONS))
    total = mass_per_length * length
    rate = np.sqrt(EI / mass_per_length) / length**2
    rigid = rigid_shapes(ends)
    n_rigid = min(len(rigid), modes)
    wave_numbers = roots(ends, modes + 1 - n_rigid)
    omega = np.concatenate([np.zeros(n_rigid), wave_numbers[: modes - n_rigid] ** 2 * rate])
    places = _stations("beam", length, modes, points)
    s = places[:, 0] / length
    nodes, weights = np.polynomial.legendre.leggauss(4 * modes + 40)  # exact to rounding: four points a half wave
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    shapes = np.zeros((len(places), N_COMPONENTS, modes))
    momentum = np.zeros(modes)
    for index in range(n_rigid):
        a, b = rigid[index]
        size = float(np.sqrt(total * weights @ (a + b * nodes) ** 2))
        shapes[:, UZ, index], shapes[:, RY, index] = (a + b * s) / size, -b / (size * length)
        momentum[index] = total * weights @ (a + b * nodes) / size
    for index in range(n_rigid, modes):
        root = wave_numbers[index - n_rigid]
        factors = amplitudes_of(ends, root)
        inside = terms(root, nodes, 0) @ factors
        size = sign_of(inside) * float(np.sqrt(total * weights @ inside**2))
        shapes[:, UZ, index] = terms(root, s, 0) @ factors / size
        shapes[:, RY, index] = -terms(root, s, 1) @ factors / (size * length)
        momentum[index] = total * weights @ inside / size
    held = any(end != "free" for end in ends)
    outputs = {"ground.z": _row(omega**2 * momentum)} if held else {}
    along = np.stack([np.zeros(modes), np.zeros(modes), momentum])
    above = float(wave_numbers[modes - n_rigid] ** 2 * rate / (2.0 * np.pi))
    return _basis(omega, shapes, places, along, total, above, outputs), _points(tuple(points or {}), places)


def given_modes(
    frequency_hz: Sequence[float],
    ratio: Sequence[float],
    points: Mapping[str, Sequence[float]],
    axis: Axis = "z",
    at: Mapping[str, float] | None = None,
) -> tuple[ModalBasis, Points]:
    """Modes as measured or published: frequencies [Hz], damping ratios [1], and their shapes at named points.

    Parameters
    ----------
    points : Mapping[str, Sequence[float]]
        Name to the mode shape there along the axis, one value a mode [1/sqrt(kg)] (mass-normalised).
    at : Mapping[str, float] | None
        Positions along the axis [m] of points, which tell what is above what; 0 for the others.

    Notes
    -----
    The ratios are viscous and part of the basis already. Nothing is known of modes left out, of masses or of
    forces on the ground: `complete_below_hz` is 0 and modal masses are 0.

    Examples
    --------
    >>> basis, points = given_modes([6.37, 282.8], [0.0, 0.0], {"O_b": [0.14, 0.392], "O_f": [0.14, -0.07]})
    >>> points["O_f"].probe("z").of(basis.shapes)
    array([ 0.14, -0.07])
    """
    omega = 2.0 * np.pi * np.asarray(frequency_hz, dtype=np.float64)
    k = len(omega)
    if not (np.diff(omega) >= 0).all() or (omega < 0).any():
        raise InputError("modes.frequency", got=f"{list(frequency_hz)}", expected="ascending frequencies >= 0")
    if len(ratio) != k or not all(value >= 0 for value in ratio):
        raise InputError("modes.ratio", got=f"{list(ratio)}", expected=f"{k} damping ratios >= 0")
    for name, row in points.items():
        if len(row) != k:
            raise InputError(f"modes.points.{name}", got=f"{len(row)} values", expected=f"{k}, one a mode")
    shapes = np.zeros((len(points), N_COMPONENTS, k))
    shapes[:, _AXES.index(axis)] = np.array([list(row) for row in points.values()]).reshape(len(points), k)
    places = np.zeros((len(points), 3))
    places[:, 0] = np.arange(len(points))  # apart from each other; where they are is not known
    if at:
        places[:, _AXES.index(axis)] = [at.get(name, 0.0) for name in points]
    viscous = np.diag(2.0 * np.asarray(ratio, dtype=np.float64) * omega)
    return _basis(
        omega,
        shapes,
        places=places,
        momentum=np.zeros((3, k)),
        total_mass=0.0,
        complete_below_hz=0.0,
        outputs={},
        viscous=viscous,
    ), _points(tuple(points), places)


def _stations(where: str, length: float, modes: int, points: Mapping[str, float] | None) -> Floats:
    """The named positions, then 4 stations for every mode (400 at most), along x [n, 3]."""
    named = np.array(list((points or {}).values()), dtype=np.float64)
    for name, place in (points or {}).items():
        if not 0.0 <= place <= length:
            raise InputError(f"points.{name}.at", got=f"{place:g} m", expected=f"0 to {length:g} m along the {where}")
    x = np.concatenate([named, np.linspace(0.0, length, min(4 * modes, 400) + 1)])
    return np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)


def _points(names: tuple[str, ...], places: Floats) -> Points:
    """Named points at the first places: each is a node of its own."""
    return {
        name: Point(
            name=name,
            position=places[i],
            nodes=np.full(6, i),
            components=np.arange(6),
            weights=np.eye(6),
            normal=np.array([0.0, 0.0, 1.0]),
        )
        for i, name in enumerate(names)
    }


def _basis(
    omega: Floats,
    shapes: Floats,
    places: Floats,
    momentum: Floats,
    total_mass: float,
    complete_below_hz: float,
    outputs: Mapping[str, ForceRow],
    viscous: Floats | None = None,
) -> ModalBasis:
    k = len(omega)
    kind: tuple[Kind, ...] = tuple("elastic" if value > 0 else "rigid" for value in omega)
    return ModalBasis(
        omega=omega,
        kind=kind,
        shapes=shapes,
        points=places,
        viscous=np.zeros((k, k)) if viscous is None else viscous,
        hysteretic=np.zeros((k, k)),
        outputs=outputs,
        part_stiffness={},
        loss_factors={},
        residual_norm=np.zeros(k),
        complete_below_hz=complete_below_hz,
        momentum=momentum,
        total_mass=total_mass,
    )


def _row(stiffness: Floats) -> ForceRow:
    return ForceRow(stiffness, np.zeros_like(stiffness), np.zeros_like(stiffness))


def _positive(where: str, value: float) -> None:
    if not expect(where, value, float) > 0:
        raise InputError(where, got=f"{value:g}", expected="a positive value")
