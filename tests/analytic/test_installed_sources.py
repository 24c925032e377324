"""Measured sources in place: contact forces against a model with the source in it, powers against losses, band levels
against a closed form and against lines of frequency responses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.findings.catalogue import CATALOGUE
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.damping import Damping, LossFactor
from femstruct.modal.frf import direct_frf, modal_amplitudes
from femstruct.modal.installed_sources import contact_forces, receiver_mobility, resonances_with
from femstruct.modal.steady import resonant_lines
from femstruct.model.model import Model
from femstruct.study.results import CaseResult

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
DAMPING = Damping(LossFactor(0.03))
HZ = np.array([40.0, 90.0, 163.0, 250.0, 377.0])


def model_of(mass: float = 0.0) -> Model:
    """A steel plate on its edges, with masses on both feet where there are any."""
    plate = fs.Plate("plate", STEEL, 4e-3, (0.0, 0.0, 1.0), (0.5, 0.4), 0.05)
    load = (fs.Mass("load", mass, at="feet"),) if mass else ()
    return fs.mesh_structure(
        fs.Structure(
            "a plate",
            (plate, *load),
            points=(fs.PlaceOn("feet", "plate", at=((0.15, 0.1), (0.35, 0.25))),),
            supports=(fs.Support("edges", "simple", on="plate", edge="all"),),
        )
    )


def basis_of(model: Model) -> ModalBasis:
    probes = [model.points[f"feet.{i}"].probe("z") for i in (1, 2)]
    return fs.with_damping(fs.modal_basis(fs.assemble(model), up_to=2500.0, probes=probes), DAMPING)


def test_contact_forces_are_those_of_a_model_with_the_source_in_it() -> None:
    """A rigid mass on each foot: the blocked force of one acts on it, and moves both feet as the whole model does."""
    mass, plate = 1.7, model_of()
    feet = [plate.points[f"feet.{i}"].probe("z") for i in (1, 2)]
    receiver = receiver_mobility(basis_of(plate), feet, HZ)
    found = contact_forces(receiver, fs.RigidMass(mass).impedance(HZ)).forces
    velocity = np.einsum("abf,bif->aif", receiver, found)
    whole = model_of(mass)
    both = [whole.points[f"feet.{i}"].probe("z") for i in (1, 2)]
    assembly = fs.assemble(whole)
    for i in (0, 1):
        for a in (0, 1):
            wanted = direct_frf(assembly, both[i], both[a], HZ, DAMPING, "mobility")
            # modes to six times the frequency and residual vectors, against all of the mesh
            assert np.abs(velocity[a, i] - wanted).max() < 1e-3 * np.abs(wanted).max(), (a, i)


@pytest.mark.parametrize(
    "source", [fs.RigidMass(1.7), fs.ForceSource(), fs.MeasuredMobility(((1.0, 2e-4, 3e-4), (1e3, 1e-3, -2e-4)))]
)
def test_what_comes_in_is_what_the_structure_loses(source: fs.RigidMass) -> None:
    """F^H Re(Y) F, of both contacts together, is the power that the dampings of the modes take."""
    plate = model_of()
    basis, feet = basis_of(plate), [plate.points[f"feet.{i}"].probe("z") for i in (1, 2)]
    found = contact_forces(receiver_mobility(basis, feet, HZ), source.impedance(HZ))
    q = np.stack([modal_amplitudes(basis, probe, HZ) for probe in feet], axis=1)
    moved = np.einsum("kaf,aif->kif", q, found.forces)
    w = 2 * np.pi * HZ
    lost = np.einsum("kif,kl,lif->if", moved.conj(), basis.viscous, moved).real * w**2
    lost += np.einsum("kif,kl,lif->if", moved.conj(), basis.hysteretic, moved).real * w
    assert found.power == pytest.approx(lost, rel=1e-9)  # rounding
    # and what comes in is what the source gives: of F_b v, less what its own mobility takes
    velocity = np.einsum("abf,bif->aif", receiver_mobility(basis, feet, HZ), found.forces)
    given = np.einsum("aif,aif->if", found.forces.conj(), velocity).real
    assert found.power == pytest.approx(given, rel=1e-9)  # rounding


def test_without_phase_the_power_lies_between_its_bounds() -> None:
    """Of all phases of a passive source at one contact, the bounds are reached and none is passed."""
    receiver = np.array([[[3e-4 + 4e-4j]]])
    for size in (1e-4, 5e-4, 2e-3):
        one = contact_forces(receiver, np.array([1 / size]), has_phase=False)
        phases = np.linspace(-np.pi / 2, np.pi / 2, 20001)
        powers = size**2 * 3e-4 / np.abs(size * np.exp(1j * phases) + receiver[0, 0, 0]) ** 2
        assert one.power[0, 0] == pytest.approx(size**2 * 3e-4 / (size**2 + 25e-8))
        assert (one.power * one.least)[0, 0] <= powers.min() * (1 + 1e-9)  # rounding
        assert powers.max() <= (one.power * one.most)[0, 0] * (1 + 1e-9)  # rounding


OSCILLATOR = "structure: {type: oscillator, mass: 2 kg, frequency: 50 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"


def run(folder: Path, sources: str, model: str = OSCILLATOR, more: str = "") -> CaseResult:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    path = folder / "a.study.yaml"
    path.write_text(f"model: model.yaml\nsources:\n  pump: {sources}\n{more}", encoding="utf-8")
    return fs.run_study(fs.read_study(path)).cases["as given"]


def test_noise_puts_its_density_over_four_masses_into_an_oscillator(tmp_path: Path) -> None:
    """S / 4 m of a force of one-sided density S, whatever stiffness and losses; here in all bands together."""
    psd = "{at: m.z, mobility: infinite, blocked_force: {psd: [[9 Hz, 8 N^2/Hz], [1.2 kHz, 8 N^2/Hz]]}}"
    found = run(tmp_path, psd).sources["pump"]
    total = sum(10 ** (level / 10) for level in found.power_db.values()) * 1e-12
    # above 1122 Hz there is 2 zeta w0 / (pi^2 f) of it, 1.1e-3; lines 6e-3
    assert total == pytest.approx(8.0 / (4 * 2.0) * (1 - 1.1e-3), rel=6e-3)
    bands = ", ".join(f"{band:g} Hz: {(8.0 * width) ** 0.5:.9g} N" for band, width in widths().items())
    again = run(tmp_path, f"{{at: m.z, mobility: infinite, blocked_force: {{{bands}}}}}").sources["pump"]
    assert dict(again.power_db) == pytest.approx({b: found.power_db[b] for b in widths()}, abs=5e-3)  # other lines


@pytest.mark.parametrize("ratio", [2.0, 0.1, 0.01])
def test_noise_of_a_heavy_source_resonates_with_the_structure(tmp_path: Path, ratio: float) -> None:
    """A mass of 5 kg on the oscillator of 2 kg: S / 4 (m + 5 kg), in a resonance at 26.7 Hz, where none of the
    structure's is."""
    psd = "{at: m.z, mass: 5 kg, blocked_force: {psd: [[4 Hz, 8 N^2/Hz], [1.2 kHz, 8 N^2/Hz]]}}"
    found = run(tmp_path, psd, OSCILLATOR.replace("2 %", f"{ratio} %")).sources["pump"]
    total = sum(10 ** (level / 10) for level in found.power_db.values()) * 1e-12
    assert total == pytest.approx(8.0 / (4 * 7.0), rel=6e-3)  # lines
    assert max(found.power_db, key=lambda band: found.power_db[band]) == 25.0


