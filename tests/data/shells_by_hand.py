"""Shells of quadrilaterals or triangles, assembled without the package's own assembly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from femstruct.elements import quad_shell, triangle_shell

UX, UY, UZ, RX, RY, RZ = range(6)


def isotropic(E, nu, t):
    """A, B, D and As of a plate of one isotropic material, with the shear correction 5/6."""
    Q = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    return t * Q, 0 * Q, t**3 / 12 * Q, 5 / 6 * E / (2 * (1 + nu)) * t * np.eye(2)


def grid(nx, ny):
    """Places in the unit square and quadrilaterals of nx x ny; the nodes run along y first."""
    nodes = np.array([(i / nx, j / ny) for i in range(nx + 1) for j in range(ny + 1)])
    first = np.array([i * (ny + 1) + j for i in range(nx) for j in range(ny)])
    return nodes, np.stack([first, first + ny + 1, first + ny + 2, first + 1], axis=1)


def halves(quads, other=False):
    """Triangles of quadrilaterals, cut along the diagonal from corner 0; along the other one where `other` is true."""
    one, two = quads[~np.broadcast_to(other, len(quads))], quads[np.broadcast_to(other, len(quads))]
    return np.concatenate([one[:, [0, 1, 2]], one[:, [0, 2, 3]], two[:, [0, 1, 3]], two[:, [1, 2, 3]]])


@dataclass(frozen=True)
class Shell:
    """nodes [n, 3], cells [m, 3 or 4], rigidities A B D As, and m0 m1 m2."""

    nodes: np.ndarray
    cells: np.ndarray
    rigidities: tuple
    inertia: tuple = (0.0, 0.0, 0.0)
    drilling: float = 1.0

    @property
    def element(self):
        return quad_shell if self.cells.shape[1] == 4 else triangle_shell

    @property
    def dofs(self):
        return (self.cells[:, :, None] * 6 + np.arange(6)).reshape(len(self.cells), -1)

    def assembled(self, matrices):
        size = self.dofs.shape[1]
        place = np.repeat(self.dofs, size, axis=1).ravel(), np.tile(self.dofs, (1, size)).ravel()
        return coo_array((matrices.ravel(), place), shape=(6 * len(self.nodes),) * 2).tocsc()

    @property
    def K(self):
        factor = {"drilling": self.drilling} if self.element is quad_shell else {}
        return self.assembled(self.element.stiffness(self.nodes[self.cells], *self.rigidities, **factor))

    @property
    def M(self):
        return self.assembled(self.element.mass(self.nodes[self.cells], *self.inertia))

    @property
    def tributary(self):
        """Area at each node [n]: that of its cells, shared equally among their corners."""
        corners = self.nodes[self.cells]
        across = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
        share = np.linalg.norm(across, axis=1) / 2 / self.cells.shape[1]
        return np.bincount(self.cells.ravel(), np.repeat(share, self.cells.shape[1]), len(self.nodes))

    def near(self, **places):
        """Numbers of the nodes where the coordinates x, y, z are near the values given."""
        found = np.ones(len(self.nodes), dtype=bool)
        for name, value in places.items():
            found &= np.abs(self.nodes[:, "xyz".index(name)] - value) < 1e-6 * np.ptp(self.nodes)
        return np.flatnonzero(found)

    def moved(self, held, load):
        """Displacements [n, 6] under load [n, 6], the DOFs `held` fixed."""
        free = np.setdiff1d(np.arange(6 * len(self.nodes)), held)
        K = self.K[free][:, free]
        result = np.zeros(6 * len(self.nodes))
        result[free] = splu(
            K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        ).solve(load.ravel()[free])
        return result.reshape(-1, 6)

    def frequencies(self, held, count, shift=-1.0):
        """First frequencies [Hz] with the DOFs `held` fixed."""
        free = np.setdiff1d(np.arange(6 * len(self.nodes)), held)
        K, M = self.K[free][:, free], self.M[free][:, free]
        factor = splu(
            (K - shift * M).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        inverse = LinearOperator(K.shape, matvec=factor.solve, dtype=np.float64)
        start = np.random.default_rng(1).standard_normal(len(free))
        values = eigsh(K, k=count, M=M, sigma=shift, OPinv=inverse, v0=start, return_eigenvectors=False)
        return np.sqrt(np.maximum(np.sort(values), 0)) / (2 * np.pi)


def all_of(nodes, *components):
    """DOF numbers of components of nodes."""
    return (np.asarray(nodes)[:, None] * 6 + np.asarray(components or range(6))).ravel()
