"""Bars to a wave: what the mesh finding asks of frames, against the errors of pinned, stretched and twisted bars."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import Section
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.frame import Frame
from femstruct.parts.wave_findings import frame_waves, mesh_findings, mesh_limit_hz

ROUNDING = 1e-13  # rounding: 6e-16 here at most

LENGTH, BARS = 1.0, 12
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
A, I_WEAK = 1e-4, 1e-9  # radius of gyration 3.2 mm
SECTION = Section("bar", A=A, Iy=2e-9, Iz=I_WEAK, J=3e-10)


def bar(element: str, section: Section = SECTION, held: tuple[str, ...] = ("x", "y", "z", "rx")) -> Structure:
    line = ((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0))
    frame = Frame("bar", STEEL, section, (line,), LENGTH / BARS, element=element)
    ends = PlaceOn("ends", "bar", line)
    return Structure("bar", (frame,), points=(ends,), supports=(Support("pins", held, at="ends"),))


def told(element: str, hz: float, section: Section = SECTION):
    return mesh_findings(mesh_structure(bar(element, section)), hz)


@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
def test_four_bars_to_a_bending_wave_are_enough_and_fewer_are_told(element: str) -> None:
    """12 bars: the sixth mode has four bars to a wave."""
    model = mesh_structure(bar(element))
    exact = (6 * np.pi / LENGTH) ** 2 * np.sqrt(STEEL.E * I_WEAK / (STEEL.rho * A)) / (2 * np.pi)
    waves = {wave.kind: wave for wave in frame_waves(model.parts["bar"])}
    assert waves["bending"].length(exact) == pytest.approx(LENGTH / 3, rel=ROUNDING)
    rigid_in_other_ways = Section("bar", A=A, Iy=2e-9, Iz=I_WEAK, J=1e-5)  # torsion far above
    assert not told(element, 0.999 * exact, rigid_in_other_ways)
    (found,) = told(element, 1.001 * exact, rigid_in_other_ways)
    assert found.code == "coarse-mesh"
    # 1.001 in frequency: 5e-4 in the wave
    assert found.values == pytest.approx({"wavelength_m": LENGTH / 3, "bar_m": LENGTH / 12}, rel=1e-3)
    assert "the bending wavelength" in found.message
    assert "4.00 bars a wavelength" in found.message
    basis = modal_basis(assemble(mesh_structure(bar(element, rigid_in_other_ways))), up_to=1.2 * exact)
    weak = np.sort(basis.frequency_hz[np.abs(basis.shapes[:, 1]).max(axis=0) > np.abs(basis.shapes[:, 2]).max(axis=0)])
    # (k h)^4 / 1440 = 0.42 %, its next term -0.03 %; shear and rotary inertia (k i = 0.06) take off up to 0.8 %
    assert weak[5] / exact == pytest.approx(1.0042, abs=0.0004 if element == "euler" else 0.009)


@pytest.mark.parametrize(("element", "needed"), [("euler", 13.0), ("timoshenko", 13.0), ("timoshenko18", 4.0)])
def test_bars_to_a_torsional_wave_err_by_a_percent_at_most(element: str, needed: float) -> None:
    """A thin open section: torsional waves of 197 m/s are the shortest."""
    section = Section("open", A=1e-3, Iy=1e-5, Iz=1e-5, J=7.5e-8)
    wave = next(
        one for one in frame_waves(mesh_structure(bar(element, section)).parts["bar"]) if one.kind == "torsional"
    )
    assert wave.length_at_1_hz == pytest.approx(np.sqrt(STEEL.G * 7.5e-8 / (STEEL.rho * 2e-5)), rel=ROUNDING)
    limit = wave.carried_hz(LENGTH / BARS)
    assert not told(element, 0.999 * limit, section)
    (found,) = told(element, 1.001 * limit, section)
    assert "torsional wave" in found.message
    assert f"needs {needed:g}" in found.message
    assert mesh_limit_hz(mesh_structure(bar(element, section))) == pytest.approx(limit, rel=ROUNDING)
    held = bar(element, section, ("x", "y", "z", "rx", "ry", "rz"))
    basis = modal_basis(assemble(mesh_structure(held)), up_to=1.2 * limit)
    turning = basis.frequency_hz[np.abs(basis.shapes[:, 3]).max(axis=0) > 0.0]
    exact = wave.length_at_1_hz / (2.0 * LENGTH) * np.arange(1, len(turning) + 1)
    below = exact <= limit
    assert below.sum() >= 1
    assert (turning[below] / exact[below] - 1.0).max() <= 0.01
    assert (turning[below] / exact[below] - 1.0).min() >= -1e-9  # rounding: conforming elements err upwards


def test_shear_waves_count_for_the_bar_of_two_nodes_alone() -> None:
    """As deep as long: where shear governs, bars of two nodes err by (k_s h)^2 / 24, which thirteen to a wave keep."""
    deep = Section("deep", A=4e-2, Iy=1e-3, Iz=1e-3, J=1e-1)
    kinds = {
        element: {wave.kind for wave in frame_waves(mesh_structure(bar(element, deep)).parts["bar"])}
        for element in ("euler", "timoshenko", "timoshenko18")
    }
    assert "shear" in kinds["timoshenko"]
    assert "shear" not in kinds["euler"] | kinds["timoshenko18"]
    speed = np.sqrt(5.0 / 6.0 * STEEL.G / STEEL.rho)
    limit = speed / (13.0 * LENGTH / BARS)
    (found,) = told("timoshenko", 1.001 * limit, deep)
    assert "the shear wavelength" in found.message
    assert found.values["wavelength_m"] == pytest.approx(speed / (1.001 * limit), rel=ROUNDING)


def test_a_frame_without_mass_has_no_waves() -> None:
    stays = Frame("stays", Material("light", 210e9, 0.3, 0.0), SECTION, (((0, 0, 0), (1.0, 0, 0)),))
    model = mesh_structure(Structure("stays", (stays,)))
    assert mesh_findings(model, 1e4) == ()
    assert mesh_limit_hz(model) == np.inf
