"""Flat plates in space with ribs and walls: spectral elements of the first-order theory whose edges run along them.

Quadrilaterals of order p with Gauss-Lobatto nodes, mapped from the square by their corners (Karniadakis and Sherwin,
Spectral/hp Element Methods, 2005, chapters 2 and 4); strains of plates as in `tests.independent.ritz`, of bars after
Timoshenko. Gauss points integrate; of order 6 and more nothing locks.

Each node of a plate has u, v, w along the axes of its plate and the turns px, py of its normal: u(z) = u + z px. None
has a turn about the normal: that stores no energy in a plate, so that what is fastened along a line leaves it free.

- A bar under a plate touches its face along a line. There the three displacements and the turn about the bar are
  common; its two other turns are its own, for a thin plate could not let it shear else.
- A wall stands with an edge on a line of a plate. Displacements and the turn about the line are common; its turn
  about the upright is free, since the other's about its normal is.

Matrices are sparse; what is asked of them goes through natural modes and what loads do at rest (`Built.linear`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from tests.independent.frames import Floats, cross
from tests.independent.frames import Section as Shape
from tests.independent.linear import Linear, Way
from tests.independent.ritz import Section

U, V, W, PX, PY = range(5)
_NEAR = 1e-9  # m: the same place


@dataclass(frozen=True)
class Bar:
    """A rib: its ends [2] in coordinates of its plate; arm [3] : from there to its axis, in the plate's axes [m];
    face : height at which it touches the plate [m]. Its section stands upright: y across, z along the normal."""

    start: tuple[float, float]
    end: tuple[float, float]
    arm: tuple[float, float, float]
    face: float
    shape: Shape
    E: float
    G: float
    rho: float
    loss: float = 0.0


@dataclass(frozen=True)
class Plate:
    """quads [n, 4, 2] : corners of its elements in turn [m], side by side along whole edges; axes [3, 3] : rows x, y,
    normal; lossy : the section with each layer times its loss factor, if it has some; springs : per area to the ground,
    normal and along the plane, and the height of the face that they hold [m]; spring_loss : their loss factor."""

    quads: Floats
    section: Section
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    axes: Floats = field(default_factory=lambda: np.eye(3))
    lossy: Section | None = None
    springs: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spring_loss: float = 0.0


def lobatto(order: int) -> Floats:
    """Gauss-Lobatto nodes on -1 to 1: its ends and the roots of the derivative of Legendre's polynomial."""
    return np.r_[-1.0, np.sort(np.polynomial.legendre.Legendre.basis(order).deriv().roots().real), 1.0]


class Basis:
    """Lagrange's polynomials of Gauss-Lobatto nodes, by Legendre's."""

    def __init__(self, order: int) -> None:
        self.nodes = lobatto(order)
        self._inverse = np.linalg.inv(np.polynomial.legendre.legvander(self.nodes, order))
        self._each = [np.polynomial.legendre.Legendre.basis(i) for i in range(order + 1)]

    def values(self, at: Floats) -> Floats:
        """[points, nodes]."""
        return np.stack([one(np.asarray(at, float)) for one in self._each], axis=-1) @ self._inverse

    def slopes(self, at: Floats) -> Floats:
        return np.stack([one.deriv()(np.asarray(at, float)) for one in self._each], axis=-1) @ self._inverse


def _bilinear(s: Floats, t: Floats) -> Floats:
    """Shape functions of four corners in turn and their derivatives [3, points, 4]."""
    a, b = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    one, other = 1 + np.multiply.outer(s, a), 1 + np.multiply.outer(t, b)
    return np.stack([one * other, a * other, one * b]) / 4


def between_lines(places: Floats) -> Floats:
    """Quadrilaterals [n, 4, 2] of a grid of places [i, j, 2]."""
    places = np.asarray(places, float)
    ring = [places[:-1, :-1], places[1:, :-1], places[1:, 1:], places[:-1, 1:]]
    return np.stack(ring, axis=2).reshape(-1, 4, 2)


