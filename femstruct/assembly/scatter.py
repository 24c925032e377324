"""Element matrices of whole parts, scattered into sparse matrices on the raw degrees of freedom."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array

from femstruct.arrays import Floats, Integers
from femstruct.assembly.dofs import RawDofs
from femstruct.elements import frame, placement, plate
from femstruct.model.model import BlockMesh, Elastic, FrameMesh, Inert, PlateMesh


def plate_matrices(mesh: PlateMesh, dofs: RawDofs) -> tuple[csr_array, csr_array]:
    """Stiffness and mass of a plate [n_raw, n_raw]: bending of its cells, inertia as a rigid body in its plane."""
    part, material = mesh.part, mesh.part.material
    a, b = mesh.cell_sizes
    per_area = material.rho * part.thickness
    numbers = dofs.of_nodes[part.name]
    local = mesh.cells - mesh.nodes[0, 0]
    of_cells = numbers[local].reshape(len(local), -1)
    rigidity = plate.rigidity(material.E, material.nu, part.thickness)
    cell_stiffness = plate.stiffness(part.element, a, b, rigidity)
    cell_mass = plate.mass(part.element, a, b, per_area)
    K, M = scattered(cell_stiffness, cell_mass, of_cells, dofs.count)
    width, height = part.size
    total = per_area * width * height
    inertia = np.array([total, total, total * (width**2 + height**2) / 12.0])
    in_plane = dofs.in_plane[part.name]
    return K, M + csr_array((inertia, (in_plane, in_plane)), shape=M.shape)


def frame_matrices(mesh: FrameMesh, dofs: RawDofs, first_node: int) -> tuple[csr_array, csr_array]:
    """Stiffness and mass of a frame [n_raw, n_raw]."""
    part, material, section = mesh.part, mesh.part.material, mesh.part.section
    E, G, lengths = material.E, material.G, mesh.lengths
    A, Iy, Iz, ky, kz = section.A, section.Iy, section.Iz, section.ky, section.kz
    local = (
        frame.stiffness(part.element, lengths, E, G, A, Iy, Iz, section.J, ky, kz),
        frame.mass(part.element, lengths, material.rho, A, Iy, Iz, ky, kz, E, G),
    )
    of_bars = dofs.of_nodes[part.name][mesh.bars - first_node].reshape(len(mesh.bars), -1)
    at_nodes = [
        placement.with_offsets(placement.to_global(matrix, mesh.axes), *np.moveaxis(mesh.arms, 1, 0))
        for matrix in local
    ]
    return scattered(at_nodes[0], at_nodes[1], of_bars, dofs.count)


def block_matrix(mesh: BlockMesh, dofs: RawDofs) -> csr_array:
    """Mass matrix of a rigid block [n_raw, n_raw], diagonal at its centre of mass."""
    numbers = dofs.of_nodes[mesh.part.name][0]
    values = np.array([mesh.part.mass] * 3 + list(mesh.part.moments))
    return csr_array((values, (numbers, numbers)), shape=(dofs.count, dofs.count))


def elastic_matrices(elastic: Elastic, dofs: RawDofs) -> tuple[csr_array, csr_array]:
    """Stiffness and damping of springs, a foundation or an elastic joint [n_raw, n_raw]."""
    rows = csr_array(elastic.rows @ dofs.output)
    return congruent(rows, elastic.stiffness), congruent(rows, elastic.damping)


def inert_matrix(inert: Inert, dofs: RawDofs) -> csr_array:
    """Mass matrix of particles and spread masses [n_raw, n_raw]."""
    return congruent(csr_array(inert.rows @ dofs.output), inert.mass)


def congruent(rows: csr_array, values: Floats) -> csr_array:
    """rows^T diag(values) rows."""
    return csr_array(rows.T @ (diags_array(values) @ rows))


def scattered(stiffness: Floats, mass: Floats, of_elements: Integers, count: int) -> tuple[csr_array, csr_array]:
    """Sums of two sets of element matrices [n, nd, nd] at the degrees of freedom [n, nd] of each element, sparse."""
    n_dofs = of_elements.shape[1]
    numbers = of_elements.astype(np.int32)
    rows = np.repeat(numbers, n_dofs, axis=1).ravel()
    columns = np.tile(numbers, (1, n_dofs)).ravel()
    # Sorting the places costs most of it and is the same for both, so they travel as one complex matrix.
    both = np.empty(stiffness.shape, dtype=np.complex128)
    both.real, both.imag = stiffness, mass
    together = csr_array(coo_array((both.ravel(), (rows, columns)), shape=(count, count)))
    K, M = (
        csr_array((values.copy(), together.indices, together.indptr), shape=together.shape)
        for values in (together.data.real, together.data.imag)
    )
    return K, M