def test_resonances_with_masses_on_two_contacts() -> None:
    """Those of q'' (1 + m sum phi phi^T) + C q' + w^2 q = 0."""
    mass, ratios, hz = 0.8, np.array([1e-3, 5e-4, 2e-3]), np.array([30.0, 55.0, 90.0])
    rows = np.array([[0.9, 0.7, -0.4], [0.5, -0.8, 0.6]])
    basis, points = given_modes(hz, ratios, {"P": rows[0], "Q": rows[1]})
    w = 2 * np.pi * hz
    whole = np.eye(3) + mass * rows.T @ rows
    C, K = np.diag(2 * ratios * w), np.diag(w**2)
    state = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(whole, K), -np.linalg.solve(whole, C)]])
    values = np.linalg.eigvals(state) / (2 * np.pi)
    values = values[values.imag > 0.0]
    values = values[np.argsort(values.imag)]
    contacts = [points[name].probe("z") for name in ("P", "Q")]
    lines = resonant_lines(basis, (5.0, 120.0))
    found = resonances_with(basis, contacts, fs.RigidMass(mass), lines)
    order = np.argsort(found.hz)
    assert found.hz[order] == pytest.approx(values.imag, rel=1e-4)  # half bandwidths squared over distances
    assert found.half[order] == pytest.approx(-values.real, rel=1e-2)  # of light damping