class Mesh:
    """Nodes of a plate [n, 2] and of each of its elements [elements, (p + 1)^2], x first."""

    def __init__(self, quads: Floats, basis: Basis) -> None:
        self.quads, self.basis = np.asarray(quads, float), basis
        s, t = (one.ravel() for one in np.meshgrid(basis.nodes, basis.nodes, indexing="ij"))
        places = np.einsum("pk,ekc->epc", _bilinear(s, t)[0], self.quads)
        keys = np.round(places.reshape(-1, 2) / _NEAR / 100).astype(np.int64)
        _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        self.nodes = places.reshape(-1, 2)[first]
        self.of = which.reshape(places.shape[:2])

    def on(self, start: Floats, end: Floats) -> Floats:
        """Edges of elements that lie between two places, in turn, by their nodes [edges, p + 1]."""
        step = np.asarray(end, float) - start
        length = float(np.hypot(*step))
        p = len(self.basis.nodes)
        grid = np.arange(p * p).reshape(p, p)
        found: dict[float, Floats] = {}
        for nodes in self.of:
            for side in (grid[0], grid[-1], grid[:, 0], grid[:, -1]):
                away = self.nodes[nodes[side]] - start
                along, across = away @ step / length, away @ [-step[1], step[0]] / length
                if (np.abs(across) < 1e-7).all() and along.min() > -1e-7 and along.max() < length + 1e-7:
                    turned = nodes[side] if along[0] < along[-1] else nodes[side][::-1]
                    found[round(float(along.min()), 6)] = turned
        if not found:
            raise ValueError(f"no edges of elements from {start} to {end}")
        return np.array([found[key] for key in sorted(found)])

    def inside(self, x: float, y: float) -> tuple[Floats, Floats]:
        """Nodes of the element at a place and their shares of its motion."""
        for corners, nodes in zip(self.quads, self.of, strict=True):
            s = t = 0.0
            for _ in range(20):
                N = _bilinear(np.array(s), np.array(t))
                off = np.array([x, y]) - N[0] @ corners
                step = np.linalg.solve((N[1:] @ corners).T, off)
                s, t = float(np.clip(s + step[0], -2, 2)), float(np.clip(t + step[1], -2, 2))
            if max(abs(s), abs(t)) < 1 + 1e-9:
                return nodes, np.outer(*(self.basis.values(np.array([one]))[0] for one in (s, t))).ravel()
        raise ValueError(f"({x}, {y}) is in no element")


def _element(corners: Floats, basis: Basis) -> tuple[Floats, Floats, Floats, Floats]:
    """Values [g, n] of an element at its Gauss points, derivatives along x and y, and weights [g]."""
    g, w = np.polynomial.legendre.leggauss(len(basis.nodes))
    s, t = (one.ravel() for one in np.meshgrid(g, g, indexing="ij"))
    J = np.einsum("dpk,kc->pdc", _bilinear(s, t)[1:], corners)
    N, S = basis.values(g), basis.slopes(g)
    n = len(basis.nodes)

    def both(one: Floats, other: Floats) -> Floats:
        return np.einsum("ai,bj->abij", one, other).reshape(n * n, n * n)

    local = np.stack([both(S, N), both(N, S)], axis=1)
    slopes = np.linalg.solve(J, local)
    return both(N, N), slopes[:, 0], slopes[:, 1], np.outer(w, w).ravel() * np.linalg.det(J)


