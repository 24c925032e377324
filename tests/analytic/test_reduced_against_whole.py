"""Models with a reduced part against the same models with the whole part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import InputError
from femstruct.study.asked import Extent
from femstruct.workflow.exchange import reduce_model

SLAB = "{type: slab, material: steel, thickness: 3 mm, outline: [[0, 0], [0.6, 0], [0.6, 0.4], [0, 0.4]], mesh: 25 mm}"
PLATE = "{type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.6, 0.4], mesh: 25 mm}"
MATERIAL = "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}}\n"


def quiet(_: str) -> None:
    """Takes what is told of progress."""


def written(folder: Path, name: str, text: str) -> Path:
    (folder / f"{name}.yaml").write_text(MATERIAL + text)
    return folder / f"{name}.yaml"


def basis_of(path: Path, count: int) -> fs.ModalBasis:
    return fs.modal_basis(fs.assemble(fs.read_model(path)), count=count)


@pytest.mark.parametrize("kind", [SLAB, PLATE], ids=["slab", "plate"])
def test_a_free_reduced_plate_is_rigid_six_times(tmp_path: Path, kind: str) -> None:
    points = "points: {middle: {on: plate, at: [0.3, 0.2]}, corner: {on: plate, at: [0, 0]}}\n"
    whole = written(tmp_path, "whole", f"parts: {{plate: {kind}}}\n{points}")
    reduce_model(whole, "plate", Extent(up_to_hz=1500.0), tmp_path / "plate.npz", (), "", quiet)
    built = written(tmp_path, "built", "parts: {plate: {type: reduced, file: plate.npz}}\n")
    exact = basis_of(whole, 8)
    for count in (1, 3, 5):  # fewer than are rigid
        few = basis_of(built, count)
        assert few.kind[few.modes] == ("rigid",) * count
        assert few.complete_below_hz == 0.0  # not a frequency that is rounding
    all_rigid = basis_of(built, 8)
    assert all_rigid.n_rigid == 6 and np.all(all_rigid.omega[:6] == 0.0)
    # a twentieth of the band: what the modes above it add at most
    assert all_rigid.frequency_hz[6:8] == pytest.approx(exact.frequency_hz[6:8], rel=1e-4)
    assert all_rigid.complete_below_hz > all_rigid.frequency_hz[7]


def test_a_reduced_plate_sinks_under_its_weight_as_the_plate_does(tmp_path: Path) -> None:
    """Its interface is its feet and a point: the weight of all its nodes acts on these."""
    text = (
        "parts: {plate: KIND}\n"
        "points: {middle: {on: plate, at: [0.3, 0.2ZERO]}, feet: {on: plate, at: [FEET]}}\n"
        "supports: {posts: {at: feet, fix: [x, y, z]}}\n"
    )
    feet = [(x, y) for x in ("0", "0.6") for y in ("0", "0.4")]
    found = []
    for name, kind, zero in (("whole", SLAB, ""), ("built", "{type: reduced, file: plate.npz}", ", 0")):
        at = ", ".join(f"[{x}, {y}{zero}]" for x, y in feet)
        path = written(tmp_path, name, text.replace("KIND", kind).replace("ZERO", zero).replace("FEET", at))
        model = fs.read_model(path)
        rest = fs.statics(model, fs.assemble(model), [], weight=True)
        found.append((rest.of(model.points["middle"].probe("z")), *rest.forces["posts"], *rest.load))
        if name == "whole":
            reduce_model(path, "plate", Extent(up_to_hz=1500.0), tmp_path / "plate.npz", (), "", quiet)
    assert found[1] == pytest.approx(found[0], rel=1e-7, abs=1e-6)  # Craig and Bampton: statics of the interface exact
    assert found[1][0] == pytest.approx(found[0][0], rel=1e-7)  # the same
    assert found[1][3] == pytest.approx(-7850.0 * 0.6 * 0.4 * 0.003 * 9.80665, rel=1e-9)  # rounding


MAST = "{type: frame, material: steel, section: tube, lines: [[[0.3, 0.2, 0], [0.3, 0.2, 0.4]]], mesh: 50 mm}"
RIB = (
    "{type: frame, material: steel, section: tube, lines: [[[0, 0.2, 0], [0.6, 0.2, 0]]], mesh: 25 mm, "
    "offsets: {start: [0, 0, -16.5 mm], end: [0, 0, -16.5 mm]}}"
)
REDUCED = "{type: reduced, file: bars.npz}"


def on_a_plate(folder: Path, name: str, plate: str, bars: str) -> Path:
    text = (
        "sections: {tube: {shape: tube, outer: 30 mm, thickness: 2 mm}}\n"
        f"parts: {{plate: {plate}, bars: {bars}}}\n"
        "joints: {foot: {connect: [bars, plate]}}\n"
        "points: {corners: {on: plate, at: [[0, 0], [0.6, 0], [0, 0.4], [0.6, 0.4]]}}\n"
        "supports: {posts: {at: corners, fix: [x, y, z]}}\n"
    )
    return written(folder, name, text)


@pytest.mark.parametrize("plate", [SLAB, PLATE], ids=["slab", "plate"])
@pytest.mark.parametrize("bars", [MAST, RIB], ids=["mast", "rib"])
def test_reduced_bars_are_joined_to_a_plate_as_the_bars_are(tmp_path: Path, plate: str, bars: str) -> None:
    """A mast turns a patch as wide as its section; a rib is tied where its face touches, beside its axis."""
    whole = on_a_plate(tmp_path, "whole", plate, bars)
    reduce_model(whole, "bars", Extent(up_to_hz=2000.0), tmp_path / "bars.npz", (), "", quiet)
    built = on_a_plate(tmp_path, "built", plate, REDUCED)
    exact, found = basis_of(whole, 12), basis_of(built, 12)
    # 12 modes end at 300 Hz, a sixth of what was kept; one among them is the mast's turn about its axis
    assert found.frequency_hz[:12] == pytest.approx(exact.frequency_hz[:12], rel=1e-5)


@pytest.mark.parametrize("plate", [SLAB, PLATE], ids=["slab", "plate"])
@pytest.mark.parametrize("bars", [MAST, RIB], ids=["mast", "rib"])
def test_bars_are_joined_to_a_reduced_plate_as_to_the_plate(tmp_path: Path, plate: str, bars: str) -> None:
    """A rib is tied on the face of what the plate was, and not in all rotations: frequencies were up to 0.5 % high."""
    plate, bars = (one.replace("25 mm", "50 mm") for one in (plate, bars))  # of the mesh
    whole = on_a_plate(tmp_path, "whole", plate, bars)
    reduce_model(whole, "plate", Extent(up_to_hz=2000.0), tmp_path / "bars.npz", (), "", quiet)
    text = whole.read_text().replace(plate, REDUCED)
    corners = "at: [[0, 0, 0], [0.6, 0, 0], [0, 0.4, 0], [0.6, 0.4, 0]]"
    built = tmp_path / "built.yaml"
    built.write_text(text.replace("at: [[0, 0], [0.6, 0], [0, 0.4], [0.6, 0.4]]", corners))
    exact, found = basis_of(whole, 12), basis_of(built, 12)
    assert found.frequency_hz[:12] == pytest.approx(exact.frequency_hz[:12], rel=1e-5)  # of the modes that were kept


DECK = "{type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.6, 0.4], mesh: 100 mm}"
TABLE = """
sections: {flat: {shape: rectangle, width: 10 mm, height: 20 mm}, tube: {shape: tube, outer: 20 mm, thickness: 2 mm}}
parts:
  deck: KIND
  rib:
    type: frame
    material: steel
    section: flat
    lines: [[[0, 0.2, 0], [0.6, 0.2, 0]]]
    offsets: {start: ARM, end: ARM}
  posts:
    type: frame
    material: steel
    section: tube
    lines: [[[0, 0.2, 0], [0, 0.2, -0.3]], [[0.6, 0.2, 0], [0.6, 0.2, -0.3]]]
