"""Standard sources against the tables of the standards: what they do on a rigid floor."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from acoustics.levels.sound_levels import force_exposure_levels
from femstruct.impact.scene import (
    BANG_MACHINE,
    CONTACT_S,
    DROPPED,
    EXPOSURE_ALLOWED_DB,
    GROUND,
    RESTITUTION,
    RUBBER_BALL,
    Body,
    Clock,
    Contact,
    Scene,
    StandardSource,
)
from femstruct.impact.simulate import simulate
from femstruct.language.cases import read_study
from femstruct.modal.closed_form import given_modes

NOTHING = given_modes([], [], {})[0]
SAMPLING = 48e3


def dropped(source: StandardSource, tolerance: float = 1e-8):
    scene = Scene(
        bodies=(Body("source", source.mass, -source.speed),),
        contacts=(Contact("floor", "source", GROUND, source.law),),
    )
    return simulate(NOTHING, scene, Clock(50e-3, SAMPLING, tolerance=tolerance))


@pytest.mark.parametrize("source", [RUBBER_BALL, BANG_MACHINE], ids=["rubber ball", "bang machine"])
def test_force_restitution_and_contact_time_are_those_of_the_tables(source):
    response = dropped(source)
    contact, body = response.contacts["floor"], response.bodies["source"]
    levels = force_exposure_levels(contact.force, 1 / SAMPLING)
    for band, level in source.exposure_db.items():
        assert levels[band] == pytest.approx(level, abs=EXPOSURE_ALLOWED_DB[band])
    assert body.velocity[-1] / source.speed == pytest.approx(RESTITUTION[0], abs=RESTITUTION[1])
    assert contact.first_open == pytest.approx(CONTACT_S[0], abs=CONTACT_S[1])
    assert contact.closings == 1
    assert response.ledger.residual < 1e-8  # what the steps leave open
    assert response.findings == ()


def test_the_ball_does_not_depend_on_the_engines_tolerance():
    coarse, fine = (dropped(RUBBER_BALL, tolerance) for tolerance in (1e-6, 1e-10))
    # forces agree to what the coarser run may miss, some steps of 1e-6 of the largest
    assert coarse.contacts["floor"].force == pytest.approx(fine.contacts["floor"].force, abs=1e-4 * 1600)
    # the coarser run's tolerance
    assert coarse.bodies["source"].velocity[-1] == pytest.approx(fine.bodies["source"].velocity[-1], rel=1e-6)


def test_exposure_levels_of_a_burst_add_to_its_energy():
    # a burst of 100 N amplitude at an octave's centre: in that octave all of its energy, 100^2 / 2 times 1 s
    t = np.arange(48000) / SAMPLING
    levels = force_exposure_levels(100.0 * np.sin(2 * np.pi * 1000 * 10**-0.9 * t), 1 / SAMPLING)
    # the burst's ends spread 1 % of it into the other octaves
    assert levels[125.0] == pytest.approx(10 * np.log10(100.0**2 / 2), abs=0.05)
    assert max(level for band, level in levels.items() if band != 125.0) < levels[125.0] - 15.0


def test_exposure_levels_of_a_blow_are_its_spectrum_in_the_octave():
    # an independent way: the line spectrum of a half-sine blow of 20 ms by its closed form, weighted by the filter's
    # magnitude |H|^2 = 1 / (1 + ((f/fm - fm/f) / B)^8) of an analogue order-4 Butterworth band pass
    duration, centre = 20e-3, 1000 * 10**-1.2
    t = np.arange(round(0.1 * SAMPLING)) / SAMPLING
    force = np.where(t < duration, 1000 * np.sin(np.pi * t / duration), 0.0)
    f = np.arange(1.1, 2000.0, 0.5)  # not at 25 Hz, where the formula is 0 / 0
    spectrum = 1000 * 2 * duration / np.pi * np.cos(np.pi * f * duration) / (1 - (2 * f * duration) ** 2)
    width = 10**0.15 - 10**-0.15
    gain = 1 / (1 + ((f / centre - centre / f) / width) ** 8)
    whole = 10 * np.log10(2 * 0.5 * np.sum(spectrum**2 * gain))
    assert force_exposure_levels(force, 1 / SAMPLING)[63.0] == pytest.approx(whole, abs=0.02)  # the line spacing


@pytest.mark.parametrize(("name", "source"), DROPPED.items(), ids=DROPPED)
def test_a_study_drops_the_source_as_it_is(name, source, tmp_path):
    """Every field of its law, how points are joined too: a ball that was joined by straight lines was another one."""
    (tmp_path / "floor.yaml").write_text(
        "parts: {floor: {type: block, mass: 100 kg, origin: [0, 0, 0], size: [1, 1, 0.04]}}\n"
        "supports: {pit: {on: floor, fix: [x, y]}}\n"
        "points: {top: {on: floor, at: [0.5, 0.5, 0.04]}}\n"
    )
    path = tmp_path / "drop.study.yaml"
    path.write_text(
        f"model: floor.yaml\nmodes: {{count: 1}}\nbodies: {{it: {{source: {name}, above: top}}}}\n"
        "time: {duration: 50 ms, sampling: 2 kHz, gravity: true}\n"
    )
    law = read_study(path).cases[0].study.bodies[0].law
    for field in fields(source.law):
        assert np.array_equal(getattr(law, field.name), getattr(source.law, field.name)), field.name
