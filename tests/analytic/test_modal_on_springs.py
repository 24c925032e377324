"""Plates free to shift in their own plane on springs that resist across it only: three rigid modes and no other."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring

SIDE = 0.4
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)


def on_springs(thickness, divisions, k, shear=0.0, element="bfs16", rib=False):
    """A square plate on a spring at every corner: k along z, `shear` along x [N/m]."""
    plate = Plate(
        "plate", STEEL, thickness, origin=(0.0, 0.0, 0.0), size=(SIDE, SIDE), mesh=(divisions,) * 2, element=element
    )
    feet = PlaceOn("feet", "plate", ((0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)))
    springs = Spring("springs", "feet", None, (shear, 0.0, k, 0.0, 0.0, 0.0))
    if not rib:
        return assemble(mesh_structure(Structure("on springs", (plate, springs), points=(feet,))))
    line = ((0.0, SIDE / 2, 0.0), (SIDE, SIDE / 2, 0.0))
    bar = Frame("rib", STEEL, rectangle("bar", 10e-3, 20e-3), (line,))
    joints = (Joint("seam", "plate", "rib"),)
    return assemble(mesh_structure(Structure("on springs", (plate, bar, springs), joints, points=(feet,))))


@pytest.mark.parametrize(("element", "divisions"), [("bfs16", 4), ("acm12", 8), ("bfs16", 8), ("bfs16", 16)])
@pytest.mark.parametrize("thickness", [1e-3, 30e-3])
@pytest.mark.parametrize("k", [1.0, 1e4, 1e9])
def test_three_rigid_modes_and_the_first_elastic_one(thickness, divisions, k, element):
    assembly = on_springs(thickness, divisions, k, element=element)
    for asked in ({"count": 8}, {"count": 2}, {"up_to": 1000.0}, {"up_to": 0.01}):
        basis = modal_basis(assembly, **asked)
        expected = min(3, asked.get("count", 8))
        assert basis.n_rigid == expected
        assert (basis.omega[:expected] == 0.0).all()
        assert (basis.omega[expected:] > 0.1).all()  # the softest is at 0.05 Hz
    assert modal_basis(assembly, count=4).kind[3] == "elastic"


@pytest.mark.parametrize("divisions", [4, 20])
def test_heave_and_tilt_of_a_stiff_plate(divisions):
    basis = modal_basis(on_springs(30e-3, divisions, 1e4), count=6)
    mass = STEEL.rho * 30e-3 * SIDE**2
    heave, tilt = np.sqrt([4e4 / mass, 12e4 / mass])  # 4 k; k side^2 over mass side^2 / 12
    # The plate bends at 629 Hz, so the springs see (9 / 629)^2 = 2e-4 of their share of it: half of that in frequency.
    assert basis.omega[3:6] == pytest.approx([heave, tilt, tilt], rel=2e-4)


@pytest.mark.parametrize("divisions", [4, 8, 20])
@pytest.mark.parametrize("shear", [1e-9, 1e-6, 1.0])
def test_a_very_soft_spring_is_not_taken_for_none(divisions, shear):
    """4 shear along x on the mass, and its moment on the inertia about z; y alone is free."""
    mass = STEEL.rho * 1e-3 * SIDE**2
    sway, turn = np.sqrt([4 * shear / mass, shear * SIDE**2 / (mass * SIDE**2 / 6)])  # 9e-6 Hz for the softest
    for asked in ({"count": 3}, {"count": 12}, {"up_to": 100.0}):
        basis = modal_basis(on_springs(1e-3, divisions, 100.0, shear), **asked)
        assert basis.n_rigid == 1
        # Rigid in its plane, so the closed form is exact; the eigenvectors are good to 1e-9 of |sigma| at the worst.
        assert basis.omega[np.isclose(basis.omega, sway, rtol=1e-6)].size == 1
        assert basis.omega[np.isclose(basis.omega, turn, rtol=1e-6)].size == 1


@pytest.mark.parametrize("k", [1.0, 1e9])
@pytest.mark.parametrize("divisions", [8, 20])
def test_a_ribbed_plate_has_three_rigid_modes_too(divisions, k):
    basis = modal_basis(on_springs(5e-3, divisions, k, rib=True), count=7)
    assert basis.n_rigid == 3
    assert basis.omega[3] > 0.1
