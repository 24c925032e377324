"""Recorded stresses: from all histories at once, limited, found again in the file and in pictures."""

from pathlib import Path

import numpy as np
import pytest

from femstruct.elements.stresses import von_mises
from femstruct.errors import InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.impact.resampled import resample
from femstruct.language.cases import read_study
from femstruct.view.answer_tables import stresses
from femstruct.view.case_tables import limits
from femstruct.workflow.recorded_channels import in_band, largest_stress, walk_stresses
from femstruct.workflow.run import run_study

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3, loss_factor: 1 %}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 20 mm}}
parts:
  floor: {type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 0.5], size: [0.5, 0.4], mesh: 50 mm}
  leg: {type: frame, material: steel, section: bar, lines: [[[0.25, 0.2, 0], [0.25, 0.2, 0.5]]], mesh: 0.1}
joints: {weld: {connect: [leg, floor]}}
points: {hit: {on: floor, at: [0.1, 0.1]}, foot: {on: leg, at: [0.25, 0.2, 0]}}
supports: {clamp: {at: foot, fix: clamped}, rim: {on: floor, edge: all, fix: simple}}
"""
STUDY = """
model: model.yaml
modes: {up_to: 1.5 kHz}
bodies: {ball: {mass: 0.1 kg, above: hit, speed: 1 m/s, contact: {type: linear, stiffness: 100 kN/m}}}
record: {floor: stress, leg: stress}
limits: {floor stress: 20 MPa, leg stress: 1 kPa}
time: {duration: 20 ms, sampling: 20 kHz}
"""


def study(folder, **changes):
    text = STUDY
    for old, new in changes.items():
        text = text.replace({"record": "record: {floor: stress, leg: stress}", "extra": "time:"}[old], new)
    Path(folder, "model.yaml").write_text(MODEL, encoding="utf-8")
    path = Path(folder, "hit.study.yaml")
    path.write_text(text, encoding="utf-8")
    return read_study(path)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return run_study(study(tmp_path_factory.mktemp("stress")))


@pytest.mark.parametrize("part", ["floor", "leg"])
def test_the_largest_stress_is_that_of_all_histories(result, part):
    """Every stress of every place at every sample at once, against what is evaluated block by block."""
    case = result.cases["as given"]
    (model,) = result.models.values()
    places = model.parts[part].stresses(model.mesh.n_nodes)
    seen = resample(case.response)
    stress = np.einsum("pck,kt->pct", places.of(seen.basis.shapes), seen.q)
    equivalent = von_mises(stress, places.components)
    channel = case.channels[f"{part} stress"]
    np.testing.assert_allclose(channel.stressed.largest, equivalent.max(axis=1), rtol=1e-9)  # rounding
    assert channel.whole == pytest.approx(equivalent.max(), rel=1e-9)  # rounding
    at_samples = von_mises(np.einsum("pck,kt->pct", places.of(seen.basis.shapes), case.response.q), places.components)
    np.testing.assert_allclose(channel.values, at_samples.max(axis=0), rtol=1e-9, atol=1.0)  # rounding, of 1e7 Pa
    worst, sample = np.unravel_index(equivalent.argmax(), equivalent.shape)
    assert channel.stressed.worst == worst
    assert channel.stressed.time[worst] == seen.t[sample]


def test_blocks_of_any_length_give_the_same(result, monkeypatch):
    case = result.cases["as given"]
    (model,) = result.models.values()
    places, q = model.parts["leg"].stresses(model.mesh.n_nodes), case.response.q
    whole = walk_stresses(places, case.basis.shapes, q)
    monkeypatch.setattr("femstruct.workflow.recorded_channels.AT_ONCE", 1000)
    for one, other in zip(whole, walk_stresses(places, case.basis.shapes, q), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)  # rounding of products of other shapes


def test_limits_of_stresses_are_judged_and_shown_in_mpa(result):
    floor, leg = result.verdicts["as given"]
    assert (floor.met, leg.met) == (result.cases["as given"].channels["floor stress"].whole <= 20e6, False)
    shown = str(limits(result).rows)
    assert "20 MPa" in shown
    assert "1000 Pa" in shown
    assert {row[0] for row in stresses(result).rows} == {"floor", "leg"}


def test_a_point_force_has_no_stress_to_quote(result):
    """Under a force on a point of a thin plate the stress is infinite: the finding has where and how much."""
    (found,) = [
        one for one in result.cases["as given"].findings if one.code == "stress-uneven" and "floor" in one.message
    ]
    assert found.values["falls"] > found.values["allowed"] == 0.2
    assert "(0.1, 0.1, 0.5" in found.message


def test_the_results_file_has_them(result, tmp_path):
    write_results(tmp_path / "results.h5", result)
    again = read_results(tmp_path / "results.h5").cases["as given"].channels["leg stress"]
    own = result.cases["as given"].channels["leg stress"]
    np.testing.assert_array_equal(again.stressed.largest, own.stressed.largest)
    import h5py

    with h5py.File(tmp_path / "results.h5") as file:
        stored = file["cases/as given/stresses/leg stress"]
        assert stored["largest"].attrs["unit"] == "Pa"
        assert stored.attrs["where"] == own.stressed.where


def test_filtered_is_the_motion_not_the_stress(tmp_path):
    filtered = run_study(study(tmp_path, extra="peaks: {lowpass: 1 kHz}\ntime:")).cases["as given"]
    seen = resample(filtered.response)
    (places,) = [part.stresses(len(filtered.basis.points)) for part in _parts(filtered, tmp_path) if part.name == "leg"]
    _, exact = largest_stress(places, seen, in_band(seen.q, seen.clock.sampling, (0.0, 1000.0)))
    assert filtered.channels["leg stress"].whole == pytest.approx(exact.largest.max(), rel=1e-9)  # rounding
    assert filtered.channels["leg stress"].whole < filtered.channels["leg stress"].values.max()


def _parts(case, folder):
    from femstruct.language.models import read_model
    from femstruct.model.mesher import mesh_structure

    return mesh_structure(read_model(Path(folder, "model.yaml")).structure).parts.values()


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (
            "record: {flor: stress}",
            "record.flor: got 'stress' of 'flor', expected the name of a part with stresses; did you mean",
        ),
        ("record: {hit.z: stress}", "record.hit.z: got 'stress' of 'hit.z', expected the name of a part with stresses"),
        ("record: {floor: stress, leg: stress}\nlimits: {floor stress: 3 mm}", "expected a pressure"),
    ],
)
def test_mistakes_have_their_line(tmp_path, record, message):
    text = STUDY.replace("limits: {floor stress: 20 MPa, leg stress: 1 kPa}\n", "")
    Path(tmp_path, "model.yaml").write_text(MODEL, encoding="utf-8")
    path = Path(tmp_path, "hit.study.yaml")
    path.write_text(text.replace("record: {floor: stress, leg: stress}", record), encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_study(path)
    assert message in str(refused.value)
    assert "hit.study.yaml:" in str(refused.value)
