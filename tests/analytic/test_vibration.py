"""Harmonic and random excitations and bases that move, against closed forms and direct solutions."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_continuous_lyapunov

import femstruct as fs
from femstruct.conventions import GRAVITY
from femstruct.elements.stresses import von_mises, von_mises_in_a_cycle
from femstruct.errors import InputError, InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.files.sheets import sheets
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.modal.closed_form import given_modes
from femstruct.modal.damping import Damping, LossFactor, Ratio
from femstruct.modal.steady import random_answer
from femstruct.model.sections import rectangle
from femstruct.view import answer_tables
from femstruct.view.plots import figures
from femstruct.workflow.check import inspect_file
from femstruct.workflow.responses import refuse_undamped
from femstruct.workflow.run import run_study

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
OSCILLATOR = "structure: {type: oscillator, mass: 2 kg, frequency: 40 Hz}\npoints: {m: {}}\ndamping: {ratio: 2 %}\n"
SHAKER = """
model: model.yaml
record: {m.z: [acceleration, displacement], ground: force}
vibration:
  shaker: {base: z, psd: 0.01 g^2/Hz, band: [0.04 Hz, 40 kHz], duration: 60 s}
"""


def written(folder: Path, study: str = SHAKER, model: str = OSCILLATOR) -> Path:
    (folder / "model.yaml").write_text(model, encoding="utf-8")
    path = folder / "shaken.study.yaml"
    path.write_text(study, encoding="utf-8")
    return path


def run(structure: fs.Structure, damping: Damping, extent: fs.Extent, records, *excited) -> dict:
    study = fs.Study("shaken", structure, damping, extent, records=records, vibration=excited)
    case = run_study(fs.Plan("shaken", (fs.Case("as given", study),), baseline="as given")).cases["as given"]
    return case.vibration


def test_an_oscillator_on_white_noise(tmp_path: Path) -> None:
    """J. W. Miles, Journal of the Aeronautical Sciences 21 (1954) 753-762, with the term of the dashpot: mean squares
    of the absolute acceleration pi f G (1 + 4 zeta^2) / 4 zeta, of the relative displacement pi f G / 4 zeta / w^4."""
    G, f, zeta, w = 0.01 * GRAVITY**2, 40.0, 0.02, 2 * np.pi * 40.0
    answers = run_study(read_study(written(tmp_path))).cases["as given"].vibration["shaker"].answers
    miles = np.pi * f * G / (4 * zeta)
    felt, away = answers["m.z acceleration"], answers["m.z displacement relative to the base"]
    within = 2e-4  # of lines 1/24 of half a bandwidth apart, and of 0.04 Hz that the band leaves out
    assert felt.rms == pytest.approx(np.sqrt(miles * (1 + 4 * zeta**2)), rel=within)
    assert away.rms == pytest.approx(np.sqrt(miles) / w**2, rel=within)
    assert away.crossings == pytest.approx(f, rel=within)  # of white noise exactly
    mass = 2.0
    assert answers["ground force"].rms == pytest.approx(mass * felt.rms, rel=1e-12)  # rounding
    assert felt.psd[0] == pytest.approx(G, rel=1e-5)  # far below the resonance it goes along


def test_the_expected_largest_is_that_of_upcrossings() -> None:
    """Independent crossings of a level a, exp(-a^2 / 2) of those of zero: the mean of the largest is the integral of
    1 - exp(-n exp(-a^2 / 2)); Davenport's two terms of its series are within 1 % from a hundred crossings on."""
    lines = np.linspace(90.0, 110.0, 401)
    found = random_answer("m", np.ones(401, complex), np.full(401, 0.2), lines, duration=20.0)
    count = found.crossings * 20.0
    mean, _ = quad(lambda a: 1.0 - np.exp(-count * np.exp(-(a**2) / 2.0)), 0.0, 12.0)
    assert found.rms == pytest.approx(2.0, rel=1e-12)  # rounding
    assert found.peak == pytest.approx(2.0 * mean, rel=1e-2)  # of the series
    assert random_answer("m", np.ones(401, complex), np.full(401, 0.2), lines, duration=0.09).peak is None


