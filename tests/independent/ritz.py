"""Rectangular plates by Ritz: Legendre polynomials, Kirchhoff's and the first-order theory, any A, B, D and As.

Reddy, Mechanics of Laminated Composite Plates and Shells (2004), chapters 3 and 10. x and y from a corner, z up from
the plane of reference; rotations are of the normal, u(z) = u + z px, v(z) = v + z py; thin plates have px = -w,x and
py = -w,y. Supports are linear constraints of the coefficients, held exactly: motions of a straight edge are polynomials
along it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import eigh, null_space

Floats = np.ndarray
Box = tuple[float, float, float, float]
"""x0, x1, y0, y1 [m]."""
U, V, W, PX, PY = range(5)


@dataclass(frozen=True)
class Ply:
    """A layer: moduli [Pa], thickness [m], angle of its axis 1 from x [rad], density [kg/m^3], loss factor."""

    E1: float
    E2: float
    nu12: float
    G12: float
    G23: float
    G13: float
    thickness: float
    angle: float = 0.0
    rho: float = 0.0
    loss: float = 0.0


def iso(E: float, nu: float, thickness: float, rho: float = 0.0, loss: float = 0.0) -> Ply:
    """An isotropic layer."""
    G = E / (2 * (1 + nu))
    return Ply(E, E, nu, G, G, G, thickness, 0.0, rho, loss)


@dataclass(frozen=True)
class Section:
    """Rigidities [3, 3] and [2, 2], and mass moments (I0, I1, I2) about the plane of reference."""

    A: Floats
    B: Floats
    D: Floats
    S: Floats
    mass: tuple[float, float, float] = (0.0, 0.0, 0.0)


def section(plies: Sequence[Ply], offset: float = 0.0, factor: float = 5 / 6, lossy: bool = False) -> Section:
    """Of layers from the lower face up, their middle `offset` above the plane of reference. factor : of shear. lossy :
    every layer times its loss factor, the imaginary part of complex moduli."""
    A, B, D, S, mass = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((2, 2)), np.zeros(3)
    z = offset - sum(ply.thickness for ply in plies) / 2
    for ply in plies:
        nu21 = ply.nu12 * ply.E2 / ply.E1
        Q = np.zeros((3, 3))
        Q[0, 0], Q[1, 1] = ply.E1 / (1 - ply.nu12 * nu21), ply.E2 / (1 - ply.nu12 * nu21)
        Q[0, 1] = Q[1, 0] = ply.nu12 * Q[1, 1]
        Q[2, 2] = ply.G12
        c, s = np.cos(ply.angle), np.sin(ply.angle)
        T = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        R = np.array([[c, s], [-s, c]])
        Q, G = T.T @ Q @ T, R.T @ np.diag([ply.G13, ply.G23]) @ R
        weight, top = ply.loss if lossy else 1.0, z + ply.thickness
        A += weight * Q * (top - z)
        B += weight * Q * (top**2 - z**2) / 2
        D += weight * Q * (top**3 - z**3) / 3
        S += weight * factor * G * (top - z)
        mass += ply.rho * np.array([top - z, (top**2 - z**2) / 2, (top**3 - z**3) / 3])
        z = top
    return Section(A, B, D, S, (float(mass[0]), float(mass[1]), float(mass[2])))


@dataclass
class Panel:
    """A plate of a by b [m]. thin : Kirchhoff's, which bends alone; flat : it stretches in its plane, too. order : of
    the polynomials. K, M grow by what is added."""

    a: float
    b: float
    thin: bool = False
    order: int = 9
    flat: bool = False
    K: Floats = field(init=False)
    M: Floats = field(init=False)
    held: list[Floats] = field(init=False, default_factory=list)
    fields: tuple[int, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.n = self.order + 1
        self.fields = ((U, V, W) if self.flat else (W,)) if self.thin else (U, V, W, PX, PY)
        size = len(self.fields) * self.n**2
        self.K, self.M = np.zeros((size, size)), np.zeros((size, size))

    def rows(self, x: Floats, y: Floats, what: int, dx: int = 0, dy: int = 0) -> Floats:
        """Of a field and its derivatives at points [n]: [n, all coefficients]."""
        if self.thin and what in (PX, PY):
            return -self.rows(x, y, W, dx + (what == PX), dy + (what == PY))
        along = []
        for at, length, times in ((x, self.a, dx), (y, self.b, dy)):
            each = [np.polynomial.legendre.Legendre.basis(i, domain=[0, length]).deriv(times) for i in range(self.n)]
            along.append(np.stack([one(np.asarray(at, float)) for one in each], axis=1))
        found = np.zeros((len(along[0]), len(self.K)))
        if what not in self.fields:
            return found
        first = self.fields.index(what) * self.n**2
        found[:, first : first + self.n**2] = np.einsum("pi,pj->pij", *along).reshape(len(found), -1)
        return found

    def points(self, box: Box | None = None) -> tuple[Floats, Floats, Floats]:
        """Places and weights of Gauss over a rectangle x0, x1, y0, y1; without one the whole plate."""
        x0, x1, y0, y1 = box or (0.0, self.a, 0.0, self.b)
        g, w = np.polynomial.legendre.leggauss(self.n + 1)
        X, Y = np.meshgrid(x0 + (x1 - x0) * (g + 1) / 2, y0 + (y1 - y0) * (g + 1) / 2, indexing="ij")
        return X.ravel(), Y.ravel(), np.outer(w, w).ravel() * (x1 - x0) * (y1 - y0) / 4

    def strains(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Of the middle and curvatures [n, 6, c], transverse shear strains [n, 2, c]."""

        def of(p: int, q: int) -> list[Floats]:
            return [self.rows(x, y, p, 1), self.rows(x, y, q, 0, 1), self.rows(x, y, p, 0, 1) + self.rows(x, y, q, 1)]

        gamma = [self.rows(x, y, W, 1) + self.rows(x, y, PX), self.rows(x, y, W, 0, 1) + self.rows(x, y, PY)]
        return np.stack([*of(U, V), *of(PX, PY)], axis=1), np.stack(gamma, axis=1)

    def stiffness(self, of: Section, box: Box | None = None) -> Floats:
        """K of a section over a rectangle or the whole plate, added to nothing."""
        x, y, w = self.points(box)
        e, g = self.strains(x, y)
        C = np.block([[of.A, of.B], [of.B, of.D]])
        K = np.einsum("p,pac,ab,pbd->cd", w, e, C, e, optimize=True)
        return K if self.thin else K + np.einsum("p,pac,ab,pbd->cd", w, g, of.S, g, optimize=True)

    def inertia(self, of: Section, box: Box | None = None) -> Floats:
        """M of a section over a rectangle or the whole plate, added to nothing; rotary inertia too."""
        x, y, w = self.points(box)
        I0, I1, I2 = of.mass
        M = np.zeros_like(self.K)
        for flat, turn in ((U, PX), (V, PY)):
            f, t = self.rows(x, y, flat), self.rows(x, y, turn)
            M += I0 * (f.T * w) @ f + I1 * ((f.T * w) @ t + (t.T * w) @ f) + I2 * (t.T * w) @ t
        f = self.rows(x, y, W)
        return M + I0 * (f.T * w) @ f

    def add(self, of: Section) -> Panel:
        """The plate itself."""
        self.K += self.stiffness(of)
        self.M += self.inertia(of)
        return self

    def spread(self, kn: float, ks: float, z: float, box: Box | None = None) -> Floats:
        """K of springs per area to the ground, normal and along the plane, on the face at z."""
        x, y, w = self.points(box)
        K = np.zeros_like(self.K)
        for k, f in (
            (kn, self.rows(x, y, W)),
            (ks, self.rows(x, y, U) + z * self.rows(x, y, PX)),
            (ks, self.rows(x, y, V) + z * self.rows(x, y, PY)),
        ):
            K += k * (f.T * w) @ f
        return K

    def at(self, x: float, y: float, what: int = W) -> Floats:
        """Row [c] of a motion at a point."""
        return self.rows(np.array([x]), np.array([y]), what)[0]

    def edge(self, name: str) -> tuple[Floats, Floats, Floats]:
        """Places and weights along an edge x0, x1, y0, y1; enough of them to hold polynomials exactly."""
        g, w = np.polynomial.legendre.leggauss(self.n + 1)
        length = self.b if name[0] == "x" else self.a
        along, still = length * (g + 1) / 2, np.zeros(len(g))
        if name[0] == "x":
            return still + (self.a if name[1] == "1" else 0.0), along, w * length / 2
        return along, still + (self.b if name[1] == "1" else 0.0), w * length / 2

    def hold(self, name: str, kind: str) -> Panel:
        """An edge: "simple" (u, v, w; of the first-order theory soft), "hard" (rotation along it, too), "clamped"."""
        x, y, _ = self.edge(name)
        across, along = (PX, PY) if name[0] == "x" else (PY, PX)
        what = [U, V, W] + ([along] if kind in ("hard", "clamped") else []) + ([across] if kind == "clamped" else [])
        self.held += [self.rows(x, y, one) for one in what]
        return self

    def free(self) -> Floats:
        """Coefficients that the supports leave [c, free]."""
        if not self.held:
            return np.eye(len(self.K))
        rows = [one / np.abs(one).max() for one in self.held if one.any()]
        return null_space(np.vstack(rows), rcond=1e-9)

    def modes(self, count: int) -> tuple[Floats, Floats]:
        """Natural frequencies [Hz] and mass-normalised coefficients [c, count]; those at rest left out."""
        Z = self.free()
        squares, found = eigh(Z.T @ self.K @ Z, Z.T @ self.M @ Z)
        still = int(np.sum(squares < 1e-7 * squares[min(len(squares) - 1, 12)]))
        pick = slice(still, still + count)
        return np.sqrt(squares[pick]) / (2 * np.pi), Z @ found[:, pick]

    def rest(self, load: Floats) -> Floats:
        """Coefficients under a load [c]."""
        Z = self.free()
        return Z @ np.linalg.solve(Z.T @ self.K @ Z, Z.T @ load)

    def weight(self, mass: float) -> Floats:
        """Load [c] of a mass per area [kg/m^2] under gravity, downwards."""
        x, y, w = self.points()
        return -9.80665 * mass * w @ self.rows(x, y, W)
