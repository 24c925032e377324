"""Frames in space by dense matrices: slender ones of the textbook's bars (Euler and Bernoulli) with consistent mass;
any others, with bodies, springs, dashpots, arms and equations, by bars that shear (Timoshenko) of a high order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from scipy.linalg import eig, eigh, null_space

Floats = np.ndarray


@dataclass(frozen=True)
class Tube:
    """A round tube of one material: bends alike in all directions, so it needs no direction across."""

    outer: float
    thickness: float
    E: float
    nu: float
    rho: float

    @property
    def area(self) -> float:
        return pi / 4 * (self.outer**2 - (self.outer - 2 * self.thickness) ** 2)

    @property
    def second_moment(self) -> float:
        return pi / 64 * (self.outer**4 - (self.outer - 2 * self.thickness) ** 4)


def matrices(tube: Tube, nodes: Floats, bars: Sequence[tuple[int, int]]) -> tuple[Floats, Floats]:
    """Stiffness and mass, six motions a node: x y z, then turns about them."""
    K = np.zeros((6 * len(nodes), 6 * len(nodes)))
    M = np.zeros_like(K)
    for start, end in bars:
        along = nodes[end] - nodes[start]
        length = float(np.linalg.norm(along))
        first = along / length
        second = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
        second /= np.linalg.norm(second)
        turn = np.kron(np.eye(4), np.array([first, second, np.cross(first, second)]))
        k, m = _bar(tube, length)
        at = np.r_[6 * start : 6 * start + 6, 6 * end : 6 * end + 6]
        K[np.ix_(at, at)] += turn.T @ k @ turn
        M[np.ix_(at, at)] += turn.T @ m @ turn
    return K, M


def _bar(tube: Tube, L: float) -> tuple[Floats, Floats]:
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    I, mass = tube.second_moment, tube.rho * tube.area * L  # noqa: E741
    pair, share = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    G = tube.E / 2 / (1 + tube.nu)
    for at, stiffness, inertia in (
        ([0, 6], tube.E * tube.area / L, mass),
        ([3, 9], G * 2 * I / L, 2 * tube.rho * I * L),
    ):
        k[np.ix_(at, at)] += stiffness * pair
        m[np.ix_(at, at)] += inertia * share
    bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) * tube.E * I / L**3
    sway = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * mass / 420
    for at, sign in (([1, 5, 7, 11], 1), ([2, 4, 8, 10], -1)):  # a turn about y lowers z
        size = np.array([1, sign * L, 1, sign * L])
        k[np.ix_(at, at)] += bend * np.outer(size, size)
        m[np.ix_(at, at)] += sway * np.outer(size, size)
    return k, m


def cut(corners: Floats, pieces: int) -> tuple[Floats, list[tuple[int, int]]]:
    """Nodes and bars of a line through corners, each stretch cut in equal pieces."""
    shares = np.arange(1, pieces + 1)[:, None] / pieces
    nodes = [corners[:1]] + [a + (b - a) * shares for a, b in pairwise(corners)]
    whole = np.vstack(nodes)
    return whole, [(i, i + 1) for i in range(len(whole) - 1)]


def tip_at_rest(tube: Tube, corners: Floats, force: Floats) -> Floats:
    """The six motions of the last corner under a force there; the first corner is clamped."""
    K, _ = matrices(tube, *cut(corners, 1))
    load = np.zeros(len(K))
    load[-6:-3] = force
    return np.linalg.solve(K[6:, 6:], load[6:])[-6:]


def clamped_frequencies(tube: Tube, corners: Floats, count: int, pieces: int = 12) -> Floats:
    """Natural frequencies [Hz]; the first corner is clamped."""
    K, M = matrices(tube, *cut(corners, pieces))
    return np.sqrt(eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[:count]) / 2 / pi


# Frames of any section by energies: fibres at rest and in motion of stiff sections that shear (Timoshenko), in vectors


_UNSHEARED = 1e8  # shear of a bar that does not shear, in its stiffness in bending over the square of its length


@dataclass(frozen=True)
class Section:
    """Area, second moments about local y and z, torsion constant, shear coefficients; corners : outermost (y, z);
    arm : the largest shear stress of torsion over T / J."""

    A: float
    Iy: float
    Iz: float
    J: float
    ky: float = 5 / 6
    kz: float = 5 / 6
    corners: tuple[tuple[float, float], ...] = ()
    arm: float = 0.0


def section(shape: str, **side: float) -> Section:
    """From its sides; torsion of thin walls by Bredt or as strips, of a rectangle by Saint-Venant's series."""
    if shape in ("circle", "tube"):
        D = side["diameter"] if shape == "circle" else side["outer"]
        d = D - 2 * side.get("thickness", D / 2)
        I, q = pi / 64 * (D**4 - d**4), (1 + (d / D) ** 2) ** 2  # noqa: E741
        k = 6 * q / (7 * q + 20 * (d / D) ** 2)  # Cowper, nu = 0
        return Section(pi / 4 * (D**2 - d**2), I, I, 2 * I, k, k, arm=D / 2)
    b, h = side["width"], side["height"]
    corners = tuple((y * b / 2, z * h / 2) for y in (-1, 1) for z in (-1, 1))
    if shape == "rectangle":
        long, thin = max(b, h), min(b, h)
        odd = np.arange(1.0, 400.0, 2.0)
        series = float((np.tanh(odd * pi * long / 2 / thin) / odd**5).sum())
        J = long * thin**3 / 3 * (1 - 192 / pi**5 * thin / long * series)
        inner = 8 / pi**2 * float((1 / np.cosh(np.minimum(odd * pi * long / 2 / thin, 700)) / odd**2).sum())
        return Section(b * h, b * h**3 / 12, h * b**3 / 12, J, 5 / 6, 5 / 6, corners, thin * (1 - inner))
    if shape == "box":
        t = side["thickness"]
        B, H, A = b - t, h - t, b * h - (b - 2 * t) * (h - 2 * t)
        Iy, Iz = ((u * v**3 - (u - 2 * t) * (v - 2 * t) ** 3) / 12 for u, v in ((b, h), (h, b)))
        J = 4 * (B * H) ** 2 * t / (2 * (B + H))
        return Section(A, Iy, Iz, J, 2 * t * B / A, 2 * t * H / A, corners, J / (2 * B * H * t))
    w, f = side["web"], side["flange"]
    A = 2 * b * f + w * (h - 2 * f)
    Iy = (b * h**3 - (b - w) * (h - 2 * f) ** 3) / 12
    J = (2 * b * f**3 + (h - f) * w**3) / 3
    Iz = (2 * f * b**3 + (h - 2 * f) * w**3) / 12
    return Section(A, Iy, Iz, J, 5 / 6 * 2 * b * f / A, w * (h - f) / A, corners, max(w, f))