def test_a_harmonic_base_under_an_oscillator(tmp_path: Path) -> None:
    """T = (1 + 2 j zeta r) / (1 - r^2 + 2 j zeta r) of the absolute, r^2 / (..) of the relative motion; 1 / 2 zeta."""
    study = SHAKER.replace(
        "psd: 0.01 g^2/Hz, band: [0.04 Hz, 40 kHz], duration: 60 s", "harmonic: [[5 Hz, 1 g], [80 Hz, 1 g]]"
    )
    one = run_study(read_study(written(tmp_path, study))).cases["as given"].vibration["shaker"]
    r, zeta = one.frequency_hz / 40.0, 0.02
    below = 1 - r**2 + 2j * zeta * r
    within = 1e-9  # rounding of differences near the static end
    np.testing.assert_allclose(
        one.answers["m.z acceleration"].values, GRAVITY * (1 + 2j * zeta * r) / below, rtol=within
    )
    moved = -GRAVITY / (2 * np.pi * one.frequency_hz) ** 2
    away = one.answers["m.z displacement relative to the base"].values
    np.testing.assert_allclose(away, moved * r**2 / below, rtol=within)
    np.testing.assert_allclose(one.answers["m.z displacement"].values, away + moved, rtol=within)
    assert 40.0 in one.frequency_hz
    at = np.flatnonzero(one.frequency_hz == 40.0)[0]
    assert abs(away[at]) == pytest.approx(abs(moved[at]) / (2 * zeta), rel=within)


def test_two_masses_on_a_base() -> None:
    """Two blocks in a row on springs with dashpots: (K + j w C - w^2 M) u = -M r a by hand; the effective masses of
    both modes are all that moves."""
    m, k, c = (3.0, 1.0), (40e3, 15e3), (30.0, 8.0)
    blocks = [
        fs.Block(name, m[i], (0.0, 0.0, z), (0.1, 0.1, 0.1))
        for i, (name, z) in enumerate((("low", 0.5), ("high", 1.0)))
    ]
    at = [fs.PlaceOn(f"of {name}", name, at=((0.05, 0.05, 0.05),)) for name in ("low", "high")]
    springs = [
        fs.Spring(
            "foot", "of low", None, stiffness=(0.0, 0.0, k[0], 0.0, 0.0, 0.0), damping=(0.0, 0.0, c[0], 0.0, 0.0, 0.0)
        ),
        fs.Spring(
            "neck",
            "of high",
            "of low",
            stiffness=(0.0, 0.0, k[1], 0.0, 0.0, 0.0),
            damping=(0.0, 0.0, c[1], 0.0, 0.0, 0.0),
        ),
    ]
    structure = fs.Structure("two masses", (*blocks, *springs), points=tuple(at))
    records = (fs.Record("of high.z", "acceleration"), fs.Record("neck", "force"), fs.Record("ground", "force"))
    sweep = fs.Vibration("sweep", "z", "base", "harmonic", fs.Spectrum(((2.0, 5.0), (60.0, 5.0))))
    one = run(structure, Damping(Ratio(0.0)), fs.Extent(count=12), records, sweep)["sweep"]
    M = np.diag(m)
    K = np.array([[k[0] + k[1], -k[1]], [-k[1], k[1]]])
    C = np.array([[c[0] + c[1], -c[1]], [-c[1], c[1]]])
    w = 2 * np.pi * one.frequency_hz
    u = np.array([np.linalg.solve(K + 1j * x * C - x**2 * M, -M @ np.full(2, 5.0)) for x in w]).T
    within = 1e-8  # rounding of the modes
    np.testing.assert_allclose(one.answers["of high.z acceleration"].values, 5.0 - w**2 * u[1], rtol=within)
    ground = (k[0] + 1j * w * c[0]) * u[0]
    np.testing.assert_allclose(one.answers["ground force"].values, ground, rtol=within)
    np.testing.assert_allclose(
        np.abs(one.answers["neck force"].values), np.abs((k[1] + 1j * w * c[1]) * (u[1] - u[0])), rtol=within
    )
    assert one.base.moved == pytest.approx(4.0, rel=within)


