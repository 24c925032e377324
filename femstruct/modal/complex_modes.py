"""Complex modes: free vibration where damping is not proportional, so that places of a mode move out of step.

(lambda^2 M + lambda C + K) phi = 0, with the loss factors in a complex K. lambda = -zeta omega + j omega_d: omega is
|lambda|, which with much damping is not the undamped frequency. Shift-invert Arnoldi on the companion form with one
complex symmetric factor; every pair is then refined and its residual measured on the quadratic problem itself.

References: F. Tisseur, K. Meerbergen, SIAM Review 43 (2001) 235-286, doi:10.1137/S0036144500381988. Modal phase
collinearity: R. S. Pappa, K. B. Elliott, A. Schenk, Journal of Guidance, Control, and Dynamics 16 (1993) 858-862.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly
from femstruct.conventions import N_COMPONENTS
from femstruct.declared import expect
from femstruct.errors import FemstructError, NotConverged
from femstruct.modal.by_frequency import Varying, loss_terms
from femstruct.modal.damping import Damping, FromMaterials
from femstruct.modal.frf import lossy_matrices
from femstruct.sparse import FASTEST, SOLVERS, aligned

Complex = NDArray[np.complex128]
OFF_THE_AXIS: Final = 0.0137
"""Share by which the shift leaves the middle of the band and the imaginary axis: it must be no eigenvalue."""
FEW: Final = 600  # motions: a full matrix of twice as many takes three seconds, where iterations do not end
PATIENCE: Final = 100  # iterations of so few: others end within ten
SPARE: Final = 6  # eigenvalues beyond those wanted: nearer to the shift than the last wanted one, and of no use
REACH: Final = (
    0.707  # of the upper end: radius about the shift; modes of the band up to a damping ratio of 0.66 lie inside
)
OVERDAMPED: Final = 1e-6
"""Of |lambda|: with a smaller imaginary part a motion does not oscillate."""
STILL: Final = 1e-12  # of the upper end: what is lower is a motion that no stiffness resists, exactly, and has no mode
STRAINED: Final = 1e-6  # of a shape: what is less apart from all rigid-body motions is one of them, and rounding
BEYOND: Final = 1.5  # of the upper end: modes of the middle frequency that may be lower at their own
TURNS: Final = 25  # of the iteration to a mode's own frequency; three or four are enough
SETTLED: Final = 1e-11  # relative change of an eigenvalue
SAME: Final = 1e-8  # relative difference of two that are one
CONVERGED: Final = 1e-8  # residual of the quadratic problem, relative to its terms


@dataclass(frozen=True, eq=False)
class ComplexModes:
    """Complex modes, in the order of their frequencies.

    eigenvalues [m] : lambda [1/s], with positive imaginary parts. shapes [n_nodes, 7, m] : largest displacement 1, real
    there. residual [m] : of the quadratic problem, relative to its terms [1].

    A mass of 2 kg on a spring of 200 N/m with a dashpot of 4 Ns/m: omega 10 rad/s, zeta 0.1

    >>> lam = np.array([-1.0 + 1j * np.sqrt(99.0)])
    >>> modes = ComplexModes(lam, np.ones((1, 7, 1), complex), np.zeros(1))
    >>> modes.frequency_hz.round(6), modes.damping_ratio.round(6), modes.collinearity.round(6)
    (array([1.591549]), array([0.1]), array([1.]))
    """

    eigenvalues: Complex
    shapes: Complex
    residual: Floats

    def __post_init__(self) -> None:
        if self.shapes.shape[1:] != (N_COMPONENTS, len(self.eigenvalues)):
            got, expected = f"shapes {self.shapes.shape}", f"[n_nodes, {N_COMPONENTS}, {len(self.eigenvalues)}]"
            raise FemstructError("ComplexModes", got=got, expected=expected)

    @property
    def frequency_hz(self) -> Floats:
        """|lambda| / 2 pi [m] [Hz]: the undamped one where damping is proportional."""
        return np.abs(self.eigenvalues) / (2.0 * np.pi)

    @property
    def damped_hz(self) -> Floats:
        """Frequency of the free vibration [m] [Hz]."""
        return self.eigenvalues.imag / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> Floats:
        """zeta = -Re lambda / |lambda| [m] [1]."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)

    @property
    def collinearity(self) -> Floats:
        """Modal phase collinearity [m] [1]: 1 where all places move in step or against it, 0 for a running wave."""
        moved = self.shapes[:, :3].reshape(-1, len(self.eigenvalues))
        x, y = moved.real - moved.real.mean(axis=0), moved.imag - moved.imag.mean(axis=0)
        xx, yy, xy = (x * x).sum(axis=0), (y * y).sum(axis=0), (x * y).sum(axis=0)
        total = xx + yy
        apart = (xx - yy) ** 2 + 4.0 * xy**2
        share: Floats = np.divide(apart, total**2, out=np.ones_like(total), where=total > 0)
        return share


