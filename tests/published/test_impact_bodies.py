"""Chapters 2 and 4 of the source, and stress cases, as computed by an independent event-driven engine."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes, oscillator

RECORDS = json.loads((Path(__file__).parents[1] / "data" / "bodies_impact.json").read_text())


def three_bodies(rb: float, rd: float, wb: float, wd: float, duration: float) -> Response:
    """A ball on a unit mass (unit spring) with a damper behind it, all touching, no gap."""
    basis, points = oscillator(1.0, stiffness=1.0, axis="z")
    place = points["m"].probe("z")
    scene = Scene(
        (Body("ball", rb, -1.0), Body("damper", rd)),
        (Contact("ball", "ball", place, Linear(rb * wb**2)), Contact("damper", place, "damper", Linear(rd * wd**2))),
    )
    return simulate(basis, scene, Clock(duration, 1000.0 / duration))


@pytest.mark.parametrize("record", RECORDS["three_body"], ids=lambda r: f"rd{r['rd']:g}-wb{r['wb_over_w']:g}")
def test_zero_gap_energies(record: dict[str, float]) -> None:
    """All contacts are armed together: 0.75469329 for rb 0.5, rd 1, 1000, 1; arming the damper late gives 0.88889."""
    wb = record["wb_over_w"]
    response = three_bodies(record["rb"], record["rd"], wb, wb * record["wd_over_wb"], 40.0)
    last = response.ledger.end
    # the last contact leaves the bodies free: their energies at the end are those after it
    energies = [last.bodies["damper"], last.bodies["ball"], last.structure]
    # half a unit of the eighth digit
    assert np.allclose(np.array(energies) / (0.5 * record["rb"]), record["damper,ball,structure"], rtol=0, atol=6e-9)
    assert response.ledger.residual < 1e-12  # rounding: the laws are linear


@pytest.mark.parametrize("record", RECORDS["three_body_damper"], ids=lambda r: f"{r['wb_over_w']:g}-{r['wd_over_w']:g}")
def test_three_bodies_to_ten_digits(record: dict[str, float]) -> None:
    response = three_bodies(0.5, 1.0, record["wb_over_w"], record["wd_over_w"], 40.0)
    assert response.ledger.end.bodies["damper"] / 0.25 == pytest.approx(record["damper"], abs=6e-11)  # printed digits


@pytest.mark.parametrize("record", RECORDS["graze"], ids=lambda r: f"{r['eps']:g}")
def test_grazing_contact_is_not_missed(record: dict[str, float]) -> None:
    """x = sin t just reaches a free mass at 1 - eps; a solver with loose steps never sees it."""
    basis, points = oscillator(1.0, stiffness=1.0, axis="z")
    contact = Contact("graze", "d", points["m"].probe("z"), Linear(1e6), gap=1.0 - record["eps"])
    response = simulate(basis, Scene((Body("d", 1.0),), (contact,), velocity=np.array([1.0])), Clock(20.0, 5.0))
    assert response.bodies["d"].velocity[-1] == pytest.approx(record["speed"], abs=6e-13)  # half a unit of the last
    assert response.contacts["graze"].closings == 1


@pytest.mark.parametrize(
    ("ws", "wd", "machine", "damper", "slider", "separation"),
    [
        (150.0, 25.0, 0.4914, 0.0648, 0.4438, 1.6753e-3),
        (150.0, 150.0, 0.1239, 0.3584, 0.5178, 0.6380e-3),
        (150.0, 220.0, 0.1495, 0.2810, 0.5695, 0.5186e-3),
    ],
)
def test_press_at_first_separation(
    ws: float, wd: float, machine: float, damper: float, slider: float, separation: float
) -> None:
    """Forging press with two modes: energies at the first instant with both bed contacts open, points P, Q, R.

    Frequencies are in units of the lower mode's 40 rad/s; damper energy is kinetic and that of its spring.
    """
    basis, points = given_modes(
        [40 / (2 * np.pi), 1777 / (2 * np.pi)], [0.0, 0.0], {"O_b": [0.14, 0.392], "O_f": [0.14, -0.07]}
    )
    bed, base = points["O_b"].probe("z"), points["O_f"].probe("z")
    # z down in the source: the slider comes from above, the damper hangs below the bed on the base
    m_s, m_d, unit = 1.2, 3.5, 40.0
    scene = Scene(
        (Body("slider", m_s, -1.2), Body("damper", m_d)),
        (
            Contact("slider", "slider", bed, Linear(m_s * (ws * unit) ** 2)),
            Contact("damper", bed, "damper", Linear(m_d * (wd * unit) ** 2)),
        ),
        (Link("mount", "damper", base, stiffness=1.8e3, opening=7e2),),
    )
    response = simulate(basis, scene, Clock(5e-3, 200e3))
    stock = response.ledger.at_separation
    assert stock is not None
    assert stock.t == pytest.approx(separation, abs=6e-8)  # half a unit of the fourth digit
    start = response.ledger.start.total
    assert stock.structure / start == pytest.approx(machine, abs=6e-5)  # half a unit of the fourth digit
    # half a unit of the fourth digit
    assert (stock.bodies["damper"] + stock.links["mount"]) / start == pytest.approx(damper, abs=6e-5)
    assert stock.bodies["slider"] / start == pytest.approx(slider, abs=6e-5)  # half a unit of the fourth digit