@pytest.mark.parametrize("oil", [30.0, 3e3, 30e3])
def test_a_dashpot_that_holds_what_it_acts_on(oil: float) -> None:
    """White noise under two masses of which oil holds the lower: relative mean squares are those of A P + P A' + B B' S
    / 2 = 0 of the four states. With much oil the upper mass resonates alone, where neither mode does."""
    m, k, light, level = (3.0, 1.0), (40e3, 15e3), 0.2, 2.0
    up = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    stiffness, damping = ([tuple(value * one for one in up) for value in values] for values in (k, (oil, light)))
    blocks = [fs.Block(name, m[i], (0.0, 0.0, 0.5 * i), (0.1, 0.1, 0.1)) for i, name in enumerate(("low", "high"))]
    at = tuple(fs.PlaceOn(f"of {name}", name, at=((0.05, 0.05, 0.05),)) for name in ("low", "high"))
    springs = (
        fs.Spring("foot", "of low", None, stiffness=stiffness[0], damping=damping[0]),
        fs.Spring("neck", "of high", "of low", stiffness=stiffness[1], damping=damping[1]),
    )
    structure = fs.Structure("two masses", (*blocks, *springs), points=at)
    noise = fs.Vibration("noise", "z", "base", "psd", fs.Spectrum(((0.02, level), (2e3, level))))
    records = (fs.Record("of high.z", "displacement"),)
    found = run(structure, Damping(Ratio(0.0)), fs.Extent(count=12), records, noise)["noise"]
    K = np.array([[k[0] + k[1], -k[1]], [-k[1], k[1]]])
    C = np.array([[oil + light, -light], [-light, light]])
    M = np.diag(m)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    B = np.array([0.0, 0.0, -1.0, -1.0])
    square = solve_continuous_lyapunov(A, -0.5 * level * np.outer(B, B))[1, 1]
    rms = found.answers["of high.z displacement relative to the base"].rms
    assert rms == pytest.approx(np.sqrt(square), rel=3e-4)  # lines 1/24 of half a bandwidth apart, and the band's ends


def test_two_modes_of_one_frequency_that_a_dashpot_leaves_undamped() -> None:
    """A dashpot between two alike oscillators takes nothing from the motion in step, though each has damping."""
    alike, _ = given_modes([20.0, 20.0], [0.0, 0.0], {"P": [1.0, 0.0], "Q": [0.0, 1.0]})
    basis = replace(alike, viscous=3.0 * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    with pytest.raises(InputError, match="1 of the modes from 5 to 50 Hz without damping, the first at 20 Hz"):
        refuse_undamped("vibration.noise", (5.0, 50.0), basis)


def bar(mesh: float = 0.05) -> fs.Structure:
    frame = fs.Frame(
        "bar", STEEL, rectangle("s", 0.01, 0.02), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), mesh=mesh, element="euler"
    )
    points = tuple(fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("foot", 0.0), ("tip", 1.0)))
    return fs.Structure("a cantilever", (frame,), points=points, supports=(fs.Support("wall", "clamped", at="foot"),))


def test_effective_masses_of_a_cantilever() -> None:
    """The first four of a uniform cantilever are 0.6131, 0.1883, 0.0647 and 0.0331 of its mass: from
    (2 sigma_r / beta_r L)^2 with cos cosh = -1."""
    roots = np.array([1.875104069, 4.694091133, 7.854757438, 10.99554073])
    sigma = (np.sinh(roots) - np.sin(roots)) / (np.cosh(roots) + np.cos(roots))
    exact = (2 * sigma / roots) ** 2
    np.testing.assert_allclose(exact, [0.6131, 0.1883, 0.0647, 0.0331], atol=6e-5)  # four digits
    shaker = fs.Vibration("shaker", "z", "base", "psd", fs.Spectrum(((1.0, 1.0), (400.0, 1.0))))
    one = run(bar(), Damping(Ratio(0.01)), fs.Extent(up_to_hz=2000.0), (fs.Record("tip.z", "acceleration"),), shaker)
    masses = np.sort(one["shaker"].base.mass)[::-1][:4] / one["shaker"].base.total
    np.testing.assert_allclose(masses, exact, rtol=2e-3)  # 20 bars; rotary inertia


def direct(structure: fs.Structure, eta: float, axis: int, lines: np.ndarray):
    """Motion on a base of unit acceleration by dense solutions: nodal components [node, 7, line], and the assembly."""
    assembly = fs.assemble(fs.mesh_structure(structure))
    K, M = assembly.K.toarray(), assembly.M.toarray()
    u = [np.linalg.solve(K * (1 + 1j * eta) - (2 * np.pi * f) ** 2 * M, -assembly.momentum[axis]) for f in lines]
    return assembly, np.array(u).T