def complex_modes(assembly: Assembly, damping: Damping, up_to: float) -> ComplexModes:
    """Complex modes up to a frequency, from the matrices.

    Parameters
    ----------
    damping : Damping
        LossFactor, Rayleigh, FromMaterials, or none beside the dashpots; ratios belong to real modes and are refused.
    up_to : float
        Upper end of |lambda| / 2 pi [Hz].

    Raises
    ------
    InputError
        For a damping it cannot have, NotConverged where a residual stays above 1e-8.

    Notes
    -----
    A loss factor acts at all frequencies as at each mode's own, as in a frequency response; motions that only fade
    (overdamped) are left out. All modes with a damping ratio up to 0.66 are looked for; that none is missing is not
    proved, as it is for real modes. Of a free structure rounding errors of lambda = 0 are among them; `elastic_modes`
    leaves them out.

    Examples
    --------
    >>> from scipy.sparse import csc_array
    >>> from femstruct import LossFactor, given_matrices
    >>> K, M = csc_array([[300.0, -100.0], [-100.0, 100.0]]), csc_array([[1.0, 0.0], [0.0, 1.0]])
    >>> C = csc_array([[0.0, 0.0], [0.0, 4.0]])
    >>> chain = given_matrices(M, K, nodes=[0, 1], components=[2, 2], points=[[0, 0, 0.0], [0, 0, 1.0]], C=C)
    >>> found = complex_modes(chain, Damping(LossFactor(0.0)), up_to=10.0)
    >>> found.damping_ratio.round(4), found.collinearity.round(4)  # proportional damping would have 1
    (array([0.2241, 0.0152]), array([0.9933, 0.9766]))
    """
    expect("complex_modes", assembly, Assembly, "assemble makes one of a Model")
    expect("complex_modes damping", damping, Damping, "Damping(LossFactor(0.04)) is 4 % everywhere")
    expect("complex_modes up_to", up_to, float)
    K, C = lossy_matrices(assembly, damping)
    M = assembly.M
    top = 2.0 * np.pi * up_to
    parts = loss_terms(assembly, isinstance(damping.base, FromMaterials))
    if parts:
        return _each_at_its_own(assembly, (K, C, M), parts, top)
    values, vectors = _of_constant(K, C, M, top, 1.0)
    residual = _residual(values, vectors, K, C, M)
    return _complex_modes_of(assembly, values, vectors, residual)


def _of_constant(K: csc_array, C: csc_array, M: csc_array, top: float, reach: float) -> tuple[Complex, Complex]:
    """Eigenvalues up to a share `reach` of the upper end [rad/s], ascending, and shapes, of constant matrices."""
    pattern, (springs, losses, inertia) = aligned([K, C, M])
    shift = top / 2.0 * (1j * (1.0 + OFF_THE_AXIS) - OFF_THE_AXIS)
    analysis = SOLVERS[FASTEST](pattern)
    factor = analysis.factor(springs + shift * losses + shift**2 * inertia)
    values, vectors = _near(shift, top, M, C, lambda load: _complex(factor.solve(_complex(load))))
    kept = (values.imag > OVERDAMPED * np.abs(values)) & (np.abs(values) <= reach * top)
    order = np.argsort(np.abs(values[kept]), kind="stable")
    values, vectors = values[kept][order], vectors[:, kept][:, order]
    for i, value in enumerate(values):
        values[i], vectors[:, i] = _refined(value, vectors[:, i], K, C, M)
    moves = np.abs(values) > STILL * top
    return values[moves], vectors[:, moves]


