"""Ribs beside the plate they stiffen: rigid arms at every node, as the same arms given bar by bar."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import assemble
from femstruct.modal.reduction import modal_basis
from femstruct.modal.statics import statics
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import i_section, rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate

STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
ARM = (0.0, 0.0, -32.5e-3)
LINE = ((0.0, 0.3, 0.0), (1.0, 0.3, 0.0))


def ribbed(*lines, start=ARM, end=ARM, mesh=0.1, extra=(), points=()):
    """A plate on two opposite edges, with an I of 60 mm under its middle line."""
    plate = Plate("plate", STEEL, 5e-3, (0.0, 0.0, 0.0), (1.0, 0.6), (10, 6), "acm12")
    section = i_section("s", 40e-3, 60e-3, 4e-3, 5e-3)
    rib = Frame("rib", STEEL, section, lines, mesh, start_offset=start, end_offset=end)
    held = tuple(Support(edge, "simple", on="plate", edge=edge) for edge in ("x0", "x1"))
    joints = (Joint("seam", "plate", "rib"),)
    return mesh_structure(Structure("ribbed", (plate, rib, *extra), joints, points=points, supports=held))


def frequencies(model):
    return modal_basis(assemble(model), count=8).frequency_hz


def sag(model):
    """Deflection of the middle of the rib under 1 N there [m]."""
    assembly, places = assemble(model), model.parts["plate"].places
    load = np.zeros(len(assembly.points) * 7)
    load[7 * np.linalg.norm(places - [0.5, 0.3, 0.0], axis=1).argmin() + 2] = 1.0
    rows = assembly.dofs.T.T @ load
    return rows @ spsolve(assembly.K, rows)


def test_one_eccentric_line_is_its_bars_given_one_by_one():
    places = np.linspace(0.0, 1.0, 11)
    pieces = tuple(((x, 0.3, 0.0), (y, 0.3, 0.0)) for x, y in pairwise(places))
    whole, piecewise = ribbed(LINE), ribbed(*pieces)
    assert whole.parts["rib"].arms == pytest.approx(piecewise.parts["rib"].arms, abs=1e-15)  # rounding: none here
    # the same matrices but for the order of numbers: rounding
    assert frequencies(whole) == pytest.approx(frequencies(piecewise), rel=1e-9)
    # an I of 600 mm^2 and 345,000 mm^4 and a plate of 3000 mm^2, apart and as one section about its own axis: an arm of
    # 32.5 mm makes it (345 + 7 + 600 * 3000 / 3600 * 32.5^2 / 1000) / (345 + 7) = 2.5 times as stiff
    stiffer = sag(ribbed(LINE, start=(0.0, 0.0, 0.0), end=(0.0, 0.0, 0.0))) / sag(whole)
    assert 2.0 < stiffer < 2.5  # less: the rib shears, and the plate is wide


@pytest.mark.parametrize("mesh", [None, 0.3, 0.04])
def test_the_rib_has_the_nodes_of_the_plate_whatever_its_own_size(mesh):
    model = ribbed(LINE, mesh=mesh)
    assert len(model.parts["rib"].bars) == 10
    assert model.ties[-1].rows.shape[0] == 4 * 11  # joined at every node: three shifts, and the turn about the rib


def test_inner_points_of_the_line_change_nothing():
    bent = (LINE[0], (0.35, 0.3, 0.0), LINE[1])
    straight = ribbed(LINE, points=(PlaceOn("p", "plate", ((0.35, 0.3),)),), extra=(Mass("m", 1e-9, at="p"),))
    assert frequencies(ribbed(bent)) == pytest.approx(frequencies(straight), rel=1e-6)  # for the mass of a microgram


def test_different_arms_go_over_into_each_other():
    model = ribbed(LINE, start=(0.0, 0.0, -20e-3), end=(0.0, 0.0, -40e-3))
    arms, x = model.parts["rib"].arms, model.parts["rib"].start[:, 0]
    assert arms[:, 0, 2] == pytest.approx(-20e-3 - 20e-3 * x, abs=1e-13)  # rounding: none here
    assert model.ties[-1].rows.shape[0] == 4 * 11
    low, high = (frequencies(ribbed(LINE, start=(0, 0, z), end=(0, 0, z)))[0] for z in (-20e-3, -40e-3))
    assert low < frequencies(model)[0] < high


def test_an_arm_along_the_line_only_shortens_the_bar():
    frame = Frame("bar", STEEL, rectangle("s", 0.02, 0.03), (((0, 0, 0), (1.0, 0, 0)),), 0.1)
    bars = mesh_structure(Structure("bar", (replace(frame, start_offset=(0.2, 0.0, 0.0)),))).parts["bar"]
    assert bars.start[0] == pytest.approx([0.2, 0.0, 0.0])
    assert np.abs(bars.arms.reshape(-1, 3)[1:]).max() <= 1e-15  # rounding: none here


@pytest.mark.parametrize("mesh", [0.1, 2.0])
def test_an_arm_along_the_line_that_lengthens_the_bar(mesh):
    """It reaches back behind the clamped end: a cantilever of 1.1 m, not one of 1 m with a loose end."""
    frame = Frame(
        "bar", STEEL, rectangle("s", 0.02, 0.03), (((0, 0, 0), (1.0, 0, 0)),), mesh, start_offset=(-0.1, 0, 0)
    )
    root, tip = (PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("root", 0.0), ("tip", 1.0)))
    held = (Support("wall", "clamped", at="root"),)
    model = mesh_structure(Structure("bar", (frame,), points=(root, tip), supports=held))
    up = model.points["tip"].probe("z")
    rest = statics(model, assemble(model), [(up, 1.0)])
    section = frame.section
    bent = 1.1**3 / 3 / STEEL.E / section.Iy + 1.1 / (STEEL.E / 2.6 * section.kz * section.A)
    assert rest.of(up) == pytest.approx(bent, rel=1e-8)  # bars are exact at their ends


def test_an_arm_at_one_end_leaves_the_knee_where_it_is():
    knee = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 1.0))
    frame = Frame("leg", STEEL, rectangle("s", 0.02, 0.03), (knee,), start_offset=(0.05, 0.0, 0.1))
    bars = mesh_structure(Structure("leg", (frame,))).parts["leg"]
    assert bars.start[0] == pytest.approx([0.05, 0.0, 0.1])
    assert bars.end[0] == pytest.approx(knee[1])
    assert bars.end[1] == pytest.approx(knee[2])


@pytest.mark.parametrize(("mass", "per"), [(3.0, "length"), (3.0 * 1.3, "total")])
def test_mass_along_a_frame_is_density(mass, per):
    """3 kg/m on an Euler beam without rotary inertia: the frequencies of a beam so much heavier."""
    line = ((0.0, 0.0, 0.0), (1.3, 0.0, 0.0))
    bar = Frame("bar", STEEL, rectangle("s", 0.02, 0.03), (line,), 0.1, element="euler")
    laden = mesh_structure(Structure("laden", (bar, Mass("paint", mass, on="bar", per=per))))
    assembly = assemble(laden)
    per_length = STEEL.rho * 6e-4
    assert assembly.total_mass == pytest.approx((per_length + 3.0) * 1.3, rel=1e-13)  # rounding: none here
    bare, heavy = (
        modal_basis(assemble(mesh_structure(Structure("bare", (bar,)))), count=9),
        modal_basis(assembly, count=9),
    )
    # Torsion has no part in the mass; the first three elastic modes bend: lighter by the root of the masses.
    ratio = np.sqrt(per_length / (per_length + 3.0))
    assert heavy.frequency_hz[6:] == pytest.approx(ratio * bare.frequency_hz[6:], rel=1e-10)  # rounding: 1e-13 here