def test_a_cantilever_on_a_base_as_the_full_matrices_have_it() -> None:
    """Tip, force on the ground (by the balance of momentum, which knows no support) and stress at all lines."""
    structure, eta = bar(0.1), 0.03
    records = (fs.Record("tip.z", "acceleration"), fs.Record("ground", "force"), fs.Record("bar", "stress"))
    points = ((5.0, 2.0), (120.0, 4.0))
    sweep = fs.Vibration("sweep", "z", "base", "harmonic", fs.Spectrum(points))
    noise = fs.Vibration("noise", "z", "base", "psd", fs.Spectrum(points))
    found = run(structure, Damping(LossFactor(eta)), fs.Extent(up_to_hz=350.0), records, sweep, noise)
    lines = found["sweep"].frequency_hz
    a = np.exp(np.interp(np.log(lines), np.log([5.0, 120.0]), np.log([2.0, 4.0])))
    assembly, u = direct(structure, eta, 2, lines)
    model = fs.mesh_structure(structure)
    row = (model.points["tip"].probe("z").row(model.mesh.n_nodes) @ assembly.dofs.T).toarray()[0]
    w2 = (2 * np.pi * lines) ** 2
    tip = a * (1.0 - w2 * (row @ u))
    ground = -a * (assembly.total_mass - w2 * (assembly.momentum[2] @ u))
    within = 1e-4  # modes up to 2.9 times the band and residual vectors of the base
    np.testing.assert_allclose(found["sweep"].answers["tip.z acceleration"].values, tip, atol=within * abs(tip).max())
    np.testing.assert_allclose(found["sweep"].answers["ground force"].values, ground, atol=within * abs(ground).max())
    nodal = np.asarray(assembly.dofs.T @ u).reshape(model.mesh.n_nodes, 7, -1)
    places = model.parts["bar"].stresses(model.mesh.n_nodes)
    stress = places.of(nodal.real) + 1j * places.of(nodal.imag) + places.carried[:, :, 2, None]
    turns = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 721))
    cycle = np.max([von_mises((stress * a * turn).real, places.components).max(axis=0) for turn in turns], axis=0)
    largest = found["sweep"].answers["bar stress"]
    np.testing.assert_allclose(largest.values.real, cycle, atol=1e-3 * cycle.max())  # 5000 samples
    assert largest.where.startswith("(0, ")
    square = von_mises(stress.real, places.components) ** 2 + von_mises(stress.imag, places.components) ** 2
    rms = np.sqrt(np.trapezoid(square * a, lines, axis=-1))
    assert found["noise"].answers["bar stress"].rms == pytest.approx(rms.max(), rel=1e-3)  # stress of the modes
    psd = (square * a)[rms.argmax()]
    np.testing.assert_allclose(found["noise"].answers["bar stress"].psd, psd, atol=1e-3 * psd.max())


@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
def test_a_beam_of_one_bar_on_a_base_is_stressed_as_by_its_weight(element: str) -> None:
    """Far below its first mode, at 91 Hz, w L^2 / 8 in the middle of a beam on hinges, w = rho A a."""
    line = (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),)
    frame = fs.Frame("bar", STEEL, rectangle("s", 0.02, 0.04), line, element=element)
    points = tuple(fs.PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("left", 0.0), ("right", 1.0)))
    held = {"left": ("x", "y", "z", "rx"), "right": ("x", "y", "z")}
    supports = tuple(fs.Support(f"at {at}", fix, at=at) for at, fix in held.items())
    structure = fs.Structure("a beam", (frame,), points=points, supports=supports)
    level = fs.Spectrum(((1.0, 2.0), (2.0, 2.0)))
    shaken = (fs.Vibration("sweep", "z", "base", "harmonic", level), fs.Vibration("noise", "z", "base", "psd", level))
    found = run(structure, Damping(LossFactor(0.0)), fs.Extent(count=2), (fs.Record("bar", "stress"),), *shaken)
    per_acceleration = 7850.0 * 8e-4 / 8 / (0.02 * 0.04**2 / 6)
    within = 1e-3  # (2 Hz / 91 Hz)^2: what the beam moves on its base
    harmonic, noise = (found[name].answers["bar stress"] for name in ("sweep", "noise"))
    assert abs(harmonic.values).max() == pytest.approx(2.0 * per_acceleration, rel=within)
    assert noise.rms == pytest.approx(2.0**0.5 * per_acceleration, rel=within)  # 2 (m/s^2)^2/Hz over 1 Hz
    assert harmonic.where.startswith("(0.5, ") and noise.where.startswith("(0.5, ")