def _plate_matrices(corners: Floats, of: Plate, basis: Basis) -> dict[str, Floats]:
    """K, H and M [5 n, 5 n] of an element, unknowns of each node side by side."""
    N, X, Y, weight = _element(corners, basis)
    size = N.shape[1]
    strain = np.zeros((len(N), 8, size, 5))
    for row, (one, other) in ((0, (U, V)), (3, (PX, PY))):
        strain[:, row, :, one], strain[:, row + 1, :, other] = X, Y
        strain[:, row + 2, :, one], strain[:, row + 2, :, other] = Y, X
    strain[:, 6, :, W], strain[:, 6, :, PX] = X, N
    strain[:, 7, :, W], strain[:, 7, :, PY] = Y, N
    rows = strain.reshape(-1, 8, 5 * size)

    def stiffness(some: Section) -> Floats:
        C = np.zeros((8, 8))
        C[:3, :3], C[:3, 3:6], C[3:6, :3], C[3:6, 3:6], C[6:, 6:] = some.A, some.B, some.B.T, some.D, some.S
        stress = np.einsum("p,ab,pbc->pac", weight, C, rows, optimize=True)
        return rows.reshape(-1, 5 * size).T @ stress.reshape(-1, 5 * size)

    I0, I1, I2 = of.section.mass
    inertia, springs = np.diag([I0, I0, I0, I2, I2]), np.zeros((5, 5))
    inertia[[U, V, PX, PY], [PX, PY, U, V]] = I1
    kn, ks, z = of.springs
    springs[W, W] = kn
    for flat, turn in ((U, PX), (V, PY)):
        springs[np.ix_([flat, turn], [flat, turn])] = ks * np.outer([1, z], [1, z])
    products = (N.T * weight) @ N
    ground = np.kron(products, springs)
    return {
        "K": stiffness(of.section) + ground,
        "H": (stiffness(of.lossy) if of.lossy else 0.0) + of.spring_loss * ground,
        "M": np.kron(products, inertia),
    }


def _bar_matrices(length: float, of: Bar, basis: Basis) -> tuple[Floats, Floats]:
    """K and M [6 n, 6 n] in its own axes: x along it, three displacements and three turns a node."""
    g, w = np.polynomial.legendre.leggauss(len(basis.nodes))
    N, S, w = basis.values(g), basis.slopes(g) * 2 / length, w * length / 2
    size = len(basis.nodes)
    strain = np.zeros((len(g), 6, size, 6))
    for row in range(6):  # stretch, shears, twist, curvatures
        strain[:, row, :, row] = S
    strain[:, 1, :, 5], strain[:, 2, :, 4] = -N, N
    rows = strain.reshape(len(g), 6, 6 * size)
    s = of.shape
    rigid = [of.E * s.A, s.ky * of.G * s.A, s.kz * of.G * s.A, of.G * s.J, of.E * s.Iy, of.E * s.Iz]
    K = np.einsum("p,par,a,pac->rc", w, rows, rigid, rows, optimize=True)
    inertia = of.rho * np.diag([s.A] * 3 + [s.Iy + s.Iz, s.Iy, s.Iz])
    return K, np.kron((N.T * w) @ N, inertia)


_OF_FIVE = np.zeros((2, 3, 5))  # displacement and rotation, of five unknowns
_OF_FIVE[0, :, :3] = np.eye(3)
_OF_FIVE[1, 0, PY], _OF_FIVE[1, 1, PX] = -1.0, 1.0


