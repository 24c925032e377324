"""What every results file promises: units, descriptions, checksums, named axes, a way back, nothing half."""

import importlib
import json
import re
import runpy
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from importlib.metadata import EntryPoint
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from scipy.sparse import csr_array

from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from acoustics.levels.rated import rate_room
from acoustics.levels.standards import STANDARDS, method_of
from acoustics.losses import losses_from_t60
from femstruct.conventions import COMPONENTS
from femstruct.errors import FemstructError, InputError
from femstruct.files import stored_values
from femstruct.files import stored_values as kinds_by_tag
from femstruct.files.datasets import LENGTH, key, seal
from femstruct.files.results_file import read_results, write_results
from femstruct.files.stored_values import NotKept, restore_value, store_value, without_unread
from femstruct.files.study_tables import summary
from femstruct.impact.motion import Motion
from femstruct.language.cases import read_study
from femstruct.modal.basis import ForceRow
from femstruct.model.probe import Probe
from femstruct.view.page import report
from femstruct.workflow.run import run_study

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))


@pytest.fixture(scope="module")
def result():
    return BY_HAND["study_by_hand"]()


@pytest.fixture(scope="module")
def path(result, tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "results.h5"
    write_results(path, result)
    return path


def datasets(path):
    with h5py.File(path, "r") as file:
        found = []
        file.visititems(lambda name, item: found.append((name, item)) if isinstance(item, h5py.Dataset) else None)
        yield from found


def test_every_dataset_says_what_it_is(path):
    seen = list(datasets(path))
    assert len(seen) > 80
    for name, item in datasets(path):
        assert item.attrs.get("description"), name
        assert "unit" in item.attrs, name


def test_every_dataset_has_a_checksum(path):
    for name, item in datasets(path):
        assert item.fletcher32 or "sha256" in item.attrs or not item.size, name


def test_every_axis_outside_vtkhdf_is_named(path):
    for name, item in datasets(path):
        if not name.startswith("VTKHDF") and not item.is_scale:
            assert all(len(dimension) for dimension in item.dims), name


def test_complete_and_readable_by_older_hdf5(path):
    with h5py.File(path, "r") as file:
        assert file.attrs["complete"]
        assert file.attrs["format_version"] == 5
    # superblock version, byte 8: below 3, which HDF5 1.8 reads too; "latest" of HDF5 2 is read by no VTK yet
    assert path.read_bytes()[8] < 3


def assert_same(one, other, where="result"):
    """To the last bit, whole: classes, fields, keys and their order, arrays with their types."""
    assert type(one.item() if isinstance(one, np.generic) else one) is type(other), where
    if isinstance(one, NotKept):
        assert one.what == other.what
        return
    if isinstance(one, np.ndarray):
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes()), where
        assert not other.flags.writeable, where
    elif isinstance(one, csr_array):
        assert one.shape == other.shape and (one != other).nnz == 0, where
    elif is_dataclass(one):
        for field in fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name), f"{where}.{field.name}")
    elif isinstance(one, Mapping):
        assert list(one) == list(other), where
        for name in one:
            assert_same(one[name], other[name], f"{where}[{name!r}]")
    elif isinstance(one, tuple | list):
        assert len(one) == len(other), where
        for number, (mine, theirs) in enumerate(zip(one, other, strict=True)):
            assert_same(mine, theirs, f"{where}[{number}]")
    else:
        assert one == other or (one != one and other != other), where


def test_reads_back_what_was_written(result, path):
    """All nouns, and with them all that is made of these: tables, pictures, pages."""
    stored = read_results(path)
    assert_same(result, stored)
    assert summary(stored) == summary(result) and report(stored) == report(result)
    case = stored.cases["without damper"]
    assert case.response.basis is case.basis and stored.models["abc123"].mesh.points is case.basis.points


def test_no_array_is_stored_twice(path):
    """What is in a table is not written once more for the nouns; alike arrays are one."""
    sizes = [(item.nbytes, name) for name, item in datasets(path) if name.startswith("arrays/")]
    with h5py.File(path) as file:
        arrays = [
            (file[name].dtype, file[name].shape, file[name][()].tobytes()) for size, name in sizes if size >= 4096
        ]
        tables = [item[()] for name, item in datasets(path) if item.nbytes >= 4096 and not name.startswith("arrays/")]
    assert len(arrays) == len(set(arrays)) > 3
    assert not set(arrays) & {(table.dtype, table.shape, table.tobytes()) for table in tables}


