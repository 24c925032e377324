"""Supports along a line inside a plate, as walls under a continuous slab, against two-span plates and beams."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import assemble
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure, Support, SurfaceOn
from femstruct.parts.plate import Plate

SPAN, WIDTH, THICKNESS = 4.0, 3.0, 0.2
CONCRETE = Material("concrete", 30e9, 0.2, 2400.0)


def continuous(mesh=(16, 12), edges=("x0", "x1", "y0", "y1"), fix="simple", material=CONCRETE, width=WIDTH):
    """A slab over two equal spans along x on a wall in the middle, simply supported on some of its edges."""
    slab = Plate("slab", material, THICKNESS, (0.0, 0.0, 0.0), (2 * SPAN, width), mesh)
    wall = Support("wall", fix, on="slab", line=((SPAN, 0.0), (SPAN, width)))
    sides = tuple(Support(f"edge {edge}", "simple", on="slab", edge=edge) for edge in edges)
    surface = SurfaceOn("top", "slab", "above")
    return Structure("two spans", (slab,), supports=(wall, *sides), surfaces=(surface,))


def levy_clamped(width, span):
    """First circular frequency of a plate simply supported on three sides and clamped on one of length `width`.

    Levy: w = f(x) sin(pi y / width), f'''' - 2 m^2 f'' + (m^4 - k^4) f = 0 with k^4 = rho h omega^2 / D; f = 0 at both
    ends, f'' = 0 at the simple one: f = a sinh(p x) + b sin(q x), p^2 = k^2 + m^2, q^2 = k^2 - m^2, and f' = 0 at the
    other gives q tanh(p l) = p tan(q l). The first root with pi < q l < 3 pi / 2.
    """
    m = np.pi / width

    def condition(ql):
        q = ql / span
        p = np.sqrt(q**2 + 2 * m**2)
        return q * np.tanh(p * span) * np.cos(ql) - p * np.sin(ql)

    q = brentq(condition, np.pi * 1.0001, 1.4999 * np.pi) / span
    D = 30e9 * THICKNESS**3 / 12 / (1 - 0.2**2)
    return (q**2 + m**2) * np.sqrt(D / (2400.0 * THICKNESS))


def test_a_slab_over_a_wall_rings_as_its_spans_do():
    """Odd about the wall: a span on simple supports; even: one clamped at the wall."""
    omega = modal_basis(assemble(mesh_structure(continuous())), count=2).omega
    D = 30e9 * THICKNESS**3 / 12 / (1 - 0.2**2)
    simple = ((np.pi / SPAN) ** 2 + (np.pi / WIDTH) ** 2) * np.sqrt(D / (2400.0 * THICKNESS))
    # bfs16 is of fourth order: eight cells a half wave leave (pi / 8)^4 / 720 or so of the energy.
    assert omega == pytest.approx([simple, levy_clamped(WIDTH, SPAN)], rel=1e-4)


def test_a_clamped_wall_makes_two_equal_rooms():
    omega = modal_basis(assemble(mesh_structure(continuous(fix="clamped"))), count=2).omega
    assert omega == pytest.approx([levy_clamped(WIDTH, SPAN)] * 2, rel=1e-4)  # (k h)^4: 4e-5 here


@pytest.mark.parametrize("shift", [0.0, 0.37])
def test_a_wall_of_a_two_span_beam_takes_ten_eighths(shift):
    """A strip with nu = 0 under an even load: reactions 3/8, 10/8 and 3/8 q l where the spans are equal; with a wall
    off the middle, by the equation of three moments."""
    strip = Material("strip", 30e9, 0.0, 2400.0)
    structure = continuous((10, 2), ("x0", "x1"), material=strip, width=0.5)
    first, second = SPAN + shift, SPAN - shift
    wall = Support("wall", "simple", on="slab", line=((first, 0.0), (first, 0.5)))
    structure = Structure(
        "two spans", structure.parts, supports=(wall, *structure.supports[1:]), surfaces=structure.surfaces
    )
    model = mesh_structure(structure)
    assembly = assemble(model)
    pressure = model.surfaces["top"].pressure()
    u = spsolve(assembly.K, (pressure.row(len(assembly.points)) @ assembly.dofs.T).toarray()[0])
    moment = (first**3 + second**3) / (8 * (first + second))  # for one newton a metre
    ends = first / 2 - moment / first, second / 2 - moment / second
    expected = {"edge x0": ends[0], "wall": first + second - sum(ends), "edge x1": ends[1]}
    for name, reaction in expected.items():
        rows = assembly.forces[name]
        found = rows.stiffness @ u + (rows.direct @ pressure.row(len(assembly.points)).T).toarray().ravel()
        # Cubic elements give exact moments and forces under even loads.
        assert found[2] == pytest.approx(-0.5 * reaction, rel=1e-8), name
    if shift == 0.0:
        assert expected["wall"] == pytest.approx(10 / 8 * SPAN)


def test_a_wall_under_half_the_width_stops_there():
    """A wall that ends inside the slab holds its own length only."""
    structure = continuous()
    wall = Support("wall", "simple", on="slab", line=((SPAN, 0.0), (SPAN, WIDTH / 2)))
    half = Structure("half", structure.parts, supports=(wall, *structure.supports[1:]))
    none = Structure("none", structure.parts, supports=structure.supports[1:])
    omega = [modal_basis(assemble(mesh_structure(one)), count=2).omega for one in (none, half, structure)]
    odd = omega[2][0]  # the odd mode does not move the wall, so any length of it leaves it alone
    assert omega[0][0] < 0.9 * odd
    assert odd == pytest.approx(min(omega[1], key=lambda found: abs(found - odd)), rel=1e-11)  # rounding: 9e-14 here
    assert omega[1].max() < (1 - 1e-3) * omega[2][1]  # fewer constraints; the other half of the line is free to move