joints: {weld: {connect: [deck, rib]}, heads: {connect: [deck, posts]}}
points:
  middle: {on: deck, at: [0.3, 0.2ZERO]}
  feet: {on: posts, at: [[0, 0.2, -0.3], [0.6, 0.2, -0.3]]}
supports: {floor: {at: feet, fix: clamped}}
"""


def test_a_rib_and_its_posts_meet_on_a_reduced_plate_as_on_the_plate(tmp_path: Path) -> None:
    """The moment of a post goes into the plate beside the rib, whose slope is its own: where all their rotations were
    tied, a deck sagged a third too little."""
    text = TABLE.replace("ARM", "[0, 0, -11.5 mm]")
    whole = written(tmp_path, "whole", text.replace("KIND", DECK).replace("ZERO", ""))
    reduce_model(whole, "deck", Extent(up_to_hz=1500.0), tmp_path / "bars.npz", (), "", quiet)
    built = written(tmp_path, "built", text.replace("KIND", REDUCED).replace("ZERO", ", 0"))
    sags = []
    for path in (whole, built):
        model = fs.read_model(path)
        sags.append(fs.statics(model, fs.assemble(model), [], weight=True).of(model.points["middle"].probe("z")))
    assert sags[1] == pytest.approx(sags[0], rel=1e-6)  # Craig and Bampton: statics of the interface exact
    found = basis_of(built, 6).frequency_hz[:6]
    assert found == pytest.approx(basis_of(whole, 6).frequency_hz[:6], rel=1e-5)  # of the modes that were kept


def test_a_file_without_the_section_of_its_bars_is_written_again(tmp_path: Path) -> None:
    whole = on_a_plate(tmp_path, "whole", SLAB, MAST)
    reduce_model(whole, "bars", Extent(up_to_hz=2000.0), tmp_path / "bars.npz", (), "", quiet)
    with np.load(tmp_path / "bars.npz") as file:
        kept = {name: file[name] for name in file if name not in ("girth", "beside")}
    np.savez(tmp_path / "bars.npz", **kept)
    with pytest.raises(InputError, match="write it again with 'femstruct reduce'"):
        fs.read_model(on_a_plate(tmp_path, "built", SLAB, REDUCED))