def _each_at_its_own(
    assembly: Assembly, matrices: tuple[csc_array, csc_array, csc_array], parts: tuple[Varying, ...], top: float
) -> ComplexModes:
    """Of matrices that depend on frequency: modes of those at the middle, each then followed to its own frequency."""
    K, C, M = matrices
    middle = _sum(K, parts, top / 2.0)
    values, vectors = _of_constant(middle, C, M, top, BEYOND)
    residual = np.zeros(len(values))
    for i, value in enumerate(values):
        values[i], vectors[:, i], residual[i] = _followed(complex(value), vectors[:, i], matrices, parts)
    kept = np.flatnonzero(np.abs(values) <= top)
    order = kept[np.argsort(np.abs(values[kept]), kind="stable")]
    values, vectors, residual = values[order], vectors[:, order], residual[order]
    size = np.linalg.norm(vectors, axis=0)
    for i in range(1, len(values)):
        alike = abs(np.vdot(vectors[:, i - 1], vectors[:, i])) / (size[i - 1] * size[i])
        if abs(values[i] - values[i - 1]) < SAME * abs(values[i]) and alike > 1.0 - SAME:
            hz = abs(values[i]) / (2.0 * np.pi)
            raise NotConverged("complex modes", got=f"one mode twice, at {hz:.4g} Hz", do="use another --up-to")
    return _complex_modes_of(assembly, values, vectors, residual)


def _followed(
    value: complex,
    vector: Complex,
    matrices: tuple[csc_array, csc_array, csc_array],
    parts: tuple[Varying, ...],
) -> tuple[complex, Complex, float]:
    """An eigenvalue of matrices that depend on it, its shape and residual: inverse iteration, a factor each step."""
    K, C, M = matrices
    x = vector / np.linalg.norm(vector)
    own = K
    for _ in range(TURNS):
        own = _sum(K, parts, value / 1j)
        at = csc_array(own + value * C + value**2 * M)
        pattern, (entries,) = aligned([at])
        slope = _sum(csc_array(C + 2.0 * value * M), parts, value / 1j, slope=value)
        y = _complex(SOLVERS[FASTEST](pattern).factor(entries).solve(_times(slope, x)))
        step = complex(np.vdot(x, x) / np.vdot(x, y))
        value, x = value - step, y / np.linalg.norm(y)
        if abs(step) < SETTLED * abs(value):
            break
    own = _sum(K, parts, value / 1j)
    return value, x, float(_residual(np.array([value]), x[:, None], own, C, M)[0])


def _sum(matrix: csc_array, parts: tuple[Varying, ...], omega: complex, slope: complex = 0.0) -> csc_array:
    """A matrix with the parts at a frequency, or with their derivative by the eigenvalue `slope`, of those that grow
    with its square root; that of tables is left out, which costs a step or two."""
    total = matrix
    for part in parts:
        factor = part.factor(omega)
        if slope:
            factor = factor / (2.0 * slope) if part.grows else 0.0
        total = csc_array(total + factor * part.stiffness)
    return total


def _complex_modes_of(assembly: Assembly, values: Complex, vectors: Complex, residual: Floats) -> ComplexModes:
    """The modes, if all are converged."""
    if residual.size and residual.max() > CONVERGED:
        raise NotConverged("complex modes", got=f"a residual of {residual.max():.1e}", expected=f"{CONVERGED:g}")
    nodal = _times(assembly.dofs.T, vectors).reshape(len(assembly.points), N_COMPONENTS, len(values))
    return ComplexModes(values, _turned(nodal), residual)


