"""Ceilings on hangers, clips and channels: masses on springs, lines of springs in sines, boards that slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh

from femstruct.assembly.matrices import assemble
from femstruct.conventions import GRAVITY
from femstruct.language.models import read_model_file
from femstruct.modal.damping import Damping, FromMaterials, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.modal.statics import statics
from femstruct.model.lay_ups import Laminate, Layer
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.frame import Frame
from femstruct.parts.hangers import Hangers
from femstruct.parts.plate import Plate
from femstruct.parts.plausibility import plausibility_findings
from femstruct.parts.slab import Slab
from femstruct.workflow.recorded_channels import stress_at_rest

ROUNDING = 1e-9  # rounding of rigid motions beside stiff plates: 2e-11 here
RIGID = 1e-4  # of a frequency: plates 3 m wide of 3e16 Pa bend by less
STONE = Material("stone", E=3e16, nu=0.2, rho=2300.0)
BOARD = Material("board", E=3e16, nu=0.2, rho=1600.0)
GYPSUM = Material("gypsum", E=3.0e9, nu=0.3, rho=800.0)
FLOOR = Plate("floor", STONE, 0.15, (0.0, 0.0, 0.4), (4.0, 3.0), 0.5)  # 345 kg/m^2
CEILING = Plate("ceiling", BOARD, 0.0125, (0.0, 0.0, 0.0), (4.0, 3.0), 0.5)  # 20 kg/m^2
HANGERS = Hangers("hangers", "floor", "ceiling", 20e3, 3e3, spacing=(2.0 / 3.0, 1.0))
HELD = Support("edges", "clamped", on="floor", edge="all")


def assembled(*parts, held=()):
    return assemble(mesh_structure(Structure("a ceiling", parts, supports=held)))


def frequencies(assembly, up_to=100.0):
    return modal_basis(assembly, up_to=up_to).frequency_hz


def near(found, expected, tolerance):
    return float(np.abs(found / expected - 1.0).min()) < tolerance


def test_a_hung_ceiling_and_its_floor_are_two_masses_on_a_spring():
    """1.5 hangers of 20 kN/m on a square metre between 345 and 20 kg/m^2: 6.3402 Hz, case 'hangers' of the tables of
    real floors."""
    basis = modal_basis(assembled(FLOOR, CEILING, HANGERS), up_to=100.0)
    expected = np.sqrt(1.5 * 20e3 * (1 / 345.0 + 1 / 20.0)) / (2 * np.pi)
    assert expected == pytest.approx(6.3401954, rel=1e-7)  # rounding of the table
    assert near(basis.frequency_hz, expected, RIGID)
    assert int((basis.frequency_hz < ROUNDING * 6.34e4).sum()) == 6  # nothing goes to the ground


def test_a_rigid_motion_of_both_strains_no_hanger():
    soft = (replace(one, material=GYPSUM) for one in (FLOOR, CEILING))
    assembly = assembled(*soft, HANGERS)
    low = eigsh(assembly.K, k=7, M=assembly.M, sigma=-1.0)[0]
    assert np.sort(np.abs(low))[5] < ROUNDING * np.sort(np.abs(low))[6]


def test_a_ceiling_on_few_springs_has_its_modes_as_a_rigid_plate():
    """Heave and both ways of rocking, below a floor that is held: of x_i of the springs and m L^2 / 12; 15 kg/m^2 of
    2 m on four springs at +-0.5 m."""
    floor = replace(FLOOR, size=(2.0, 2.0))
    ceiling = replace(CEILING, size=(2.0, 2.0))
    basis = frequencies(assembled(floor, ceiling, replace(HANGERS, spacing=(1.0,)), held=(HELD,)), 20.0)
    mass = 20.0 * 4.0
    heave = np.sqrt(4 * 20e3 / mass) / (2 * np.pi)
    # shear in the middle of the gap, between faces at 0.00625 m and 0.325 m: it turns the ceiling, too, and shifts it
    arm = (0.00625 + 0.325) / 2.0
    K = np.array([[4 * 3e3, 4 * 3e3 * arm], [4 * 3e3 * arm, 4 * 20e3 * 0.25 + 4 * 3e3 * arm**2]])
    M = np.diag([mass, mass * (4.0 + 0.0125**2) / 12.0])
    rocking = np.sqrt(eigh(K, M)[0]) / (2 * np.pi)
    assert near(basis, heave, RIGID)
    for one in rocking:
        assert int((np.abs(basis / one - 1.0) < RIGID).sum()) == 2  # both ways


def test_loss_factors_of_hangers_damp_the_modes_that_strain_them():
    """The mode of two masses has half the loss factor of its only spring as damping ratio."""
    model = mesh_structure(Structure("a ceiling", (FLOOR, CEILING, replace(HANGERS, loss_factor=0.1))))
    basis = modal_basis(assemble(model), up_to=100.0)
    damped = with_damping(basis, Damping(FromMaterials()))
    mode = int(np.argmin(np.abs(basis.frequency_hz - 6.3402)))
    assert damped.damping_ratio[mode] == pytest.approx(0.05, rel=1e-4)  # the plates strain by less


def test_half_of_their_mass_hangs_on_each_side():
    """0.4 kg each, 18 of them: 7.2 kg in all, 3.6 kg with the ceiling of 240 kg."""
    heavy = replace(HANGERS, mass=0.4)
    assembly = assembled(FLOOR, CEILING, heavy, held=(HELD,))
    without = assembled(FLOOR, CEILING, HANGERS).total_mass
    assert assembly.total_mass == pytest.approx(without + 7.2, rel=1e-12)  # rounding
    expected = np.sqrt(18 * 20e3 / (240.0 + 3.6)) / (2 * np.pi)
    assert near(frequencies(assembly), expected, RIGID)


def in_sines(strip, lines, per_length, half_waves, terms=400):
    """Frequencies [Hz] of a plate on simple edges with lines of springs along x to a floor that stands still: its
    deflection is one sine along x and a series of sines across.

    K = D ((m pi / a)^2 + (n pi / b)^2)^2 a b / 4 on the diagonal, and k a / 2 times both sines, summed over the lines;
    M = m'' a b / 4.
    """
    (a, b), n = strip.size, np.arange(1, terms + 1)
    bends = strip.material.E * strip.thickness**3 / 12 / (1 - strip.material.nu**2)
    diagonal = bends * ((half_waves * np.pi / a) ** 2 + (n * np.pi / b) ** 2) ** 2 * a * b / 4
    sines = np.sin(np.outer(n, lines) * np.pi / b)
    stiff = np.diag(diagonal) + per_length * a / 2 * sines @ sines.T
    return np.sqrt(np.linalg.eigvalsh(stiff) / (strip.material.rho * strip.thickness * a * b / 4)) / (2 * np.pi)


def test_a_board_on_lines_of_channels_moves_as_a_series_of_sines():
    """Three channels along x, 0.5 m apart below a floor that is held, as stiff as 2e5 N/m^2: the board bends
    between them."""
    board = Plate("ceiling", GYPSUM, 0.0125, (0.0, 0.0, 0.0), (2.4, 1.5), (16, 24))
    floor = replace(FLOOR, size=(2.4, 1.5))
    channels = Hangers("channels", "floor", "ceiling", 2e5, per="length", spacing=(0.5,), along="x")
    simple = Support("rim", "simple", on="ceiling", edge="all")
    found = frequencies(assembled(floor, board, channels, held=(HELD, simple)), 140.0)
    lines = np.array([0.25, 0.75, 1.25])
    expected = np.concatenate([in_sines(board, lines, 2e5, m)[:4] for m in (1, 2, 3)])
    bare = np.concatenate([in_sines(board, lines, 0.0, m)[:4] for m in (1, 2, 3)])
    assert np.abs(np.sort(expected)[:5] / np.sort(bare)[:5] - 1.0).min() > 0.4  # the channels are what counts
    for one in np.sort(expected)[:8]:
        assert near(found, one, 3e-4)  # of the mesh: 7e-6 in the first, with the fourth power of its cells


def joists(start=0.0, end=4.0, height=0.3):
    lines = tuple(((start, y, height), (end, y, height)) for y in (0.5, 1.5, 2.5))
    return Frame("joists", STONE, rectangle("joist", 0.08, 0.2), lines, mesh=0.5, orientation=(0.0, 0.0, 1.0))


def test_clips_along_joists_are_counted_over_the_ceiling():
    """Eight clips a joist 0.5 m apart on the 4 m that the ceiling has, whatever is beyond; all free of the ground."""
    clips = Hangers("clips", "joists", "ceiling", 5e3, 1e3, spacing=(0.5,), mass=0.1)
    over = replace(clips, on="long")
    long = replace(joists(-1.0, 5.5), name="long")
    for one, frame in ((clips, joists()), (over, long)):
        model = mesh_structure(Structure("a ceiling", (frame, CEILING, one)))
        elastic = next(each for each in model.elastics if each.name == "clips")
        assert elastic.stiffness.sum() == pytest.approx(3 * 8 * (5e3 + 2 * 1e3), rel=1e-12)  # rounding
        x, y = np.unique(elastic.places[:, 0].round(9)), np.unique(elastic.places[:, 1].round(9))
        assert (x.tolist(), y.tolist()) == ((0.25 + 0.5 * np.arange(8)).tolist(), [0.5, 1.5, 2.5])
        assert np.ptp(elastic.places[:, 2]) < ROUNDING
        # in the middle between the lower side of the joists and the upper one of the ceiling
        assert elastic.places[0, 2] == pytest.approx((0.3 - 0.1 + 0.00625) / 2.0, rel=1e-12)  # rounding
        assert sum(inert.total for inert in model.inerts) == pytest.approx(3 * 8 * 0.1, rel=1e-12)  # rounding


@pytest.mark.parametrize("mesh", [None, 0.3])
@pytest.mark.parametrize("per", ["piece", "length"])
def test_a_joist_of_one_bar_is_bent_by_each_of_its_hangers(mesh, per):
    """Eight hangers, so soft that each has an eighth of the ceiling: in the middle of a joist on hinges 4 P a, with a
    of 1 m, and the sag that the beam has under the eight by its line of influence. On a line W L / 8 and 5 W L^3 / 384
    E I."""
    light = Material("light", E=11e9, nu=0.3, rho=1e-6)
    joist = Frame(
        "joist", light, rectangle("s", 0.06, 0.2), (((0.0, 1.5, 0.3), (4.0, 1.5, 0.3)),), mesh, element="euler"
    )
    clips = Hangers("clips", "joist", "ceiling", 10.0, per=per, spacing=(0.5,) if per == "piece" else ())
    ends = tuple(PlaceOn(name, "joist", at=((x, 1.5, 0.3),)) for name, x in (("left", 0.0), ("right", 4.0)))
    held = (
        Support("at left", ("x", "y", "z", "rx"), at="left"),
        Support("at right", ("y", "z"), at="right"),
        Support("guided", ("x", "y", "rx", "rz"), on="ceiling"),
    )
    model = mesh_structure(Structure("a ceiling", (joist, CEILING, clips), points=ends, supports=held))
    rest = statics(model, assemble(model), [], weight=True)
    each, modulus = CEILING.thickness * 1600.0 * 12.0 * GRAVITY / 8.0, 11e9 * 0.06 * 0.2**3 / 12
    soft = 1e-4  # the joist bends by so much of what the hangers stretch
    found = stress_at_rest(model.parts["joist"].stresses(model.mesh.n_nodes), rest.displacement, weight=True)
    even = 0.0 if per == "piece" else 1 / 384  # of the 16 pieces under a line: (h / L)^2 2 / 3
    assert found.largest.max() == pytest.approx(4.0 * each / (0.06 * 0.2**2 / 6), rel=soft + even)
    b = 0.25 + 0.5 * np.arange(4)  # from the nearer end: P b (3 L^2 - 4 b^2) / 48 E I in the middle
    sag = 2.0 * (each * b * (3.0 * 16.0 - 4.0 * b**2)).sum() / (48.0 * modulus)
    sag = sag if per == "piece" else 5.0 * 8.0 * each * 4.0**3 / (384.0 * modulus)
    assert -model.parts["joist"].moved(rest.displacement, GRAVITY)[:, 2].min() == pytest.approx(sag, rel=soft)


def test_channels_along_joists_hold_a_ceiling_by_their_length():
    """Two masses: three joists that are free, and the ceiling, on 3 x 4 m of 10 kN/m^2."""
    channels = Hangers("channels", "joists", "ceiling", 10e3, 2e3, per="length", mass=0.5)
    tied = Plate("floor", STONE, 0.05, (0.0, 0.0, 0.3), (4.0, 3.0), 0.5)
    model = mesh_structure(
        Structure("a ceiling", (joists(), tied, CEILING, channels), joints=(Joint("nails", "joists", "floor"),))
    )
    assembly = assemble(model)
    elastic = next(each for each in model.elastics if each.name == "channels")
    assert elastic.stiffness.sum() == pytest.approx(12.0 * (10e3 + 2 * 2e3), rel=1e-12)  # rounding
    upper = assembly.total_mass - 240.0 - 3.0
    expected = np.sqrt(12.0 * 10e3 * (1 / upper + 1 / 243.0)) / (2 * np.pi)
    assert near(frequencies(assembly, 20.0), expected, 1e-3)  # the joists bend a little


def test_hangers_under_a_slab_leave_its_openings_out():
    corners = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0))
    slab = Slab("floor", STONE, 0.15, corners, 0.5, (((0.6, 0.6), (1.0, 1.0)),), origin=(0.0, 0.0, 0.4))
    four = replace(HANGERS, spacing=(1.0, 1.0))
    elastic = next(iter(mesh_structure(Structure("a ceiling", (slab, CEILING, four))).elastics))
    assert len(elastic.places) == 12  # x 0.5 to 3.5, y 0.5 to 2.5; none over the opening
    over = replace(slab, holes=(((0.6, 0.6), (0.6, 0.6)),))
    elastic = next(iter(mesh_structure(Structure("a ceiling", (over, CEILING, four))).elastics))
    assert len(elastic.places) == 11


def test_places_are_in_the_coordinates_of_the_ceiling():
    ceiling = replace(CEILING, origin=(1.0, 0.5, 0.0), size=(2.0, 2.0))
    two = replace(HANGERS, spacing=(), at=((0.2, 0.3), (1.5, 1.0)))
    elastic = next(iter(mesh_structure(Structure("a ceiling", (FLOOR, ceiling, two))).elastics))
    assert elastic.places[:, :2] == pytest.approx(np.array([[1.2, 0.8], [2.5, 1.5]]), rel=1e-12)  # rounding


def test_boards_that_slip_have_twice_the_stiffness_of_one_and_glued_ones_eight_times():
    one = Laminate((Layer(GYPSUM, 0.0125),)).section
    for bond, times in ((0.0, 2.0), (0.5, 5.0), (1.0, 8.0)):
        two = Laminate((Layer(GYPSUM, 0.0125), Layer(GYPSUM, 0.0125)), bond=bond).section
        assert pytest.approx(times * one.D, rel=1e-12) == two.D  # rounding
        assert two.m0 == pytest.approx(2 * one.m0, rel=1e-12)  # rounding
        assert np.abs(two.B).max() < 1e-9 * one.A.max()  # rounding, of a length in m
        assert two.As == pytest.approx(2 * one.As, rel=1e-9)  # rounding of the integral across


def test_slipping_boards_lose_by_their_own_shares_of_the_energy():
    """Of boards with D 1 and 8 the second has 8 / 9 of the energy."""
    thin, thick = replace(GYPSUM, name="thin", loss_factor=0.0), replace(GYPSUM, loss_factor=0.09)
    section = Laminate((Layer(thin, 0.01), Layer(thick, 0.02)), bond=0.0).section
    assert section.loss_factor == pytest.approx(0.08, rel=1e-12)  # rounding


def test_a_hung_ceiling_does_not_span_from_edge_to_edge():
    """Boards that would sag by a fifth of the span if they lay on their edges are plausible on hangers."""
    thin = replace(CEILING, material=replace(GYPSUM, E=1.5e9), thickness=0.02)
    alone, hung = ({one.code for one in plausibility_findings(parts)} for parts in ((thin,), (FLOOR, thin, HANGERS)))
    assert "implausible-stiffness" in alone and "implausible-stiffness" not in hung


TEXT = """
materials:
  stone: {E: 30 GPa, nu: 0.2, rho: 2300, loss_factor: 1 %}
  gypsum: {E: 3 GPa, nu: 0.3, rho: 800, loss_factor: 1 %}