def test_the_largest_of_a_cycle_is_that_of_many_instants() -> None:
    rng = np.random.default_rng(4)
    names = ("xx", "yy", "zz", "xy", "yz", "zx")
    stress = rng.normal(size=(50, 6)) + 1j * rng.normal(size=(50, 6))
    turns = np.exp(1j * np.linspace(0.0, np.pi, 20001))
    sampled = np.max([von_mises((stress * turn).real, names) for turn in turns[::20]], axis=0)
    exact = von_mises_in_a_cycle(stress, names)
    assert (exact >= sampled * (1 - 1e-12)).all()
    np.testing.assert_allclose(exact, sampled, rtol=1e-5)  # (pi / 1000)^2 / 2 apart at most


def test_noise_in_time_has_the_same_mean_square(tmp_path: Path) -> None:
    """A force of 240 sines of random phase with the given density, marched through: once the start has died away, its
    mean square over a period is that of the sum over its lines."""
    rate, period, step = 4000.0, 10.0, 0.1
    lines = 10.0 + step * np.arange(1, 700)
    S = 3.0
    rng = np.random.default_rng(1)
    t = np.arange(round(2 * period * rate) + 1) / rate
    force = sum(np.sqrt(2 * S * step) * np.cos(2 * np.pi * f * t + rng.uniform(0, 2 * np.pi)) for f in lines)
    (tmp_path / "noise.csv").write_text(
        "t,F\n" + "\n".join(f"{a:.9g},{b:.9g}" for a, b in zip(t, force, strict=True)), encoding="utf-8"
    )
    study = f"""
model: model.yaml
record: {{m.z: [displacement, velocity]}}
loads: {{noise: {{at: m.z, file: noise.csv}}}}
vibration: {{noise: {{at: m.z, psd: {S} N^2/Hz, band: [10.05 Hz, 79.95 Hz]}}}}
time: {{duration: 20 s, sampling: {rate:g} Hz}}
"""
    case = run_study(read_study(written(tmp_path, study))).cases["as given"]
    for what in ("displacement", "velocity"):
        history = case.channels[f"m.z {what}"].values[-round(period * rate) :]
        found = case.vibration["noise"].answers[f"m.z {what}"]
        within = 2e-3  # a force that is straight between 4000 samples a second: (pi f / rate)^2 / 3 at 80 Hz
        assert found.rms == pytest.approx(np.sqrt((history**2).mean()), rel=within)


def plate_13() -> fs.Structure:
    steel = fs.Material("steel", E=200e9, nu=0.3, rho=8000.0)
    plate = fs.Plate("p", steel, 0.05, origin=(0.0, 0.0, 0.0), size=(10.0, 10.0), mesh=(16, 16))
    return fs.Structure(
        "NAFEMS 13",
        (plate,),
        points=(fs.PlaceOn("middle", "p", at=((5.0, 5.0),)),),
        supports=(fs.Support("rim", "simple", on="p", edge="all"),),
        surfaces=(fs.SurfaceOn("top", "p"),),
    )


def test_nafems_13h_and_13r() -> None:
    """NAFEMS, Selected Benchmarks for Forced Vibration (1989), tests 13H and 13R: a simply supported square plate under
    a uniform pressure of 100 Pa, or 1e4 Pa^2/Hz, 2 % of damping. In the middle 45.42 mm; 2063.20 mm^2/Hz and
    1025.44 (N/mm^2)^2/Hz at 2.377 Hz."""
    records = (fs.Record("middle.z", "displacement"), fs.Record("p", "stress"))
    harmonic = fs.Vibration("H", "top", "surface", "harmonic", fs.Spectrum(((0.1, 100.0), (4.16, 100.0))))
    random = fs.Vibration("R", "top", "surface", "psd", fs.Spectrum(((0.1, 1e4), (4.16, 1e4))))
    found = run(plate_13(), Damping(Ratio(0.02)), fs.Extent(count=16), records, harmonic, random)
    amplitude = found["H"].answers["middle.z displacement"]
    assert amplitude.largest == pytest.approx(45.42e-3, rel=2e-3)  # the target has the first mode alone
    assert amplitude.largest_at_hz == pytest.approx(2.377, rel=1e-3)  # its digits
    assert found["R"].answers["middle.z displacement"].psd.max() == pytest.approx(2063.20e-6, rel=4e-3)  # its square
    stress = found["R"].answers["p stress"]
    assert stress.psd.max() == pytest.approx(1025.44e12, rel=1e-2)  # the same, and curvature of 16 cells
    assert stress.where.startswith("(5, 5, ")


