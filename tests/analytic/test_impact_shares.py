"""The structure's energy by modes: sums against the ledger, free modes in closed form, names of groups."""

from __future__ import annotations

import numpy as np
import pytest

from femstruct.impact.scene import GROUND, Body, Clock, Contact, HalfSine, Link, Load, Scene
from femstruct.impact.shares import energy_shares, grouped, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.laws.law import Law
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes


@pytest.mark.parametrize("law", [Linear(1e6, 50.0), Hertz(1e9, 20.0)], ids=["exact march", "collocation"])
def test_the_groups_add_up_to_the_ledger(law: Law) -> None:
    """With a load, a dashpot, a one-way link released in the window, and gravity, between samples."""
    frequencies = [0.0, *np.geomspace(20.0, 900.0, 14)]
    rng = np.random.default_rng(1)
    basis, points = given_modes(
        frequencies, [0.0, *[0.03] * 14], {"p": list(rng.uniform(-1, 1, 15)), "r": list(rng.uniform(-1, 1, 15))}
    )
    p, r = points["p"].probe("z"), points["r"].probe("z")
    scene = Scene(
        (Body("ball", 0.5, -1.0, falls=True),),
        (Contact("hit", "ball", p, law),),
        (Link("catch", r, GROUND, 3e3, 0.0, 20.0, 0.6e-3, preload=2.0),),
        (Load("push", r, HalfSine(30.0, 40.0)),),
        gravity=9.81,
    )
    response = simulate(basis, scene, Clock(20e-3, 3e3))
    ledger, shares = response.ledger, mode_energies(response)
    assert ledger.at_separation is not None
    assert shares.at_separation is not None
    assert [part.name for part in shares.end[:2]] == ["rigid", "mode 2"]
    assert [part.name for part in shares.end[-2:]] == ["modes 12 to 14", "mode 15"]  # 374 to 672 Hz, 900 Hz
    energy_in = ledger.start.total + abs(ledger.end.work)
    for groups, balance in ((shares.at_separation, ledger.at_separation), (shares.end, ledger.end)):
        # 1e-10 of what was put in: the march's own tolerance of a step is 1e-10 of the speeds
        assert sum(part.energy for part in groups) == pytest.approx(balance.structure, abs=1e-10 * energy_in)
        assert sum(energy_shares(balance, groups).values()) == pytest.approx(1.0, rel=1e-12)  # rounding of the sum


def test_free_modes_keep_their_own_energy() -> None:
    """v^2 / 2 of every undamped mode for good."""
    basis, _ = given_modes([0.0, 10.0, 30.0], [0.0, 0.0, 0.0], {})
    shares = mode_energies(simulate(basis, Scene(velocity=[1.0, 2.0, 3.0]), Clock(0.31, 1e3)))
    assert shares.at_separation is None
    assert [part.name for part in shares.end] == ["rigid", "mode 2", "mode 3"]
    assert [part.to_hz for part in shares.end] == pytest.approx([0.0, 10.0, 30.0], rel=1e-14)  # 2 pi and back
    # 1e-12: the exact flow and the last sample's integration, 3e-14 each
    assert [part.energy for part in shares.end] == pytest.approx([0.5, 2.0, 4.5], rel=1e-12)


def test_beyond_ten_elastic_modes_octaves() -> None:
    """Modes 1 to 10 alone, then up to twice the first frequency that is left."""
    frequencies = [*np.arange(1.0, 11.0), 11.0, 12.0, 22.0, 23.0, 60.0]
    basis, _ = given_modes(list(frequencies), [0.0] * 15, {})
    groups = grouped(basis, np.arange(1.0, 16.0))
    assert [part.name for part in groups[9:]] == ["mode 10", "modes 11 to 13", "mode 14", "mode 15"]
    assert (groups[10].from_hz, groups[10].to_hz, groups[10].energy) == pytest.approx(
        (11.0, 22.0, 36.0)
    )  # 11 + 12 + 13