def cross(r: Floats) -> Floats:
    """The matrix of r x."""
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]], float)


def arm(r: Floats) -> Floats:
    """Six motions at the end of a rigid arm r from those at its start."""
    moved = np.eye(6)
    moved[:3, 3:] = -cross(np.asarray(r, float))
    return moved


def axes(along: Floats, up: Floats | None) -> Floats:
    """Rows: local x, y and z; z as near to `up` as it can, which is global z, or x for upright bars."""
    x = along / np.linalg.norm(along)
    if up is None:
        up = np.array([1.0, 0, 0]) if abs(x[2]) > 1 - 1e-7 else np.array([0, 0, 1.0])
    z = np.asarray(up, float) - np.dot(up, x) * x
    z /= np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])


class Skeleton:
    """Bars, bodies, springs and dashpots between places with six motions each; held and tied by equations."""

    def __init__(self, order: int = 7) -> None:
        self.at: list[Floats] = []
        self.bars: list[tuple[Floats, Floats, Floats, Section, tuple[float, float], float]] = []  # motions, arms, axes
        self._terms: dict[str, list[tuple[Floats, Floats]]] = {"K": [], "M": [], "C": [], "H": []}
        self._equations: list[dict[int, float]] = []
        self._order = order
        x = -np.cos(pi * np.arange(order + 1) / order)
        powers = np.linalg.inv(np.vander(x, increasing=True))
        self._powers, self._x = powers, x

    def place(self, at: Floats) -> int:
        self.at.append(np.asarray(at, float))
        return len(self.at) - 1

    def _shapes(self, x: Floats) -> tuple[Floats, Floats]:
        """Values and slopes of the polynomials through the places of a bar, at x from -1 to 1."""
        n = np.arange(self._order + 1)
        slopes = np.where(n > 0, n * np.asarray(x)[:, None] ** np.maximum(n - 1, 0), 0.0)
        return np.asarray(x)[:, None] ** n @ self._powers, slopes @ self._powers

    def add(self, kind: str, places: Sequence[int], matrix: Floats) -> None:
        """A matrix of six motions of each place; K stiffness, M mass, C dashpots, H the lossy part of the stiffness."""
        motions = (6 * np.array(places)[:, None] + np.arange(6)).ravel()
        self._terms[kind].append((motions, matrix))

    def bar(
        self, a: int, b: int, shape: Section, E: float, G: float | tuple[float, float], rho: float,
        up: Floats | None = None,
        arms: tuple[Floats, Floats] = (np.zeros(3), np.zeros(3)), line_mass: float = 0.0, loss: float = 0.0,
        slender: bool = False,
    ) -> None:  # fmt: skip
        """A straight bar from the tip of an arm at a to one at b, by one element of a high order.

        slender : Euler's and Bernoulli's, whose sections neither shear nor resist to be turned about y and z. G : of
        shear along y and along z, where they differ; a twist has both, and the root of their product is taken.

        Strains at a section: u' . t, e . u' + (t x e) . turns of both shears, and the turns' slopes.
        """
        Gy, Gz = G if isinstance(G, tuple) else (G, G)
        twisted = float(np.sqrt(Gy * Gz))
        start, end = self.at[a] + arms[0], self.at[b] + arms[1]
        L, R = float(np.linalg.norm(end - start)), axes(end - start, up)
        inner = [self.place(start + (end - start) * (1 + x) / 2) for x in self._x[1:-1]]
        places, n = [a, *inner, b], self._order + 1
        lever = np.eye(6 * n)
        lever[:6, :6], lever[-6:, -6:] = arm(arms[0]), arm(arms[1])
        gauss, weights = np.polynomial.legendre.leggauss(n)
        N, D = self._shapes(gauss)
        B = self._strains(R, N, D * 2 / L)
        ky, kz = (
            (_UNSHEARED * E / twisted * max(shape.Iy, shape.Iz) / shape.A / L**2,) * 2
            if slender
            else (shape.ky, shape.kz)
        )
        law = np.diag([E * shape.A, Gy * ky * shape.A, Gz * kz * shape.A])
        law = np.pad(law, (0, 3)) + np.diag([0, 0, 0, twisted * shape.J, E * shape.Iy, E * shape.Iz])
        K = np.einsum("g,gia,ij,gjb->ab", weights * L / 2, B, law, B)
        ring = R.T @ np.diag([shape.Iy + shape.Iz, shape.Iy * (not slender), shape.Iz * (not slender)]) @ R * rho
        inertia = np.zeros((6, 6))
        inertia[:3, :3], inertia[3:, 3:] = np.eye(3) * (rho * shape.A + line_mass), ring
        M = np.kron(np.einsum("g,ga,gb->ab", weights * L / 2, N, N), inertia)
        for kind, matrix in (("K", K), ("H", loss * K), ("M", M)):
            self.add(kind, places, lever.T @ matrix @ lever)
        motions = (6 * np.array(places)[:, None] + np.arange(6)).ravel()
        self.bars.append((motions, lever, R, shape, (E, twisted), L))

    @staticmethod
    def _strains(R: Floats, N: Floats, D: Floats) -> Floats:
        """Of stretch, shear along y and z, twist, bending about y and z [places, 6, motions]."""
        turn = np.zeros((3, 3))
        turn[1], turn[2] = -R[2], R[1]  # gamma_y = v' - turn about z; gamma_z = w' + turn about y
        B = np.zeros((len(N), 6, 6 * N.shape[1]))
        for k in range(N.shape[1]):
            at = slice(6 * k, 6 * k + 3), slice(6 * k + 3, 6 * k + 6)
            B[:, :3, at[0]] = D[:, k, None, None] * R
            B[:, :3, at[1]] = N[:, k, None, None] * turn
            B[:, 3:, at[1]] = D[:, k, None, None] * R
        return B

    def stresses(self, motions: Floats, steps: int = 2) -> Floats:
        """Von Mises's stress at the corners of every bar's section [bar, place, corner], of stretch, bending and the
        largest shear of torsion; places are even along bars."""
        found = []
        for where, lever, R, shape, (E, G), L in self.bars:
            N, D = self._shapes(np.linspace(-1, 1, steps))
            strain = self._strains(R, N, D * 2 / L) @ (lever @ motions[where])
            y, z = np.array(shape.corners).T
            normal = E * (strain[:, :1] + strain[:, 4:5] * z - strain[:, 5:6] * y)
            found.append(np.sqrt(np.abs(normal) ** 2 + 3 * np.abs(G * shape.arm * strain[:, 3:4]) ** 2))
        return np.array(found)

    def between(self, motions: Floats, steps: int) -> Floats:
        """Displacements of even places along every bar [bar, place, 3]."""
        found = []
        for where, lever, _, _, _, _ in self.bars:
            N, _ = self._shapes(np.linspace(-1, 1, steps))
            found.append(N @ (lever @ motions[where]).reshape(-1, 6)[:, :3])
        return np.array(found)

    def spring(
        self, a: int, b: int | None, stiffness: Floats, dashpots: Floats | None = None, loss: float = 0.0
    ) -> None:
        """Between two places that coincide, or a place and the ground, direction by direction."""
        places, sign = ([a], [1.0]) if b is None else ([a, b], [1.0, -1.0])
        for kind, sizes in (("K", stiffness), ("C", dashpots), ("H", loss * np.asarray(stiffness))):
            if sizes is not None:
                self.add(kind, places, np.kron(np.outer(sign, sign), np.diag(np.asarray(sizes, float))))

    def body(self, a: int, mass: float, tensor: Floats | None = None, offset: Floats | None = None) -> None:
        """A rigid body: mass, tensor of inertia about its centre, and the way from the place to that."""
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = mass * np.eye(3), np.zeros((3, 3)) if tensor is None else tensor
        lever = arm(np.zeros(3) if offset is None else offset)
        self.add("M", [a], lever.T @ M @ lever)

    def equation(self, terms: dict[tuple[int, int], float]) -> None:
        """A sum of motions (place, direction), each by its factor, that stays zero."""
        self._equations.append({6 * place + direction: factor for (place, direction), factor in terms.items()})

    def hold(self, a: int, directions: Sequence[int] = range(6)) -> None:
        for one in directions:
            self.equation({(a, one): 1.0})

    def follow(self, leader: int, follower: int, directions: Sequence[int] = range(6)) -> None:
        """The follower moves with the leader, on a rigid arm, in the directions named."""
        lever = arm(self.at[follower] - self.at[leader])
        for one in directions:
            terms = {(leader, k): -lever[one, k] for k in range(6) if lever[one, k]}
            self.equation({**terms, (follower, one): 1.0})

    def matrix(self, kind: str) -> Floats:
        whole = np.zeros((6 * len(self.at), 6 * len(self.at)))
        for motions, matrix in self._terms[kind]:
            whole[np.ix_(motions, motions)] += matrix
        return whole

    def free(self) -> Floats:
        """Columns: motions that hold all equations."""
        size = 6 * len(self.at)
        if not self._equations:
            return np.eye(size)
        rows = np.zeros((len(self._equations), size))
        for row, terms in zip(rows, self._equations, strict=True):
            for motion, factor in terms.items():
                row[motion] += factor
        used = np.flatnonzero(rows.any(axis=0))
        others = np.delete(np.arange(size), used)
        inside = null_space(rows[:, used], rcond=1e-12)
        T = np.zeros((size, len(others) + inside.shape[1]))
        T[others, np.arange(len(others))] = 1.0
        T[used, len(others) :] = inside
        return T

    def modes(self, count: int | None = None) -> tuple[Floats, Floats]:
        """Natural frequencies [Hz], shapes of unit modal mass; the eigenvalues 1 / (w^2 + s) need no inertia of all."""
        T = self.free()
        K, M = T.T @ self.matrix("K") @ T, T.T @ self.matrix("M") @ T
        shift = 1.0
        values, shapes = eigh(M, K + shift * M)
        kept = values > 1e-14 * values[-1]
        values, shapes = values[kept][::-1], shapes[:, kept][:, ::-1]
        w2 = np.maximum(1 / values - shift, 0.0)[:count]
        return np.sqrt(w2) / 2 / pi, (T @ shapes / np.sqrt(values))[:, :count]

    def load(self, forces: dict[tuple[int, int], float], weight: float = 0.0) -> Floats:
        """Forces by (place, direction); weight : gravity against z."""
        F = np.zeros(6 * len(self.at))
        for (place, direction), size in forces.items():
            F[6 * place + direction] += size
        down = np.tile([0, 0, -1.0, 0, 0, 0], len(self.at))
        return F + weight * (self.matrix("M") @ down) if weight else F

    def rest(self, F: Floats) -> Floats:
        T = self.free()
        return T @ np.linalg.solve(T.T @ self.matrix("K") @ T, T.T @ F)

    def pushes(self, motions: Floats, F: Floats) -> Floats:
        """What holds and ties take up: forces on them, motion by motion."""
        return F - self.matrix("K") @ motions

    def shaken(
        self, frequency: Floats, F: Floats, ratio: float = 0.0, loss: float = 0.0, alpha: float = 0.0, beta: float = 0.0
    ) -> Floats:
        """Complex motions [frequency, motions] under e^{jwt}; ratio : of every mode, in proportion to its mass."""
        T = self.free()
        K, M, C, H = (T.T @ self.matrix(kind) @ T for kind in "KMCH")
        own, shapes = self.modes()
        if shapes.shape[1] == T.shape[1] and not C.any() and not H.any():  # modes are not coupled
            w0, w = 2 * pi * own, 2 * pi * np.asarray(frequency)[:, None]
            rates = 2 * ratio * w0 + alpha + beta * w0**2
            return (shapes.T @ F) / (w0**2 * (1 + 1j * loss) - w**2 + 1j * w * rates) @ shapes.T
        if ratio:
            lean = self.matrix("M") @ shapes
            C = C + T.T @ (lean * (4 * pi * ratio * own)) @ lean.T @ T
        C, H = C + alpha * M + beta * K, H + loss * K
        w = 2 * pi * np.asarray(frequency)[:, None, None]
        reduced = np.linalg.solve(K + 1j * H + 1j * w * C - w**2 * M, (T.T @ F)[:, None])
        return reduced[..., 0] @ T.T

    def poles(self, count: int, alpha: float = 0.0, beta: float = 0.0) -> Floats:
        """Complex eigenvalues with dashpots, above the real axis, by size; all motions must have mass."""
        T = self.free()
        K, M, C = (T.T @ self.matrix(kind) @ T for kind in "KMC")
        C, none = C + alpha * M + beta * K, np.zeros_like(K)
        values = eig(np.block([[none, np.eye(len(K))], [-K, -C]]), np.block([[np.eye(len(K)), none], [none, M]]))[0]
        upper = values[np.isfinite(values) & (values.imag > 0)]
        return upper[np.argsort(abs(upper))][:count]
