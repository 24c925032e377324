"""Concentrated bodies with a tensor of inertia: mass matrices by mechanics, frequencies in closed form."""

from pathlib import Path

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError, InputErrors
from femstruct.language.models import read_model
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import part_masses
from femstruct.model.sections import Section
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.block import Block
from femstruct.parts.frame import Frame
from femstruct.parts.inertia import Inertia
from femstruct.parts.spring import Spring

MOMENTS, PRODUCTS = (0.30, 0.50, 0.60), (0.05, -0.08, 0.11)
MASS, OFFSET = 7.0, (0.2, -0.3, 0.45)


def on_a_block(*parts):
    block = Block("anvil", 11.0, (-0.1, -0.1, -0.1), (0.2, 0.2, 0.2), inertia=(1.0, 1.1, 1.2))
    corner = PlaceOn("corner", "anvil", ((0.2, 0.2, 0.2),))
    return assemble(mesh_structure(Structure("a block", (block, *parts), points=(corner,))))


def skew(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def test_the_mass_matrix_is_that_of_mechanics() -> None:
    """Kinetic energy of a body whose centre is at an arm from the block's: m |v + w x arm|^2 / 2 + w J w / 2."""
    added = on_a_block(Inertia("body", "corner", MASS, MOMENTS, PRODUCTS, OFFSET)).M - on_a_block().M
    arm = np.array([0.1, 0.1, 0.1]) + OFFSET
    (xx, yy, zz), (xy, yz, zx) = MOMENTS, PRODUCTS
    J = np.array([[xx, -xy, -zx], [-xy, yy, -yz], [-zx, -yz, zz]])
    S = skew(arm)  # S w = arm x w
    exact = np.block([[MASS * np.eye(3), -MASS * S], [MASS * S, J - MASS * S @ S]])
    assert added.toarray() == pytest.approx(exact, abs=1e-13 * MASS)  # rounding of a few sums


def test_a_body_of_four_particles_is_the_four_particles() -> None:
    """The convention of signs of the products, from the definition: integrals over particles."""
    places = np.array([[0.3, 0.1, -0.2], [-0.1, 0.4, 0.2], [0.2, -0.2, 0.5], [-0.3, -0.1, -0.4]])
    masses = np.array([1.0, 2.0, 1.5, 0.5])
    centre = masses @ places / masses.sum()
    x, y, z = (places - centre).T
    moments = tuple(float(masses @ (a**2 + b**2)) for a, b in ((y, z), (z, x), (x, y)))
    products = tuple(float(masses @ (a * b)) for a, b in ((x, y), (y, z), (z, x)))
    one = on_a_block(Inertia("body", "corner", masses.sum(), moments, products, tuple(centre)))
    particles = [
        Inertia(f"p{i}", "corner", m, offset=tuple(at)) for i, (m, at) in enumerate(zip(masses, places, strict=True))
    ]
    several = on_a_block(*particles)
    assert one.M.toarray() == pytest.approx(several.M.toarray(), abs=1e-13 * 20.0)  # rounding of a few sums
    assert one.total_mass == several.total_mass == 16.0
    assert one.momentum == pytest.approx(several.momentum, abs=1e-14 * 20.0)  # rounding: 1e-17 here


def test_torsional_and_bending_frequencies_of_a_shaft_with_a_disc() -> None:
    """A massless cantilever with a disc at its end: GJ / L on Ixx; in bending two degrees of freedom, by hand."""
    E, nu, length = 210e9, 0.3, 0.8
    section = Section("round", 1e-3, 8e-8, 8e-8, 1.6e-7)
    shaft = Frame(
        "shaft", Material("light", E, nu, 1e-6), section, (((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), 0.1, element="euler"
    )
    hub = PlaceOn("hub", "shaft", ((length, 0.0, 0.0),))
    disc = Inertia("disc", "hub", 20.0, (0.5, 0.25, 0.25))
    structure = Structure("a shaft", (shaft, disc), points=(hub, PlaceOn("root", "shaft", ((0.0, 0.0, 0.0),))),
                          supports=(Support("wall", "clamped", at="root"),))  # fmt: skip
    model = mesh_structure(structure)
    assert part_masses(model)["disc"] == 20.0
    found = modal_basis(assemble(model), count=5).omega
    torsion = np.sqrt(E / 2.6 * 1.6e-7 / length / 0.5)
    EI = E * 8e-8
    flexible = np.array([[length**3 / 3, length**2 / 2], [length**2 / 2, length]]) / EI
    bending = np.sqrt(1.0 / np.linalg.eigvals(flexible @ np.diag([20.0, 0.25])))
    exact = sorted([torsion, *bending, *bending])
    assert found == pytest.approx(exact, rel=1e-6)  # the shaft weighs 1e-9 kg; omega^2 of stiff meshes 1e-9


def test_it_weighs_and_hangs_where_its_centre_is() -> None:
    """A block on a spring below its centre leans under a body beside it: the moment is weight times arm."""
    body = Inertia("body", "corner", MASS, MOMENTS, offset=OFFSET)
    spring = Spring("mount", "corner", None, (1e6,) * 3 + (1e5,) * 3)
    momentum = on_a_block(body, spring).momentum - on_a_block(spring).momentum
    arm = np.array([0.1, 0.1, 0.1]) + OFFSET
    exact = np.concatenate([MASS * np.eye(3), -MASS * skew(arm)], axis=1)
    assert momentum == pytest.approx(exact, abs=1e-13 * MASS)  # rounding of a few sums


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"mass": 0.0}, "parts.body.mass: got 0, expected a positive mass"),
        ({"moments": (1.0, 1.0, 3.0)}, "none larger than the sum of the two others"),
        ({"moments": (1.0, 1.0, -1.0)}, "none below zero"),
        ({"moments": (1.0, 1.0, 1.0), "products": (1.5, 0.0, 0.0)}, "none below zero"),
    ],
)
def test_tensors_that_no_body_has_are_refused(change, told) -> None:
    with pytest.raises(InputError, match=told):
        Inertia("body", "p", **{"mass": 1.0, "moments": (1.0, 1.0, 1.0), **change})


YAML = """\
parts:
  anvil: {type: block, mass: 11 kg, origin: [0, 0, 0], size: [0.2, 0.2, 0.2]}
  body: {type: inertia, at: corner, mass: 7 kg, offset: [20 cm, -0.3, 0.45],
    inertia: [0.3 kg*m^2, 0.5, 0.6, 0.05, -0.08, 0.11]}
points: {corner: {on: anvil, at: [0.2, 0.2, 0.2]}}
"""


def test_it_is_written_in_a_model_file(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    path.write_text(YAML, encoding="utf-8")
    parts = {part.name: part for part in read_model(path).structure.parts}
    assert parts["body"] == Inertia("body", "corner", MASS, MOMENTS, PRODUCTS, OFFSET)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("at: corner", "at: korner"), r"model.yaml:3:29: parts.body.at: got 'korner', .*did you mean 'corner'"),
        (("0.6, 0.05, -0.08, 0.11]", "0.6, 0.05]"), r"expected \[Ixx, Iyy, Izz\] or \[Ixx, Iyy, Izz, Ixy, Iyz, Izx\]"),
        (("0.5, 0.6,", "0.5, 6.0,"), r"parts.body.inertia: got principal moments of .*sum of the two others"),
        (("0.3 kg*m^2", "0.3 kg"), r"parts.body.inertia: got .*a moment of inertia"),
    ],
)
def test_mistakes_are_told_with_their_places(change, told, tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    path.write_text(YAML.replace(*change), encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_model(path)