def elastic_modes(found: ComplexModes, rigid: Floats) -> ComplexModes:
    """Those that are no rigid-body motions: of a free structure lambda = 0 is a double root, and what is found near it
    are rounding errors, with any damping.

    Parameters
    ----------
    rigid : Floats
        Shapes [n_nodes, 7, r] of the motions that strain nothing, as `ModalBasis.shapes` has them.
    """
    if not rigid.shape[2] or not len(found.eigenvalues):
        return found
    moved = found.shapes.reshape(-1, len(found.eigenvalues))
    motions = _complex(rigid.reshape(-1, rigid.shape[2]))
    left = np.linalg.norm(moved - motions @ np.linalg.lstsq(motions, moved)[0], axis=0)
    kept = left > STRAINED * np.linalg.norm(moved, axis=0)
    return ComplexModes(found.eigenvalues[kept], found.shapes[:, :, kept], found.residual[kept])


def _near(
    shift: complex, top: float, M: csc_array, C: csc_array, solve: Callable[[Complex], Complex]
) -> tuple[Complex, Complex]:
    """Eigenvalues and shapes within the circle about the shift that holds the band; more are looked for until one
    outside is found, or there are no more."""
    n = M.shape[0]

    def inverse(pair: Complex) -> Complex:
        x, y = pair[:n], pair[n:]
        u = -solve(_times(M, y + shift * x) + _times(C, x))
        return np.concatenate([u, x + shift * u])

    operator: Any = LinearOperator((2 * n, 2 * n), matvec=inverse, dtype=np.complex128)
    start = np.random.default_rng(11).standard_normal(2 * n).astype(np.complex128)
    count = min(20, 2 * n)
    while True:
        if 2 * n <= count + 2 * SPARE:
            inverted, pairs = _all(inverse, n)
        else:
            most = PATIENCE if n <= FEW else None
            try:
                inverted, pairs = eigs(operator, count + SPARE, v0=start, ncv=min(2 * n, 2 * count + 20), maxiter=most)
            except ArpackNoConvergence as error:  # rates beta K gather eigenvalues at -1 / beta
                if n > FEW:
                    got = f"{len(error.eigenvalues)} of {count + SPARE}"
                    raise NotConverged("complex modes", got=got) from error
                inverted, pairs = _all(inverse, n)
        found = np.abs(inverted) > 0.0
        values = shift + 1.0 / inverted[found]
        if (np.abs(values - shift) > REACH * top).any() or len(inverted) == 2 * n:
            return values, pairs[:n, found]
        count = min(2 * count, 2 * n)


def _refined(value: complex, vector: Complex, K: csc_array, C: csc_array, M: csc_array) -> tuple[complex, Complex]:
    """The root of the shape's own quadratic equation: its error is the square of the shape's."""
    roots = np.roots([complex(vector @ _times(matrix, vector)) for matrix in (M, C, K)])
    return complex(roots[np.argmin(np.abs(roots - value))]), vector


def _residual(values: Complex, vectors: Complex, K: csc_array, C: csc_array, M: csc_array) -> Floats:
    """|lambda^2 M phi + lambda C phi + K phi| over the size of its terms, before they cancel [m]."""
    left = _times(K, vectors) + _times(C, vectors) * values + _times(M, vectors) * values**2
    size = np.abs(vectors)
    terms = abs(K) @ size + (abs(C) @ size) * np.abs(values) + (abs(M) @ size) * np.abs(values) ** 2
    share: Floats = np.linalg.norm(left, axis=0) / np.linalg.norm(terms, axis=0)
    return share


def _turned(shapes: Complex) -> Complex:
    """Shapes with the largest displacement real and 1."""
    moved = shapes[:, :3].reshape(-1, shapes.shape[2])
    largest = moved[np.argmax(np.abs(moved), axis=0), np.arange(shapes.shape[2])]
    return shapes / np.where(largest == 0.0, 1.0, largest)


def _times(matrix: Any, vectors: Complex) -> Complex:
    return _complex(matrix @ vectors)


def _complex(values: Any) -> Complex:
    return np.asarray(values, dtype=np.complex128)


def _all(inverse: Callable[[Complex], Complex], n: int) -> tuple[Complex, Complex]:
    """All eigenvalues and vectors of an operator on 2 n, as a full matrix."""
    full = np.column_stack([inverse(column) for column in np.eye(2 * n, dtype=np.complex128)])
    inverted, pairs = np.linalg.eig(full)
    return inverted, pairs