parts:
  floor: {type: plate, material: stone, thickness: 150 mm, origin: [0, 0, 0.4], size: [4, 3], mesh: 0.5}
  ceiling:
    type: plate
    layers: {boards: [[gypsum, 12.5 mm], [gypsum, 12.5 mm]], bond: 30 %}
    origin: [0, 0, 0]
    size: [4, 3]
    mesh: 0.5
  hangers:
    type: hangers
    between: [floor, ceiling]
    spacing: [1 m, 600 mm]
    like: hanger ARH-1-20
    loss_factor: 5 %
    mass: 80 g
"""


def test_a_model_file_says_the_same(tmp_path):
    (tmp_path / "a.yaml").write_text(TEXT, encoding="utf-8")
    structure = read_model_file(tmp_path / "a.yaml").structure
    assert isinstance(structure, Structure)
    (hangers,) = (part for part in structure.parts if isinstance(part, Hangers))
    assert hangers.normal == pytest.approx(289.134404 / (5 / 16 * 0.0254), rel=1e-9)  # 65 lb over 5/16 inch
    assert (hangers.spacing, hangers.per, hangers.loss_factor, hangers.mass) == ((1.0, 0.6), "piece", 0.05, 0.08)
    assert hangers.like.startswith("hanger ARH-1-20: ")
    (ceiling,) = (part for part in structure.parts if part.name == "ceiling")
    assert isinstance(ceiling, Plate) and isinstance(ceiling.material, Laminate) and ceiling.material.bond == 0.3
    assert [given.value for given in ceiling.material.described()][-1] == 0.3