def test_what_a_study_reports_is_stored(tmp_path: Path) -> None:
    study = SHAKER + "  push: {at: m.z, harmonic: 10 N, band: [5 Hz, 100 Hz]}\n"
    result = run_study(read_study(written(tmp_path, study)))
    table = json.loads(json.dumps(summary(result)))["cases"]["as given"]["vibration"]
    one = result.cases["as given"].vibration["shaker"]
    felt = table["shaker"]["answers"]["m.z acceleration"]
    assert felt["rms"] == pytest.approx(one.answers["m.z acceleration"].rms, rel=1e-12)  # the digits of JSON
    assert felt["unit"] == "m/s^2" and table["shaker"]["base"]["share"] == pytest.approx(1.0, rel=1e-12)  # rounding
    assert table["push"]["answers"]["ground force"]["largest"] == pytest.approx(10.0 / 0.04, rel=2e-3)  # 1 / 2 zeta
    write_results(tmp_path / "results.h5", result)
    kept = read_results(tmp_path / "results.h5").cases["as given"].vibration["shaker"]
    np.testing.assert_array_equal(kept.answers["m.z acceleration"].psd, one.answers["m.z acceleration"].psd)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("base: z", "base: w", "base"),
        ("base: z", "base: z, at: m.z", "both"),
        ("base: z", "at: q.z", "a direction of a point"),
        ("0.01 g^2/Hz", "0.01 N^2/Hz", "a spectral density of an acceleration"),
        ("0.01 g^2/Hz", "0.01 g", "a mass"),
        ("0.01 g^2/Hz", "0.01 m/s", "write it like 0.01 g^2/Hz of a base, 2 N^2/Hz of a force"),
        ("0.01 g^2/Hz", "-0.001 g^2/Hz", "got '-0.001 g^2/Hz', expected a value above 0; remove the sign"),
        ("0.01 g^2/Hz", "[[20 Hz, 1], [10 Hz, 1]]", "band beside pairs"),
        (", band: [0.04 Hz, 40 kHz]", "", "no band"),
        ("[0.04 Hz, 40 kHz]", "[40 kHz, 0.04 Hz]", "a rising band"),
        ("psd: 0.01 g^2/Hz", "harmonic: 1 g", "duration without psd"),
        ("psd: 0.01 g^2/Hz, band: [0.04 Hz, 40 kHz]", "psd: [[20 Hz, 1], [10 Hz, 1]]", "frequencies that rise"),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputErrors) as refused:
        read_study(written(tmp_path, SHAKER.replace(old, new)))
    assert told in str(refused.value)
    assert "shaken.study.yaml:5:" in str(refused.value)


def test_nothing_recorded_and_no_damping_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputErrors, match="nothing that is recorded"):
        read_study(written(tmp_path, SHAKER.replace("record: {m.z: [acceleration, displacement], ground: force}", "")))
    undamped = written(tmp_path, model=OSCILLATOR.replace("damping: {ratio: 2 %}\n", ""))
    with pytest.raises(InputError, match="without damping, the first at 40 Hz"):
        inspect_file(undamped)
    with pytest.raises(InputError, match="without damping, the first at 40 Hz"):
        run_study(read_study(undamped))


def test_a_structure_that_is_free_to_stay_behind_is_refused() -> None:
    plate = fs.Plate("p", STEEL, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(4, 4))
    free = fs.Structure("free", (plate,), points=(fs.PlaceOn("off", "p", at=((0.1, 0.1),)),))
    shaker = fs.Vibration("shaker", "z", "base", "psd", fs.Spectrum(((20.0, 1.0), (90.0, 1.0))))
    with pytest.raises(InputError, match="free to stay behind along z"):
        run(free, Damping(Ratio(0.01)), fs.Extent(count=12), (fs.Record("off.z", "acceleration"),), shaker)