class Built:
    """Plates of one order with what is fastened to them; unknowns of all plates, then the own turns of bars."""

    def __init__(self, plates: Mapping[str, Plate], order: int = 7) -> None:
        self.plates, self.basis = dict(plates), Basis(order)
        self.meshes = {name: Mesh(one.quads, self.basis) for name, one in plates.items()}
        self.first, self.count = {}, 0
        for name, mesh in self.meshes.items():
            self.first[name] = self.count
            self.count += 5 * len(mesh.nodes)
        self._parts: dict[str, list[tuple[Floats, Floats]]] = {"K": [], "H": [], "M": []}
        self._tied: dict[int, dict[int, float]] = {}
        self._held: set[int] = set()
        for name, one in self.plates.items():
            mesh = self.meshes[name]
            for corners, nodes in zip(mesh.quads, mesh.of, strict=True):
                at = (self.first[name] + 5 * nodes[:, None] + np.arange(5)).ravel()
                self._add(at, _plate_matrices(corners, one, self.basis))

    def _add(self, at: Floats, matrices: Mapping[str, Floats]) -> None:
        for key, matrix in matrices.items():
            self._parts[key].append((at, matrix))

    def _unknowns(self, name: str, nodes: Floats) -> Floats:
        return self.first[name] + 5 * np.asarray(nodes)[:, None] + np.arange(5)

    def rib(self, name: str, bar: Bar) -> Built:
        """A bar along edges of the elements of a plate."""
        edges = self.meshes[name].on(np.array(bar.start), np.array(bar.end))
        x = np.append(np.array(bar.end) - bar.start, 0.0)
        x /= np.linalg.norm(x)
        axes = np.array([x, np.cross([0, 0, 1.0], x), [0, 0, 1.0]])
        touch = np.array([0.0, 0.0, bar.face])
        turned = np.zeros((3, 7))  # of the unknowns of a node and the bar's own turns about its y and z
        turned[:, :5] = np.outer(x, x @ _OF_FIVE[1])
        turned[:, 5:] = axes[1:].T
        face = np.hstack([_OF_FIVE[0] - cross(touch) @ _OF_FIVE[1], np.zeros((3, 2))])
        motion = np.vstack([axes @ (face - cross(np.array(bar.arm) - touch) @ turned), axes @ turned])
        chain = np.r_[edges[:, :-1].ravel(), edges[-1, -1]]
        own = dict(zip(chain.tolist(), self.count + 2 * np.arange(len(chain)), strict=True))
        self.count += 2 * len(chain)
        onto = np.kron(np.eye(len(self.basis.nodes)), motion)
        for nodes in edges:
            length = float(np.linalg.norm(np.subtract(*self.meshes[name].nodes[nodes[[-1, 0]]])))
            K, M = (onto.T @ one @ onto for one in _bar_matrices(length, bar, self.basis))
            turns = np.array([[own[node], own[node] + 1] for node in nodes.tolist()])
            at = np.hstack([self._unknowns(name, nodes), turns]).ravel()
            self._add(at, {"K": K, "M": M, "H": bar.loss * K})
        return self

    def stand(self, wall: str, start: tuple[float, float], end: tuple[float, float], on: str) -> Built:
        """A wall whose edge from a place to another, in its own coordinates, lies on edges of elements of a plate."""
        one, other = self.plates[wall], self.plates[on]
        foot = self.meshes[wall].on(np.array(start), np.array(end))
        nodes = np.unique(foot)
        places = self._in_space(wall, nodes)
        flat = (places - other.origin) @ other.axes[:2].T
        apart = np.linalg.norm(flat[:, None] - self.meshes[on].nodes[None], axis=2)
        if apart.min(axis=1).max() > 1e-7:
            raise ValueError("the foot of a wall is on nodes that its plate has not")
        step = np.append(np.array(end) - start, 0.0)
        line = one.axes.T @ (step / np.linalg.norm(step))
        own, theirs = self._unknowns(wall, nodes), self._unknowns(on, apart.argmin(axis=1))
        moved = one.axes @ other.axes.T
        about = line @ other.axes.T @ _OF_FIVE[1]  # the turn about the foot, of the plate's five
        for mine, its in zip(own, theirs, strict=True):
            for row in range(3):
                self._tied[int(mine[row])] = dict(zip(its[:3].tolist(), moved[row], strict=True))
            along = line @ one.axes.T @ _OF_FIVE[1]
            which = int(np.abs(along).argmax())
            if np.abs(np.delete(along, which)).max() > 1e-9:
                raise ValueError("the foot of a wall is along neither of its axes")
            self._tied[int(mine[which])] = dict(zip(its.tolist(), about / along[which], strict=True))
        return self

    def _in_space(self, name: str, nodes: Floats) -> Floats:
        one = self.plates[name]
        return np.asarray(one.origin + self.meshes[name].nodes[nodes] @ one.axes[:2])

    def hold(self, name: str, start: tuple[float, float], end: tuple[float, float], what: Sequence[int]) -> Built:
        """Unknowns of all nodes along edges of elements."""
        nodes = np.unique(self.meshes[name].on(np.array(start), np.array(end)))
        self._held |= set(self._unknowns(name, nodes)[:, list(what)].ravel().tolist())
        return self

    def onto(self) -> csr_array:
        """All unknowns of those that are free [all, free]."""
        free = np.setdiff1d(np.arange(self.count), [*self._tied, *self._held])
        where = np.full(self.count, -1)
        where[free] = np.arange(len(free))
        rows = [(one, int(where[one]), 1.0) for one in free.tolist()]
        rows += [
            (one, int(where[other]), share)
            for one, shares in self._tied.items()
            for other, share in shares.items()
            if where[other] >= 0
        ]
        row, column, value = zip(*rows, strict=True)
        return csr_array((value, (row, column)), shape=(self.count, len(free)))

    def matrix(self, key: str) -> csr_array:
        row, column, value = [], [], []
        for at, matrix in self._parts[key]:
            i, j = np.nonzero(matrix)
            row.append(at[i])
            column.append(at[j])
            value.append(matrix[i, j])
        if not row:
            return csr_array((self.count, self.count))
        entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
        return csr_array(coo_array(entries, shape=(self.count, self.count)))

    def row(self, name: str, x: float, y: float, way: str) -> Floats:
        """Of a motion of a place of a plate along or about a global axis [all]."""
        one, found = self.plates[name], np.zeros(self.count)
        nodes, shares = self.meshes[name].inside(x, y)
        axis = one.axes[:, "xyz".index(way[-1])]
        found[self._unknowns(name, nodes)] = np.outer(shares, axis @ _OF_FIVE[int(way[0] == "r")])
        return found

    def linear(self, rows: Mapping[Way, Floats], count: int = 30) -> Linear:
        """The structure in `count` natural modes and what forces at rows and weight do at rest: modes are exact, rest
        is, and responses below the last mode are but for a share (f / f_last)^4."""
        T = self.onto()
        K, M, H = (csc_array(T.T @ self.matrix(key) @ T) for key in ("K", "M", "H"))
        solved = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        inverse = LinearOperator(K.shape, matvec=solved.solve, dtype=np.float64)
        _, shapes = eigsh(K, count, M, sigma=0.0, OPinv=inverse, tol=1e-11, v0=np.ones(K.shape[0]))
        rides = (T.T @ self.matrix("M") @ self.ride()).T
        asked = {way: T.T @ row for way, row in rows.items()}
        at_rest = solved.solve(np.stack([*asked.values(), *rides], axis=1))
        at_rest -= shapes @ (shapes.T @ (M @ at_rest))
        at_rest /= np.sqrt(np.einsum("nk,nk->k", at_rest, M @ at_rest)) + 1e-300
        values, turns = np.linalg.eigh(at_rest.T @ (M @ at_rest))
        kept = values > 1e-10
        basis = np.hstack([shapes, at_rest @ (turns[:, kept] / np.sqrt(values[kept]))])
        small = [np.asarray(basis.T @ (one @ basis)) for one in (K, M, H)]
        K_, M_, H_ = (one / 2 + one.T / 2 for one in small)
        return Linear(K_, M_, 0 * K_, H_, {way: basis.T @ row for way, row in asked.items()}, rides @ basis)

    def ride(self) -> Floats:
        """Motion of all unknowns with the ground along x, y, z [all, 3]."""
        found = np.zeros((self.count, 3))
        for name, one in self.plates.items():
            for row in range(3):
                found[self._unknowns(name, np.arange(len(self.meshes[name].nodes)))[:, row]] = one.axes[row]
        return found