def test_arrays_that_look_alike_are_two(result, tmp_path):
    """One number of a thousand differs, where nobody looks at first sight; a zero of the other sign is another one."""
    zeros, one, minus = np.zeros(6400), np.zeros(6400), np.zeros(6400)
    one[1], minus[3] = 1.0, -0.0
    write_results(tmp_path / "alike.h5", replace(result, verdicts={"zeros": zeros, "one": one, "minus": minus}))
    read = read_results(tmp_path / "alike.h5").verdicts
    assert [read[name].tobytes() for name in read] == [zeros.tobytes(), one.tobytes(), minus.tobytes()]


def test_a_law_of_somebodys_own_leaves_its_name(result, tmp_path):
    """Code is not kept in a file: what is read says so when it is called."""

    class Law:
        def __call__(self, x):
            return x

    changed = replace(result, verdicts={"law": lambda x: x, "other": Law()})
    write_results(tmp_path / "own.h5", changed)
    read = read_results(tmp_path / "own.h5").verdicts
    for word in ("law", "other"):
        with pytest.raises(FemstructError, match="of which a results file has only the name"):
            read[word](1.0)


def test_nouns_of_a_package_that_adds_some_are_read(result, tmp_path, monkeypatch):
    """What an entry point names may be in a file; without the package the error names it."""
    (tmp_path / "outer_part.py").write_text(
        "from dataclasses import dataclass\n@dataclass(frozen=True)\nclass Thing:\n    mass: float\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    thing = importlib.import_module("outer_part").Thing(2.0)
    write_results(tmp_path / "outer.h5", replace(result, verdicts={"thing": thing}))
    with pytest.raises(InputError, match="install the package 'outer_part'"):
        read_results(tmp_path / "outer.h5")
    monkeypatch.setattr(kinds_by_tag, "entry_points", lambda group: [EntryPoint("thing", "outer_part:Thing", group)])
    assert read_results(tmp_path / "outer.h5").verdicts == {"thing": thing}


def test_a_field_that_an_older_file_lacks_has_its_default():
    """Files are read that were written before a noun had a field: its default is made as when the noun is made."""
    tables = stored_values.store_value(
        ForceRow(np.array([1.0]), np.array([2.0]), np.array([3.0])), keep=lambda array: None
    )
    for one in tables.nouns:
        one.pop("carried", None)
    made = stored_values.restore_value(tables, fetch=lambda place: None)
    np.testing.assert_array_equal(made.carried, np.zeros(3))
    np.testing.assert_array_equal(made.damping, [2.0])


def test_only_nouns_are_read(result, path, tmp_path):
    """A file can name no class and no function of another package, and nothing here that has no tag or is no noun."""
    wrong = (
        ("os:system", "install the package 'os'"),
        ("os: system/1", "install the package 'os'"),
        ("femstruct.exits:Path", "a noun of femstruct"),
        ("energy average/1", "expected a noun"),
        ("no such thing/1", "got 'no such thing/1', expected a noun that this version knows; use the version of femst"),
    )
    for name, told in wrong:
        changed = tmp_path / "changed.h5"
        changed.write_bytes(path.read_bytes())
        with h5py.File(changed, "r+") as file:
            text = file["nouns"].asstr()[()]
            assert '"spot/1"' in text and "femstruct." not in text
            text = text.replace('"spot/1"', f'"{name}"')
            del file["nouns"]
            file["nouns"] = text
        sealed_anew(changed)
        with pytest.raises(InputError, match=told):
            read_results(changed)


def test_the_lines_of_the_readme_open_a_case(result, path, monkeypatch):
    told = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    lines = re.findall(r"`((?:read_results|xarray\.open_dataset)\(.*?)`", told)
    assert len(lines) == 2
    monkeypatch.chdir(path.parent)
    for line in lines:
        code = line.replace("results.h5", path.name).replace("NAME", "without damper")
        channels = eval(code, {"read_results": read_results, "xarray": xarray})
        velocity = result.cases["without damper"].channels["O_f.z velocity"].values
        found = channels["O_f.z velocity"]
        np.testing.assert_array_equal(found if isinstance(found, xarray.DataArray) else found.values, velocity)
        getattr(channels, "close", lambda: None)()


def test_xarray_opens_labelled_tables(result, path):
    with xarray.open_dataset(path, group="cases/without damper/channels", engine="h5netcdf") as table:
        case = result.cases["without damper"]
        np.testing.assert_array_equal(table["time"], case.response.t)
        np.testing.assert_array_equal(table["O_f.z velocity"], case.channels["O_f.z velocity"].values)
        assert table["O_f.z velocity"].attrs["units"] == "m/s"
    with xarray.open_dataset(path, group="cases/without damper/contacts", engine="h5netcdf") as table:
        force = table["force"].sel(contact="ball on floor")
        np.testing.assert_array_equal(force, case.response.contacts["ball on floor"].force)
    with xarray.open_dataset(path, group="cases/without damper/frf/centre", engine="h5netcdf") as table:
        np.testing.assert_array_equal(table["response"], case.frf["centre"].values)
        assert table["response"].dims == ("frequency_hz",)


def test_units_and_long_names_are_what_xarray_shows(path):
    with h5py.File(path) as file:
        assert file.attrs["Conventions"].startswith("CF-")
    for name, item in datasets(path):
        if name.startswith(("cases/", "bases/")):
            assert item.attrs["units"] == item.attrs["unit"] and item.attrs["long_name"] == item.attrs["description"]


def test_an_older_file_and_a_newer_one_say_so(path, tmp_path):
    for version, told in (
        (3, "got format version 3, expected 4 to 5; run the study again"),
        (6, "the version of femstruct that"),
    ):
        other = tmp_path / "other.h5"
        other.write_bytes(path.read_bytes()[:-LENGTH])
        with h5py.File(other, "r+") as file:
            file.attrs["format_version"] = version
        sealed_anew(other)
        with pytest.raises(InputError, match=told):
            read_results(other)


@pytest.mark.parametrize("word", ["kg^-0.5", "Mass-normalised shapes", "By hand", "Made by hand.", "0.1.0", "m/s"])
def test_two_flipped_bits_of_an_attribute_are_caught(path, tmp_path, word):
    """Units, descriptions, provenance, findings: attributes, of which HDF5 itself has no checksum."""
    data = bytearray(path.read_bytes())
    place = data.index(word.encode())
    data[place] ^= 1
    data[place + 1] ^= 1
    (tmp_path / "flipped.h5").write_bytes(data)
    with pytest.raises(InputError, match="do not have the checksum"):
        read_results(tmp_path / "flipped.h5")


def test_xarray_opens_all_stages_of_a_case(path):
    with xarray.open_datatree(path, group="/cases/without damper", engine="h5netcdf") as tree:
        assert {"/channels", "/energy", "/rooms/box", "/levels/box.mic", "/modal"} <= set(tree.groups)


def test_motion_of_the_modes_is_kept_only_on_demand(result, path, tmp_path):
    with h5py.File(path, "r") as file:
        np.testing.assert_array_equal(file["cases/without damper/modal/q"], result.cases["without damper"].response.q)
    light = tmp_path / "light.h5"
    write_results(light, BY_HAND["study_by_hand"](save_modal=False))
    with h5py.File(light, "r") as file:
        assert "modal" not in file["cases/without damper"]


def test_what_no_reader_uses_is_left_out(path, tmp_path):
    """Without `save: modal`, the motion of the modes and what couples them in parts; whoever asks for it is told."""
    light, again = tmp_path / "light.h5", tmp_path / "again.h5"
    given = BY_HAND["study_by_hand"](save_modal=False)
    write_results(light, given)
    assert light.stat().st_size < 0.8 * path.stat().st_size
    assert isinstance(read_results(light).cases["without damper"].response.motion, Motion)  # its room is drawn
    case = read_results(light).cases["damper 0.6 / new"]
    response, row = case.response, case.basis.shapes[40, 2]
    for ask in (
        lambda: response.velocity(row),
        lambda: response.acceleration(row),
        lambda: response.qdd,
        lambda: read_results(light).cases["without damper"].response.qdd,
        lambda: response.pushes[0],
        lambda: np.array([1.0]) @ response.pushes,
        lambda: len(response.pushes),
    ):
        with pytest.raises(FemstructError, match="a results file without it, expected the whole; run the study again"):
            ask()
    before, floor = given.cases["damper 0.6 / new"].basis, case.basis.part_stiffness["floor"]
    np.testing.assert_array_equal(np.diag(floor), np.diag(before.part_stiffness["floor"]))
    assert np.isnan(floor[~np.eye(len(floor), dtype=bool)]).all()
    np.testing.assert_array_equal(case.basis.time_damping, before.time_damping)
    write_results(again, read_results(light))
    assert_same(read_results(light), read_results(again))
    with h5py.File(light) as one, h5py.File(again) as other:
        name = "bases/abc123/strain_energy_share"
        np.testing.assert_array_equal(one[name], other[name])


COUPLED = """
title: A plate on a spring with a dashpot, which couples its modes
parts:
  slab: {type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 1], size: [0.6, 0.4], mesh: [3, 2]}
  post: {type: spring, between: [middle, ground], stiffness: {z: 50 kN/m}, damping: {z: 800 N*s/m}}
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850, loss_factor: 1 %}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {middle: {on: slab, at: [0.25, 0.2]}}
surfaces: {below: {on: slab, side: below}}
"""
HIT = """
model: model.yaml
modes: {count: 12}
bodies: {ball: {mass: 50 g, above: middle, speed: 1 m/s, contact: {type: hertz, stiffness: 3.7e5}}}
time: {duration: 50 ms, sampling: 4 kHz}
rooms:
  box: {size: [0.6, 0.4, 1], under: below, losses: {t60: 0.5 s}, receivers: {mic: [0.2, 0.1, 0.3]}}
"""


def test_motion_of_coupled_modes_is_whole_again(tmp_path):
    """Half of what turns oscillators into modes is made of the other half, to the last bit."""
    (tmp_path / "model.yaml").write_text(COUPLED, encoding="utf-8")
    (tmp_path / "hit.study.yaml").write_text(HIT, encoding="utf-8")
    result = run_study(read_study(tmp_path / "hit.study.yaml"))
    write_results(tmp_path / "results.h5", result)
    before, after = (one.cases["as given"].response.motion for one in (result, read_results(tmp_path / "results.h5")))
    assert before.turn.shape[0] == 4 and before.turn.size > 256
    assert_same(before, after)
    with h5py.File(tmp_path / "results.h5") as file:
        tables = json.loads(file["nouns"].asstr()[()])
        (kept,) = [noun for noun in tables[0] if noun["is"] == "motion of coordinates/1"]
        place, row = kept["turn"]["array"]
        assert row is None and file[place].shape == (2, *before.turn.shape[1:])


def test_large_arrays_are_compressed_and_small_ones_stand_as_they_are(path):
    """Exactly the same numbers; chunks of small arrays would be larger than these."""
    kept = [item for _, item in datasets(path) if item.dtype.kind in "iufc" and item.nbytes]
    large = [item for item in kept if item.nbytes > 4096]
    assert len(large) > 20 and len(large) < len(kept)
    for _, item in datasets(path):
        packed = item.dtype.kind in "iufcb" and item.nbytes > 4096 and not item.name.startswith("/arrays/of ")
        assert (item.compression, item.compression_opts, item.shuffle) == (
            ("gzip", 4, True) if packed else (None, None, False)
        )
        assert (item.chunks is not None) == packed


def test_loads_that_pass_straight_on_are_kept(result, path):
    """`ForceRow.direct` entry by entry: what a load at a probe adds to the force of the ground."""
    with xarray.open_dataset(path, group="bases/abc123/direct", engine="h5netcdf") as table:
        where = [COMPONENTS.index(name) for name in table["component"].values]
        kept = Probe(table["node"].values, where, table["weight"].values)
        assert set(table["output"].values) == {"ground.z"}
    direct = result.bases["abc123"].outputs["ground.z"].direct
    load = Probe([3, 40], [2, 4], [2.0, 1.0])
    assert kept.meets(load) == direct.meets(load) == 0.25 * 2.0 - 0.5


def test_losses_are_booked_apart(result, path):
    """In results.h5 and in --json: modes, dashpots, contacts and links add up to what was dissipated."""
    for name, case in result.cases.items():
        end = case.response.ledger.end
        told = summary(result)["cases"][name]["energy"]["end"]["lost"]
        assert told == {
            "modes": end.lost_modes,
            "dashpots": 0.0,
            "contacts": dict(end.lost_contacts),
            "links": dict(end.lost_links),
        }
        with h5py.File(path, "r") as file:
            lost = file[f"cases/{key(name)}/energy/lost"]
            assert lost["end"][:].sum() == pytest.approx(end.dissipated, abs=0)
            assert lost["taker"].asstr()[:].tolist() == ["modes", "dashpots", *end.lost_contacts, *end.lost_links]
            assert lost["place"].asstr()[:].tolist() == ["structure", *end.lost_contacts, *end.lost_links]
            ledger = case.response.ledger
            assert (
                lost["until_now"].shape == (len(lost["place"]), len(ledger.t)) and lost["time"].shape == ledger.t.shape
            )
            # rounding: none here
            assert lost["until_now"][:].sum(axis=0) == pytest.approx(ledger.dissipated, rel=1e-13)


def test_no_response_no_room_no_frf(result, tmp_path):
    """A study of modes only still has a file."""
    bare = {
        name: replace(case, response=None, frf={}, channels={}, rooms={}, levels={})
        for name, case in result.cases.items()
    }
    write_results(tmp_path / "bare.h5", replace(result, cases=bare))
    stored = read_results(tmp_path / "bare.h5")
    assert stored.cases["without damper"].response is None and not stored.cases["without damper"].channels


def sealed_anew(path):
    """A file that somebody wrote on purpose, with the checksum that belongs to it."""
    data = path.read_bytes()
    path.write_bytes(data + seal(memoryview(data)))


def test_incomplete_other_and_missing_files_are_refused(path, tmp_path):
    half = tmp_path / "half.h5"
    half.write_bytes(path.read_bytes())
    with h5py.File(half, "r+") as file:
        file.attrs["complete"] = False
    sealed_anew(half)
    with pytest.raises(InputError, match="an incomplete file"):
        read_results(half)
    with h5py.File(half, "r+") as file:
        del file.attrs["complete"]
    sealed_anew(half)
    with pytest.raises(InputError, match="an incomplete file"):
        read_results(half)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["complete"] = True
    with pytest.raises(InputError, match="without its checksum"):
        read_results(tmp_path / "other.h5")
    sealed_anew(tmp_path / "other.h5")
    with pytest.raises(InputError, match="another kind"):
        read_results(tmp_path / "other.h5")
    (tmp_path / "text.h5").write_text("not HDF5")
    sealed_anew(tmp_path / "text.h5")
    with pytest.raises(InputError, match="cannot be read"):
        read_results(tmp_path / "text.h5")
    with pytest.raises(InputError, match="no such file"):
        read_results(tmp_path / "none.h5")


def test_bodies_without_a_structure_are_written_and_read(tmp_path):
    """No node and no mode, so every array of shapes is empty."""
    models = Path(__file__).parents[2] / "models"
    result = run_study(read_study(models / "tennis_ball_drop.study.yaml"))
    write_results(tmp_path / "results.h5", result)
    stored = read_results(tmp_path / "results.h5")
    assert_same(without_unread(result).cases, stored.cases)
    assert [basis.kind for basis in stored.bases.values()] == [()]


def test_the_folder_of_a_run_is_read(result, path, tmp_path):
    assert read_results(path.parent).plan.title == result.plan.title
    with pytest.raises(InputError, match=r"results\.h5: got no such file, expected .* the folder of a run"):
        read_results(tmp_path)


@pytest.mark.parametrize("standard", STANDARDS)
@pytest.mark.parametrize("blows", ["heavy", "tapping"])
def test_rated_rooms_keep_their_numbers(standard, blows):
    """What makes a single number of the bands is found again, by all standards: the bang machine's was not."""
    try:
        method = method_of([standard], blows)
    except AcousticsError:
        return  # a source that the standard does not rate
    levels = dict(zip(method.bands_hz, np.linspace(80.0, 50.0, len(method.bands_hz)).tolist(), strict=True))
    own = Room([5.0, 4.0, 2.5], losses=losses_from_t60(0.5))
    room = rate_room([[levels]], own, [standard], blows)
    kept = []
    again = restore_value(store_value(room, lambda array: kept.append(array) or len(kept) - 1), kept.__getitem__)
    assert_same(dict(room.numbers), dict(again.numbers))


@pytest.mark.parametrize("number", [1.0 + 2.0j, complex("nan"), complex(1.0, float("inf"))])
def test_complex_numbers_that_are_none_are_kept(number):
    """A frequency response that is not known at a line, alone and in a small array."""
    told = store_value({"one": number, "some": np.array([number, 0.5j])}, lambda array: None)
    again = restore_value(json.loads(json.dumps(told, allow_nan=False)) and told, lambda place: None)
    assert np.array_equal([again["one"], *again["some"]], [number, number, 0.5j], equal_nan=True)
