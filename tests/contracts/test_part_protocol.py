"""What a kind of part may do, and what is refused before it is lost without a word."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.sparse import csr_array

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, InputError
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import part_masses
from femstruct.model.part import Elastic, Inert, Meshed
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.parts.shell import Shell

STEEL = Material("steel", 210e9, 0.3, 7850.0)
PLATE = Plate("plate", STEEL, 0.003, (0.0, 0.0, 0.0), (0.5, 0.4), (2, 2))


@dataclass(frozen=True)
class Sprung(Plate):
    """A plate with a spring to the ground at its first node, and a kilogram there, under its own name."""

    stiffness: float = 1e5
    spring_loss: float = 0.0

    def fastened(self, model, tolerance):
        part = model.parts[self.name]
        row = np.zeros((3, model.mesh.n_nodes * 7))
        row[np.arange(3), part.first * 7 + np.arange(3)] = 1.0
        upwards = csr_array(row[2:])
        up = np.array([[0.0, 0.0, 1.0]])
        spring = Elastic(self.name, upwards, [self.stiffness], [0.0], up, grounded=True, loss_factor=self.spring_loss)
        return spring, Inert(self.name, csr_array(row), np.ones(3), 1)


def sprung(**changes):
    given = {field: getattr(PLATE, field) for field in PLATE.__dataclass_fields__}
    return Sprung(**given, **changes)


def test_a_part_with_cells_and_springs_of_one_name_keeps_both() -> None:
    alone = assemble(mesh_structure(Structure("a", (PLATE,))))
    model = mesh_structure(Structure("a", (sprung(),)))
    both = assemble(model)
    added = (both.part_stiffness["plate"] - alone.part_stiffness["plate"]).toarray()
    assert np.trace(added) == pytest.approx(1e5, rel=1e-9)  # one deflection: a shift in its plane is none
    # rounding: none here
    assert part_masses(model)["plate"] == pytest.approx(0.5 * 0.4 * 0.003 * 7850.0 + 1.0, rel=1e-14)
    assert both.total_mass == part_masses(model)["plate"]


def test_two_loss_factors_under_one_name_are_refused() -> None:
    with pytest.raises(FemstructError, match=r"plate: got loss factors of 0 and 0\.1, expected one"):
        assemble(mesh_structure(Structure("a", (sprung(spring_loss=0.1),))))


def test_what_every_kind_must_have_is_asked_for_by_name() -> None:
    class Half(Meshed):
        name = "half"

    with pytest.raises(TypeError, match=r"abstract.*dofs.*drawn.*lumps.*mass.*places.*point.*stiffness_and_mass"):
        Half()


def test_a_part_without_a_face_says_so_in_words() -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    mesh = ImportedMesh("tray", points, np.arange(3), {"tri3": np.array([[0, 1, 2]])}, {"tri3": np.array([1])})
    part = mesh_structure(Structure("a", (Shell("tray", mesh, STEEL, 0.01),))).parts["tray"]
    with pytest.raises(InputError, match=r"parts.tray: got no face that a layer can lie against, expected a plate, s"):
        part.motion_at(np.zeros((1, 3)), 1e-6)


def test_what_cannot_be_fastened_is_refused() -> None:
    @dataclass(frozen=True)
    class Wrong(Plate):
        def fastened(self, model, tolerance):
            return ([],)

    given = {field: getattr(PLATE, field) for field in PLATE.__dataclass_fields__}
    with pytest.raises(FemstructError, match="no Elastic, Inert or Tie"):
        mesh_structure(Structure("a", (replace(Wrong(**given), name="wrong"),)))