def test_what_is_held_is_not_pushed_and_has_no_motion_of_its_own() -> None:
    records = (fs.Record("foot.z", "acceleration"), fs.Record("tip.z", "acceleration"))
    white = fs.Spectrum(((1.0, 1.0), (40.0, 1.0)))
    base, push = (
        fs.Vibration("a", "z", "base", "psd", white),
        fs.Vibration("a", fs.Spot("tip", "z"), "point", "psd", white),
    )
    along = run(bar(), Damping(Ratio(0.01)), fs.Extent(count=3), records, base)["a"].answers
    assert along["foot.z acceleration"].rms == pytest.approx(np.sqrt(39.0), rel=1e-9)  # it is the base; rounding
    assert "foot.z acceleration relative to the base" not in along
    study = fs.Study(
        "bar", bar(), Damping(Ratio(0.01)), fs.Extent(count=3), records=records, vibration=(push,)
    )  # fmt: skip
    result = run_study(fs.Plan("bar", (fs.Case("as given", study),), baseline="as given"))
    assert result.cases["as given"].vibration["a"].answers["foot.z acceleration"].rms == 0.0
    drawn = figures(result)
    assert [name for name in drawn if "foot" in name] == ["vibration_a_foot.z_acceleration.png"]
    (table,) = (sheet for sheet in sheets(result) if sheet.name == "vibration answers")
    assert [row[2] for row in table.rows] == ["foot.z acceleration", "tip.z acceleration"]
    held = fs.Vibration("a", fs.Spot("foot", "z"), "point", "psd", white)
    with pytest.raises(InputError, match=r"'foot.z', which no mode moves"):
        run(bar(), Damping(Ratio(0.01)), fs.Extent(count=3), records, held)


def test_a_band_beyond_the_modes_is_a_finding() -> None:
    shaker = fs.Vibration("shaker", "z", "base", "psd", fs.Spectrum(((1.0, 1.0), (400.0, 1.0))))
    study = fs.Study(
        "bar", bar(), Damping(Ratio(0.01)), fs.Extent(up_to_hz=100.0),
        records=(fs.Record("tip.z", "acceleration"),), vibration=(shaker,),
    )  # fmt: skip
    case = run_study(fs.Plan("bar", (fs.Case("as given", study),), baseline="as given")).cases["as given"]
    (told,) = (finding for finding in case.findings if finding.code == "vibration-beyond-modes")
    assert told.values["band_hz"] == 400.0


def test_rounding_of_the_largest_is_shown_as_0(tmp_path: Path) -> None:
    """A channel with 1e-12 of another's answer in the same unit, and modes that carry 1e-20 of the mass."""
    study = SHAKER + "  push: {at: m.z, harmonic: 10 N, band: [5 Hz, 100 Hz]}\n"
    result = run_study(read_study(written(tmp_path, study)))
    case = result.cases["as given"]
    pushed, shaken = case.vibration["push"], case.vibration["shaker"]
    moved, force = pushed.answers["m.z displacement"], shaken.answers["ground force"]
    few = replace(moved, values=1e-12 * moved.values)
    quiet = replace(force, rms=1e-12 * force.rms, psd=1e-24 * force.psd, peak=force.peak and 1e-12 * force.peak)
    assert shaken.base is not None
    base = replace(shaken.base, mass=1e-20 * shaken.base.mass)
    vibration = {
        "push": replace(pushed, answers={**pushed.answers, "few": few}),
        "shaker": replace(shaken, base=base, answers={**shaken.answers, "quiet": quiet}),
    }
    shown = replace(result, cases={"as given": replace(case, vibration=vibration)})
    rows = {row[1]: row for row in answer_tables.harmonic(shown).rows}
    assert (rows["few"][3].split()[0], rows["few"][4]) == ("0", "-") and rows["m.z displacement"][3].endswith("mm")
    assert answer_tables.harmonic(shown).title.endswith("; 0: below 1e-09 of the largest in its unit")
    assert answer_tables.harmonic(result).title == "harmonic vibration: largest amplitudes"
    rows = {row[1]: row for row in answer_tables.random(shown).rows}
    assert [cell.split()[0] for cell in rows["quiet"][3:6]] == ["0", "-", "-"]
    assert "; 0: below 1e-09 of the largest in its unit" in answer_tables.random(shown).title
    assert answer_tables.moved_masses(shown).rows[0][4] == "0 of 2 kg"