def widths() -> dict[float, float]:
    found = fs.BandSpectrum(((40.0, 1.0), (50.0, 1.0), (63.0, 1.0)))
    return dict(zip((40.0, 50.0, 63.0), np.diff(found.edges, axis=1)[:, 0].tolist(), strict=True))


def test_free_velocity_and_blocked_force_are_one_source(tmp_path: Path) -> None:
    """v = Y F_b of a mass of 3 kg, line by line; and levels over their references."""
    force = [(f, 2.0 + 0.01 * f) for f in np.geomspace(35.0, 72.0, 200)]
    speed = [(f, value / (2 * np.pi * f * 3.0) ** 2) for f, value in force]
    (tmp_path / "force.csv").write_text("f;S\nHz;N^2/Hz\n" + "".join(f"{f:.9g};{s:.9g}\n" for f, s in force))
    (tmp_path / "speed.csv").write_text("f;S\nHz;m^2/s^2/Hz\n" + "".join(f"{f:.9g};{s:.9g}\n" for f, s in speed))
    first = run(tmp_path, "{at: m.z, mass: 3 kg, blocked_force: {psd: {file: force.csv}}}").sources["pump"]
    second = run(tmp_path, "{at: m.z, mass: 3 kg, free_velocity: {psd: {file: speed.csv}}}").sources["pump"]
    assert list(first.power_db) == [40.0, 50.0, 63.0]
    assert dict(second.power_db) == pytest.approx(dict(first.power_db), abs=1e-3)  # straight lines between points
    levels = "{50 Hz: 120 dB re 1e-6 N, 63 Hz: 0.1 N}"
    (tmp_path / "l.csv").write_text("f;L [dB re 1 µN]\n50 Hz;120,0\n63 Hz;100,0\n", encoding="cp1252")
    one = run(tmp_path, f"{{at: m.z, mass: 3 kg, blocked_force: {levels}}}").sources["pump"]
    two = run(tmp_path, "{at: m.z, mass: 3 kg, blocked_force: {file: l.csv}}").sources["pump"]
    assert dict(one.power_db) == pytest.approx(dict(two.power_db), abs=1e-9)  # rounding
    assert one.what == "blocked force" and one.excited_by == "m.z"


PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 4 mm, origin: [0, 0, 1], size: [0.5, 0.4], mesh: 50 mm}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {feet: {on: plate, at: [[0.15, 0.1], [0.33, 0.27]]}}
surfaces: {below: {on: plate, side: below}}
damping: {loss_factor: 3 %}
"""
ROOM = """
modes: {up_to: 700 Hz}
rooms: {box: {size: [0.5, 0.4, 0.7], under: below, losses: {t60: 0.3 s}, receivers: {mic: [0.1, 0.1, 0.2]}}}
"""


@pytest.mark.parametrize("losses", ["t60: 0.3 s", "beta: 0.5 %, at: 1 kHz"])  # 30 times as long at 100 Hz as at 562 Hz
def test_levels_in_a_room_are_sums_over_frequency_responses(losses: str, tmp_path: Path) -> None:
    """Two contacts without phase between them: p^2 = S1 int |p / F1|^2 df + S2 ..., by lines 0.1 Hz apart."""
    step, requests = 0.1, ""
    for i in (1, 2):
        spots = f"drive: feet.{i}.z, response: box.mic.pressure"
        requests += f"  r{i}: {{{spots}, kind: pressure, band: [70.8 Hz, 562.4 Hz], step: {step} Hz}}\n"
    bands = {
        100.0: (2.0, 0.5),
        125.0: (1.0, 1.5),
        250.0: (1.0, 1.2),
        400.0: (0.7, 0.3),
        500.0: (1.0, 1.0),
        800.0: (1.0, 1.0),
    }
    forces = [", ".join(f"{band:g} Hz: {both[i]} N" for band, both in bands.items()) for i in (0, 1)]
    source = f"{{at: feet.z, mobility: infinite, blocked_force: [{{{forces[0]}}}, {{{forces[1]}}}]}}"
    case = run(tmp_path, source, PLATE, f"frf:\n{requests}{ROOM.replace('t60: 0.3 s', losses)}")
    found = case.sources["pump"]
    for band in (100.0, 125.0, 250.0, 400.0, 500.0):
        (low, high), square = fs.BandSpectrum(((band, 1.0),)).edges[0], 0.0
        for i, frf in enumerate(case.frf.values()):
            inside = (frf.frequency_hz >= low) & (frf.frequency_hz <= high)
            square += bands[band][i] ** 2 * float(np.mean(np.abs(frf.values[inside]) ** 2))
        # .03 dB of the program's lines; a tenth of a hertz at either edge of bands of 23 Hz, .02 dB
        assert found.levels["box.mic"].bands_db[band] == pytest.approx(10 * np.log10(square / 4e-10), abs=0.06), band
    assert np.isnan(found.levels["box.mic"].bands_db[800.0]) and np.isnan(found.power_db[800.0])
    weights = {100.0: -19.1, 125.0: -16.1, 250.0: -8.6, 400.0: -4.8, 500.0: -3.2}  # A, IEC 61672-1 table 3
    total = sum(10 ** ((found.levels["box.mic"].bands_db[band] + w) / 10) for band, w in weights.items())
    assert found.levels["box.mic"].l_aeq_db == pytest.approx(10 * np.log10(total), abs=0.5)  # slope of A within bands
    codes = {one.code for one in case.findings}
    assert "source-beyond-modes" in codes and codes <= set(CATALOGUE)


def test_bands_beyond_the_modes_of_a_room_are_told(tmp_path: Path) -> None:
    """A room of any shape knows its sound up to its own modes: blank bands, and what the A-weighted level is of."""
    room = ROOM.replace("losses:", "walls: {x0: {absorption: 10 %}}, modes: {up_to: 300 Hz}, losses:")
    source = "{at: feet.1.z, mobility: infinite, blocked_force: {100 Hz: 1 N, 250 Hz: 1 N, 400 Hz: 1 N, 500 Hz: 1 N}}"
    case = run(tmp_path, source, PLATE, room)
    levels = case.sources["pump"].levels["box.mic"].bands_db
    assert [band for band, level in levels.items() if np.isnan(level)] == [400.0, 500.0]
    assert not any(np.isnan(level) for level in case.sources["pump"].power_db.values())
    (told,) = [one for one in case.findings if one.code == "source-beyond-modes"]
    assert "the modes of box end at 300 Hz: there its bands from 400 Hz on are blank" in told.message
    assert told.values["needed_hz"] == pytest.approx(500 * 10**0.05, rel=3e-3)  # exact centre of 500 Hz: 501.2 Hz


def test_findings_of_measured_sources(tmp_path: Path) -> None:
    room = ROOM.replace("receivers:", "levels: [ISO 717-2], receivers:")
    source = "{at: feet.1.z, blocked_force: {100 Hz: 1 N}, mobility: {100 Hz: 1e-3 m/s/N, 125 Hz: 1e-3 m/s/N}}"
    found = {one.code: one for one in run(tmp_path, source, PLATE, room).findings}
    assert found["source-phase-unknown"].values["band_hz"] == 100.0
    assert "ISO 717-2 rate the blows of standard sources" in found["source-unrated"].message


def test_results_are_read_back_whole(tmp_path: Path) -> None:
    run(tmp_path, "{at: feet.z, blocked_force: {100 Hz: 1 N}, mass: 1 kg}", PLATE, ROOM)
    result = fs.run_study(fs.read_study(tmp_path / "a.study.yaml"))
    fs.write_results(tmp_path / "results.h5", result)
    again = fs.read_results(tmp_path / "results.h5").cases["as given"].sources["pump"]
    first = result.cases["as given"].sources["pump"]
    assert dict(again.power_db) == dict(first.power_db)
    assert again.levels["box.mic"].l_aeq_db == first.levels["box.mic"].l_aeq_db
