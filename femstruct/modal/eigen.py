"""Natural modes of K phi = omega^2 M phi: factors, block Lanczos, and a proof that no mode is missing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cholesky, eigh, solve_triangular
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats
from femstruct.errors import FemstructError, InputError, NotConverged, SingularSystem
from femstruct.sparse import FASTEST, SOLVERS, Analysis, Factored, Pattern, Values, ZeroPivot, aligned

# ----------------------------------------------------------------------------------------------------------------------
# Symmetric factors of K - sigma M: solving with them, and counting eigenvalues below sigma.
# ----------------------------------------------------------------------------------------------------------------------

# Reciprocal condition (rows and columns scaled by the diagonal) under which a matrix is looked at for a null vector.
# Sound structures reach about 1e-11 on meshes of 200 x 200; the look itself does not refuse anything.
_SUSPICIOUS = 1e-12
# A massless mechanism strains and weighs nothing but rounding: real modes have 1e-3 and more in one of the two.
_NO_ENERGY = 1e-10
# |sigma| x^T M x of a shape of x^T diag(A) x = 1: |sigma| / omega_max^2, 1e-14 and more, if it has any mass at all.
_MASSLESS = 1e-20


@dataclass(frozen=True, eq=False)
class Factor:
    """The factor of K - sigma M, sigma [rad^2/s^2] below the spectrum: `solve` takes [n] or [n, m]."""

    sigma: float
    solve: Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Pencil:
    """K and M on one pattern, which is analysed once for all shifts.

    stiffness, mass [nnz] : their values on the pattern.
    """

    K: csc_array
    M: csc_array
    pattern: Pattern
    stiffness: Values
    mass: Values
    analysis: Analysis

    @classmethod
    def of(cls, K: csc_array, M: csc_array, solver: str = FASTEST) -> Pencil:
        """The pencil of K and M, with one of the SOLVERS."""
        pattern, (stiffness, mass) = aligned([K, M])
        return cls(K, M, pattern, stiffness, mass, SOLVERS[solver](pattern))

    def shifted(self, sigma: float) -> Values:
        """Values of K - sigma M on the pattern."""
        values: Values = self.stiffness - sigma * self.mass
        return values

    def count_below(self, mu: float) -> int | None:
        """Number of eigenvalues omega^2 of (K, M) below mu: the negative ones of K - mu M.

        None when the count cannot be trusted, mu being too close to an eigenvalue. Move mu then.
        """
        terms = np.abs(self.stiffness[self.pattern.diagonal]) + np.abs(mu * self.mass[self.pattern.diagonal])
        if not (terms > 0).all():
            return None
        return self.analysis.negative(self.shifted(mu), terms)


def count_below(K: csc_array, M: csc_array, mu: float, solver: str = FASTEST) -> int | None:
    """The same for two matrices."""
    return Pencil.of(K, M, solver).count_below(mu)


def factorise(pencil: Pencil, sigma: float, labels: Sequence[str] = ()) -> Factor:
    """Factor of K - sigma M for sigma < 0, positive definite unless K and M share a null vector.

    Raises SingularSystem when they do, naming the degree of freedom that moves most (its number without `labels`).
    """
    values = pencil.shifted(sigma)
    diagonal: Floats = values[pencil.pattern.diagonal]
    if not (diagonal > 0).all():
        raise _singular(int(np.argmin(diagonal)), labels)
    try:
        factor = pencil.analysis.factor(values)
    except ZeroPivot:
        _refuse_null_vector(pencil, sigma, values, labels)
        factor = pencil.analysis.factor(_nudged(pencil.pattern, values, _NO_ENERGY * 1e-5))
    else:
        if _reciprocal_condition(factor, diagonal) < _SUSPICIOUS:
            _refuse_null_vector(pencil, sigma, values, labels)
    return Factor(sigma, factor.solve)


def _nudged(pattern: Pattern, values: Values, share: float) -> Values:
    """The values with a diagonal larger by a share of itself."""
    nudged = values.copy()
    nudged[pattern.diagonal] *= 1.0 + share
    return nudged


def _reciprocal_condition(factor: Factored, diagonal: Floats) -> float:
    """Upper estimate of the smallest eigenvalue of the matrix scaled to unit diagonal [1]."""
    root = np.sqrt(diagonal)
    start = np.random.default_rng(1).standard_normal(len(root))
    answer = root * factor.solve(root * start)
    size = float(np.linalg.norm(answer))
    return float(np.linalg.norm(start)) / size if np.isfinite(size) else 0.0


def _refuse_null_vector(pencil: Pencil, sigma: float, values: Values, labels: Sequence[str]) -> None:
    """Raise SingularSystem if the softest shape of K - sigma M has neither stiffness nor mass."""
    K, M, diagonal = pencil.K, pencil.M, values[pencil.pattern.diagonal]
    nudged = pencil.analysis.factor(_nudged(pencil.pattern, values, 1e-13))
    shape = np.random.default_rng(2).standard_normal(len(diagonal)) / np.sqrt(diagonal)
    for _ in range(3):  # inverse iteration: each step gains the ratio of the null vector to the next shape
        shape = nudged.solve(diagonal * shape)
        shape /= np.sqrt(shape @ (diagonal * shape))
    weighs = float(np.abs(shape) @ (abs(M) @ np.abs(shape)))
    massless = weighs < _MASSLESS / abs(sigma) or relative_energy(M, shape[:, None])[0] < _NO_ENERGY
    if massless and relative_energy(K, shape[:, None])[0] < _NO_ENERGY:
        raise _singular(int(np.argmax(np.abs(shape) * np.sqrt(diagonal))), labels)


def relative_energy(A: csc_array, shapes: Floats) -> Floats:
    """x^T A x / |x|^T |A| |x| of each column [m]: how much is left of the terms of its sum, eps if all cancel."""
    size = np.abs(shapes)
    total: Floats = (size * (abs(A) @ size)).sum(axis=0)
    energy: Floats = np.abs((shapes * (A @ shapes)).sum(axis=0))
    return np.divide(energy, total, out=np.zeros_like(energy), where=total > 0)


def _singular(index: int, labels: Sequence[str]) -> SingularSystem:
    return SingularSystem(
        labels[index] if labels else f"degree of freedom {index}",
        got="neither stiffness nor mass in a motion led by it",
        expected="an element, a spring or a mass that holds it",
        do="support it, join it, or give it a mass",
    )


# ----------------------------------------------------------------------------------------------------------------------
# Block Lanczos with full orthogonalisation for (K - sigma M)^-1 M: several right-hand sides at once, no restart.
# ----------------------------------------------------------------------------------------------------------------------

# Solves of several right-hand sides read the factor once. More of them at once need more vectors in all; rigid modes,
# up to six of one eigenvalue, are found together. Where a vector takes 4 MB and more, fewer of them are worth a tenth
# of the time: 20 modes of a million unknowns take 150 MB less.
BLOCK, BLOCK_OF_MANY = 8, 6
MANY = 500_000  # unknowns
MOST_VECTORS = 400
_NEGLIGIBLE = 1e-12  # of its length: what is left of a vector that lies in the space already


class Krylov:
    """An M-orthonormal basis Q of a Krylov space of (K - sigma M)^-1 M, and H = Q^T M (K - sigma M)^-1 M Q on it.

    The first `expanded` columns of Q have been multiplied; their images lie in Q altogether.
    """

    def __init__(self, M: csc_array, solve: Callable[[Floats], Floats]) -> None:
        self._M, self._solve = csr_array(M.T), solve
        self._heaviest = float(M.diagonal().max())
        self._block = BLOCK if M.shape[0] < MANY else BLOCK_OF_MANY
        self._rng = np.random.default_rng(0)
        self._Q = np.empty((M.shape[0], 0), order="F")
        self._H: Floats = np.zeros((0, 0))
        self._weighed: list[Floats] = []  # M times the columns that wait, in the blocks they came in
        self._columns = self.expanded = 0
        self.widen()

    def widen(self) -> None:
        """Add directions that chance chooses: they find what the others had no part of."""
        start = self._solve(self._M @ self._rng.standard_normal((self._M.shape[0], self._block)))
        size = float(np.linalg.norm(start, axis=0).max())
        self._append(*self._orthogonal(start)[1:], size)

    def expand(self) -> bool:
        """Multiply the next block; False where the space holds all that it can reach."""
        if not self._weighed:
            return False
        images = self._solve(self._weighed.pop(0))
        new = slice(self.expanded, self.expanded + images.shape[1])
        size = float(np.linalg.norm(images, axis=0).max())
        shares, left, weighed = self._orthogonal(images)
        before = self._columns
        triangle = self._append(left, weighed, size)
        self._H[:before, new] = shares
        self._H[before : self._columns, new] = triangle
        self.expanded = new.stop
        return True

    def ritz(self) -> tuple[Floats, Floats, Floats]:
        """Eigenvalues of (K - sigma M)^-1 M, descending, their vectors in Q, and the lengths of their residuals."""
        m = self.expanded
        inner = self._H[:m, :m]
        values, vectors = eigh(0.5 * (inner + inner.T))
        values, vectors = values[::-1], vectors[:, ::-1]
        return values, vectors, np.linalg.norm(self._H[m : self._columns, :m] @ vectors, axis=0)

    def shapes(self, vectors: Floats) -> Floats:
        """Shapes [n, k] of vectors [expanded, k] in Q."""
        product: Floats = self._Q[:, : self.expanded] @ vectors
        return product

    def _orthogonal(self, vectors: Floats) -> tuple[Floats, Floats, Floats]:
        """(shares of Q in the vectors, what is left of them, M times what is left); in the place of the vectors."""
        basis = self._Q[:, : self._columns]
        total = basis.T @ (self._M @ vectors)
        vectors -= basis @ total
        weighed = self._M @ vectors
        again = basis.T @ weighed  # rounding of the first pass: too small to weigh once more
        vectors -= basis @ again
        return total + again, vectors, weighed

    def _append(self, vectors: Floats, weighed: Floats, size: float) -> Floats:
        """M-orthonormal columns for the vectors, of which those that are rounding are dropped; returns R of Q R."""
        triangle: Floats = np.eye(vectors.shape[1])
        floor = (_NEGLIGIBLE * size) ** 2 * self._heaviest
        for _ in range(2):
            gram = vectors.T @ weighed
            squared, turn = eigh(0.5 * (gram + gram.T))
            kept = squared > max(floor, _NEGLIGIBLE**2 * squared[-1])
            root = np.sqrt(squared[kept])
            triangle = (root[:, None] * turn[:, kept].T) @ triangle
            vectors, weighed = vectors @ (turn[:, kept] / root), weighed @ (turn[:, kept] / root)
            if not len(root):
                return triangle
            floor = 0.0
        count = vectors.shape[1]
        self._reserve(self._columns + count)
        self._Q[:, self._columns : self._columns + count] = vectors
        self._weighed.append(weighed)
        self._columns += count
        return triangle

    def _reserve(self, columns: int) -> None:
        held = self._Q.shape[1]
        if columns > held:
            basis, inner = _room(len(self._Q), max(columns, 2 * held, 32 * BLOCK))
            basis[:, :held], inner[:held, :held] = self._Q, self._H
            self._Q, self._H = basis, inner


def _room(rows: int, columns: int) -> tuple[Floats, Floats]:
    """Q and H for so many columns; memory is taken only by those that are written."""
    return np.empty((rows, columns), order="F"), np.zeros((columns, columns))


def converge(space: Krylov, k: int, tol: float) -> tuple[Floats, Floats]:
    """The k largest eigenvalues of (K - sigma M)^-1 M, descending, and their shapes [n, k]; fewer if there are fewer.

    Parameters
    ----------
    tol : float
        Residual over eigenvalue; where rounding does not let it be reached, the space grows until it is complete.

    Raises
    ------
    NotConverged
        Where that would take more than MOST_VECTORS, some ten times what it takes as a rule.
    """
    look = k
    while True:
        if space.expanded >= look:
            values, vectors, residuals = space.ritz()
            if (residuals[:k] <= tol * values[:k]).all():
                return values[:k], space.shapes(vectors[:, :k])
            if space.expanded > max(MOST_VECTORS, 6 * k):
                reached = float((residuals[:k] / values[:k]).max())
                raise NotConverged(
                    "modes",
                    got=f"{k} modes to {reached:.1g} of their eigenvalues with {space.expanded} vectors",
                    expected=f"{tol:.1g}",
                    do="stiffnesses or masses lie too far apart: look for a mistaken unit or size, or ask for fewer",
                )
            look = space.expanded + max(BLOCK, space.expanded // 20)
        if not space.expand():
            values, vectors, _ = space.ritz()
            real = values[:k] > 1e-13 * values[0]  # massless shapes have no finite frequency
            return values[:k][real], space.shapes(vectors[:, :k][:, real])


# ----------------------------------------------------------------------------------------------------------------------
# Natural modes of K phi = omega^2 M phi: shift-invert block Lanczos, with a proof that none is missing.
# ----------------------------------------------------------------------------------------------------------------------

MOST_MODES = 3000  # they take minutes, and gigabytes in anything that rings for a while
# Modes times degrees of freedom: the search holds some five numbers for each, which are 6 GB, and takes minutes.
MOST_COMPONENTS = 150_000_000
_DENSE = 300  # degrees of freedom up to which full matrices cost less than the set-up of Lanczos
# A rigid mode strains nothing but rounding: 1e-16 of the terms of phi^T K phi at most on plates, frames and joints
# of all sizes tried. The softest elastic mode of a 400 x 400 plate has 1e-12, of a floor on springs at 0.2 Hz 1e-11.
UNSTRAINED = 2e-14
# Where K hardly touches a mode (a plate free to shift in its own plane, where no matrix entry resists), even the terms
# of phi^T K phi are rounding: up to 1e-17 |sigma| measured, 1e-18 |sigma| once the modes are separated. A real spring
# is told from none down to 3e-8 of the frequency of sigma, which is near the first elastic one, or the limit.
_UNTOUCHED = 1e-15
_SOFT = 1e-3  # of |sigma|: modes that may be rigid
_UNRESOLVED = 1e-10  # of |sigma|: below it eigenvalues by shift-invert are too coarse to count between
_SHIFT_RANGE = (0.005, 50.0)  # of |sigma| over the first elastic omega^2: no loss of digits and no slow convergence
_DROWNS = 1e-4  # of the guessed first elastic omega^2: a shift below it
_ATTEMPTS = 6
_GROUP = 1e-6  # between eigenvalues that are told apart: shapes are then good to 1e-10
_CONVERGED = 1e-11  # residual of an eigenvalue of the inverse over it; shapes are as good
_ROUGH = 16  # vectors that show the first elastic modes roughly: rigid ones, having one eigenvalue, take few


@dataclass(frozen=True, eq=False)
class Modes:
    """Undamped modes, ascending: eigenvalues omega^2 [k] (0 for rigid modes), mass-normalised shapes [n, k].

    n_rigid : how many modes are rigid. complete_below : no eigenvalue below it is missing [rad^2/s^2].
    pencil, sigma : K - sigma M has a factor near the first elastic mode, for residual vectors.
    """

    eigenvalues: Floats
    shapes: Floats
    n_rigid: int
    complete_below: float
    pencil: Pencil
    sigma: float


def modes(
    K: csc_array,
    M: csc_array,
    *,
    up_to_hz: float | None = None,
    count: int | None = None,
    labels: Sequence[str] = (),
    solver: str = FASTEST,
) -> Modes:
    """Undamped, mass-normalised modes, up to a frequency [Hz] or a number of them; none is skipped.

    Parameters
    ----------
    K, M : csc_array [n, n]
        Sparse, symmetric, positive semi-definite; K may have any number of rigid modes and mechanisms.
    labels : Sequence[str] [n]
        Names of the degrees of freedom, for messages.
    solver : str
        One of `femstruct.sparse.SOLVERS`.

    Raises
    ------
    SingularSystem
        When K and M share a null vector, NotConverged when the inertia count and the modes found do not agree after
        several attempts.

    Notes
    -----
    The shift is negative and set from the data, so a singular K is no special case. Completeness is proved by the
    number of negative eigenvalues of K - mu M above the last mode. The start vectors are fixed and the largest
    component (weighted by its mass) is positive: two runs on one machine and thread count agree in every bit.
    The shapes within a group of equal frequencies are one choice out of many.

    A mode is rigid when its strain energy is rounding: 2e-14 of the terms it is summed from, or, where no stiffness
    resists it but soft springs, 1e-15 |sigma|. So a structure on springs so soft that it floats below 1e-7 of its own
    first frequency counts as free where it strains in rounding (bending), and below 3e-8 where nothing else resists.

    Examples
    --------
    >>> two = csc_array(np.array([[2.0, -1.0], [-1.0, 2.0]]))
    >>> modes(two, csc_array(np.eye(2)), count=2).eigenvalues.round(12)
    array([1., 3.])
    """
    n = K.shape[0]
    if (up_to_hz is None) == (count is None):
        raise FemstructError("modes", got=f"up_to_hz={up_to_hz}, count={count}", expected="exactly one of the two")
    if n and not np.any(M.data):
        raise InputError("masses", got="a structure without mass", expected="some mass", do="give a density")
    pencil = Pencil.of(K, M, solver)
    if up_to_hz is not None:
        if not up_to_hz > 0:
            raise FemstructError("modes up_to", got=f"{up_to_hz:g} Hz", expected="a positive frequency")
        limit = (2.0 * np.pi * up_to_hz) ** 2
        mu, wanted = _count_near(pencil, limit)
        got = f"{wanted} modes below {up_to_hz:.4g} Hz"
        if wanted > MOST_MODES:
            raise InputError("modes up_to", got=got, expected=f"at most {MOST_MODES}", do="lower the frequency")
        _refuse_components("modes up_to", got, wanted, n, "lower the frequency or use larger cells")
        first = min(wanted + 2, n)
    else:
        assert count is not None
        if not 1 <= count <= n:
            raise FemstructError("modes count", got=f"{count}", expected=f"1 to {n}, the degrees of freedom")
        _refuse_components("modes count", f"{count} modes", count, n, "ask for fewer or use larger cells")
        limit, mu, wanted = np.inf, np.inf, count
        first = min(count + 3, n)
    values, shapes, sigma, complete = _complete(pencil, first, mu, wanted, labels)
    values, shapes, rigid = _classified(K, M, values, shapes, abs(sigma))
    if count is not None and np.isfinite(complete):
        complete = float(values[count])  # 0 of a rigid mode, which is rounding before
    if values.size and values.min() < 0:
        raise FemstructError("K", got=f"a mode of omega^2 = {values.min():.3g}", expected="no negative stiffness")
    keep = values <= limit if count is None else np.arange(len(values)) < count
    values, shapes, rigid = values[keep], shapes[:, keep], rigid[keep]
    return Modes(values, shapes, int(rigid.sum()), limit if count is None else complete, pencil, sigma)


def orthonormalise(M: csc_array, shapes: Floats) -> Floats:
    """The shapes [n, k] made M-orthonormal in their order, by Cholesky of their Gram matrix (twice is enough)."""
    for _ in range(2):
        gram = shapes.T @ (M @ shapes)
        root = cholesky(0.5 * (gram + gram.T), lower=True)
        shapes = solve_triangular(root, shapes.T, lower=True).T
    return np.ascontiguousarray(shapes)


def fix_signs(shapes: Floats, weights: Floats) -> Floats:
    """The shapes [n, k] with the sign that makes the largest of weights * component positive.

    Of components equal to 0.1 % (symmetric shapes have many) the first decides, so rounding cannot turn it.
    """
    size = np.abs(shapes) * weights[:, None]
    first = np.argmax(size >= 0.999 * size.max(axis=0), axis=0)
    return shapes * np.where(shapes[first, np.arange(shapes.shape[1])] < 0, -1.0, 1.0)


def _refuse_components(what: str, got: str, count: int, n: int, do: str) -> None:
    """Raise InputError, before the search, where as many shapes [n, wanted] do not fit into memory."""
    if count * n > MOST_COMPONENTS:
        most = f"at most {MOST_COMPONENTS // n} of so many"
        raise InputError(what, got=f"{got} of {n} degrees of freedom", expected=most, do=do)


def _count_near(pencil: Pencil, mu: float) -> tuple[float, int]:
    """The inertia count at mu, or above it where mu is too close to an eigenvalue: (mu used, count).

    Just above it as a rule; far above where mu itself drowns in the rounding of rigid modes.
    """
    for step in (1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5):
        found = pencil.count_below(mu * (1.0 + step))
        if found is not None:
            return mu * (1.0 + step), found
    raise NotConverged("inertia count", got=f"unusable pivots near omega^2 = {mu:.6g}", do="move the upper frequency")


def _shifted(pencil: Pencil, count: int, limit: float, labels: Sequence[str]) -> tuple[Factor, Krylov]:
    """A factor of K - sigma M with -sigma between the first elastic omega^2 and the highest asked for, and its space.

    Nearer to zero the rigid modes lose digits, farther away Lanczos converges slowly; in between both are harmless.
    """
    M = pencil.M
    stiffness, mass = pencil.K.diagonal(), M.diagonal()
    loaded = (mass > 0) & (stiffness > 0)
    # The coarsest and the finest shape of n degrees of freedom: n^2 apart in omega^2 in plates, n^(2/3) in solids.
    guess = float(np.median(stiffness[loaded] / mass[loaded])) / len(mass) ** 1.5 if loaded.any() else 1.0
    # `count` modes lie below a limit, so the first elastic one is above limit / wanted^2 or so. Where the limit is far
    # below all that is elastic, a shift as small would drown the modes between in rounding.
    if _DROWNS * guess < limit / (count + 1) < np.inf:
        factor = factorise(pencil, -limit / (count + 1), labels)
        return factor, Krylov(M, factor.solve)
    sigma = -guess
    for _ in range(_ATTEMPTS):
        factor = factorise(pencil, sigma, labels)
        space = Krylov(M, factor.solve)
        elastic = _rough_elastic(space, factor)
        if not elastic.size or _SHIFT_RANGE[0] * elastic[0] <= -sigma <= _SHIFT_RANGE[1] * elastic[0]:
            return factor, space
        sigma = -0.5 * float(elastic[0])
        del factor, space  # before the next is made
    factor = factorise(pencil, sigma, labels)
    return factor, Krylov(M, factor.solve)


def _rough_elastic(space: Krylov, factor: Factor) -> Floats:
    """Rough omega^2 of the first elastic modes, ascending: Ritz values of a few steps of inverse Lanczos."""
    while space.expanded < _ROUGH and space.expand():
        pass
    inverted = space.ritz()[0]
    inverted = inverted[inverted > 1e-12 * inverted[0]]
    values: Floats = factor.sigma + 1.0 / inverted
    return values[values > -1e-4 * factor.sigma]  # below are the rigid modes and their rounding


def _complete(
    pencil: Pencil, first: int, mu: float, count: int, labels: Sequence[str]
) -> tuple[Floats, Floats, float, float]:
    """Modes up to `count`, sought in a wider space until the inertia count agrees: (values, shapes, sigma, complete).

    The factor to solve with is gone when that to count with is made: of a million unknowns each takes 2 GB.
    """
    n = pencil.K.shape[0]
    ask, expected, found = first, 0, -1
    counted: int | None
    for attempt in range(_ATTEMPTS):
        values, shapes, sigma = _lowest(pencil, min(ask, n), (first, mu), attempt, labels)
        level, counted = mu, count
        if np.isinf(mu):
            if len(values) == n or len(values) < ask:
                return values, shapes, sigma, np.inf  # all modes there are
            upto = _gap(values, count, _UNRESOLVED * abs(sigma))
            if upto == len(values):
                ask *= 2
                continue
            level = 0.5 * (values[upto - 1] + values[upto])
            counted = pencil.count_below(level)
            if counted is None:
                ask += 4
                continue
        expected = counted
        found = int(np.count_nonzero(values < level))
        if found == expected:
            return values, shapes, sigma, float(values[count] if np.isinf(mu) else mu)
        ask = min(n, max(ask, expected) + 4 * (attempt + 1))
    got = f"{found} modes" if found >= 0 else "frequencies too close to count between"
    expects = f"{expected} by the inertia count" if found >= 0 else "a gap after the last one asked for"
    raise NotConverged("modes", got=got, expected=expects, do="ask for another number of modes or upper limit")


def _gap(values: Floats, count: int, resolved: float) -> int:
    """Index after `count` or a little later where the next eigenvalue is farthest off, to count in the gap; the
    number of values when there is none above `resolved`, or only equal ones."""
    later = np.arange(count, len(values))
    later = later[values[later] > resolved]
    apart = values[later] / values[later - 1].clip(resolved)
    return int(later[np.argmax(apart)]) if apart.max(initial=1.0) > 1.0 + _GROUP else len(values)


def _lowest(
    pencil: Pencil, k: int, request: tuple[int, float], attempt: int, labels: Sequence[str]
) -> tuple[Floats, Floats, float]:
    """The k lowest eigenpairs by shift-invert, ascending, M-orthonormal, signed, and the shift.

    Parameters
    ----------
    request : tuple[int, float]
        Number of modes and limit that the shift is chosen by.
    attempt : int
        How often modes were missing before; the space has as many more random directions.
    """
    n, M = pencil.K.shape[0], pencil.M
    factor, space = _shifted(pencil, *request, labels)
    for _ in range(attempt):
        space.widen()
    tol = _CONVERGED if attempt == 0 else 1e-2 * _CONVERGED
    if n <= _DENSE or k > n // 3:
        values, shapes = _dense(pencil.K, M, factor.sigma, k)
    else:
        inverted, shapes = converge(space, k, tol)
        values = factor.sigma + 1.0 / inverted
    del space  # a third of all memory
    order = np.argsort(values, kind="stable")
    values, shapes = values[order], orthonormalise(M, shapes[:, order])
    shapes = fix_signs(shapes, np.sqrt(np.abs(M.diagonal())))
    return values, _purified(M, factor, values, shapes), factor.sigma


def _dense(K: csc_array, M: csc_array, sigma: float, k: int) -> tuple[Floats, Floats]:
    """The k lowest eigenpairs by full matrices: the low half inverted, the high half direct.

    Direct, the error is eps omega_max^2 (it drowns low modes in stiff meshes); inverted, eps omega^4 / |sigma| (it
    drowns high ones). They are joined in the widest gap near sqrt(omega_max^2 |sigma|), where both are small.
    """
    full_M = M.toarray()
    try:
        inverted, low = eigh(full_M, K.toarray() - sigma * full_M)
    except LinAlgError:
        got = "a stiffness whose largest and smallest values are too far apart: the smallest are lost in rounding"
        do = "look for a size, a section or a unit that is wrong"
        raise InputError("modes", got=got, expected="stiffness within 15 decades", do=do) from None
    usable = inverted[::-1] > 1e-13 * inverted[-1]  # massless shapes have no finite frequency
    values = sigma + 1.0 / inverted[::-1][usable]
    low = low[:, ::-1][:, usable] / np.sqrt(inverted[::-1][usable])
    cut = len(values)
    try:
        direct, high = eigh(K.toarray(), full_M)
    except LinAlgError:
        pass  # M is singular: the inverted form is all there is
    else:
        level = np.sqrt(direct[-1] * abs(sigma))
        near = np.flatnonzero((direct[1:] > 0.1 * level) & (direct[:-1] < 10.0 * level))
        apart = direct[near + 1] / direct[near].clip(1e-3 * level)
        # Within a group of equal frequencies the two have shapes of their own choice, which do not fit together.
        if apart.max(initial=1.0) > 1.0 + _GROUP and len(direct) == len(values):
            cut = int(near[np.argmax(apart)]) + 1
            values = np.concatenate([values[:cut], direct[cut:]])
            low = np.concatenate([low[:, :cut], high[:, cut:]], axis=1)
    return values[:k], low[:, :k]


def _purified(M: csc_array, factor: Factor, values: Floats, shapes: Floats) -> Floats:
    """The shapes after one more inverse step of those that hardly strain.

    A sum of Lanczos vectors has rounding in all shapes there are; what is left of that in stiff ones weighs nothing,
    but strains by more than a rigid mode does. The step leaves sigma over their omega^2 of it.
    """
    soft = np.abs(values) < _SOFT * abs(factor.sigma)
    if not soft.any():
        return shapes
    purer = shapes.copy()
    purer[:, soft] = factor.solve(M @ shapes[:, soft])
    return fix_signs(orthonormalise(M, purer), np.sqrt(np.abs(M.diagonal())))


def _classified(
    K: csc_array, M: csc_array, values: Floats, shapes: Floats, scale: float
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """(values, shapes, which are rigid), ascending, rigid ones 0.

    Eigenvalues by shift-invert carry an error of eps |sigma|, Rayleigh quotients one of eps |phi|^T |K| |phi|. The
    modes that the stiffness hardly touches are better by quotients: they are separated by K projected on them.

    Parameters
    ----------
    scale : float
        |sigma| of the shift-invert [rad^2/s^2].
    """
    size = np.abs(shapes)
    slack = (size * (abs(K) @ size)).sum(axis=0) < scale
    if slack.any():
        projected = shapes[:, slack].T @ (K @ shapes[:, slack])
        found, turn = eigh(0.5 * (projected + projected.T))
        values, shapes = values.copy(), shapes.copy()
        values[slack] = np.where(np.abs(found) <= _UNTOUCHED * scale, 0.0, found)
        shapes[:, slack] = fix_signs(shapes[:, slack] @ turn, np.sqrt(np.abs(M.diagonal())))
    # Of those it does touch, only the lowest ones can strain nothing but rounding.
    unstrained = relative_energy(K, shapes) < UNSTRAINED
    rigid = np.where(slack, values == 0.0, np.logical_and.accumulate(slack | unstrained))
    values = np.where(rigid, 0.0, values)
    order = np.argsort(values, kind="stable")
    return values[order], shapes[:, order], rigid[order]
