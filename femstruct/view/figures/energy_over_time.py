"""Where the energy of an impact is over time: the ledger of every case, stacked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from femstruct.arrays import Floats
from femstruct.impact.result.response import EnergyLedger, Response
from femstruct.impact.result.shares import held_over_time
from femstruct.study.result import StudyResult
from femstruct.view.figures.drawing import finish, new_figure, panels
from femstruct.view.figures.histories import apart, responses, scaled_time, zoomed
from femstruct.view.figures.undrawn import no_energy
from femstruct.view.tables.scales import scaled

HELD_COLOURS: Final = {"bodies": "#0072b2", "structure": "#009e73", "contacts, links": "#e69f00"}
BESIDE_COLOURS: Final = ("#56b4e9", "#cc79a7", "#f0e442")  # of what holds energy of the modes beside the structure
LOST_COLOURS: Final = ("#e7b5ce", "#bcdff5", "#eab38a", "#f7f0a8", "#c9b8dd")  # pale: what is lost no longer moves
NOBODYS_COLOUR: Final = "#dddddd"  # of losses in the structure and all that is too little to be named
NAMED: Final = 0.01  # share of what was put in, from which on a loss has a colour of its own
LONG: Final = 2.0  # s: beyond it milliseconds have too many digits


def energy(result: StudyResult) -> Figure | None:
    """The ledger of every case, stacked: bodies, structure, contacts and links, what each contact and link took, other
    losses; up to what was put in.

    With two-way coupling, rooms and compliant walls stand beside the structure.
    """
    if no_energy(result):
        return None
    runs = responses(result)
    holders = dict.fromkeys(name for response in runs.values() for name in response.basis.holders)
    beside = [name for name in holders if name != "structure"]
    takers = _takers([response.ledger for response in runs.values()])
    above = 0.17 * ((len(beside) + len(takers) + 4) // 5)  # inches of further rows of the legend
    figure = new_figure(10.0, 1.25 + above + 2.3 * len(runs), "Energy over time")
    zooms = {name: zoomed(result, float(response.t[-1])) for name, response in runs.items()}
    columns = 2 if any(apart(zooms[name], float(response.t[-1])) for name, response in runs.items()) else 1
    grid = panels(figure, len(runs), columns, between=0.75, top=0.8 + above, sharey="row")
    for row, (name, response) in zip(grid, runs.items(), strict=True):
        ledger = response.ledger
        factor, unit = scaled("J", float(_input(ledger).max()))
        whole = float(ledger.t[-1])
        time, time_unit = scaled_time(whole if whole > LONG or columns == 1 else zooms[name])  # one for both panels
        for axes, end in zip(row, (zooms[name], whole)[-columns:], strict=True):
            _stack(axes, response, (factor, time), end, beside, takers)
            finish(axes, f"time in {time_unit}", "")
            axes.set_xlim(0.0, time * end)
            axes.set_ylim(0.0, 1.08 * factor * float(_input(ledger).max()) or 1.0)
        row[0].set_ylabel(f"energy in {unit}")
        row[0].set_title(f"{name}   (ledger residual {ledger.residual:.1e})", fontsize=9, loc="left")
    grid[0, -1].legend(
        fontsize=8,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=2.2,  # above the titles of the panels
        frameon=False,
        ncols=4 if beside else 5,
        columnspacing=1.0,
    )
    return figure


def _losses(ledger: EnergyLedger) -> dict[str, Floats]:
    """What contacts and links took until now [m] [J]; an array of contacts, "NAME.1" and on, as one."""
    taken: dict[str, Floats] = {}
    for name, lost in (*ledger.lost_contacts.items(), *ledger.lost_links.items()):
        array = name.rpartition(".")[0] or name
        taken[array] = taken[array] + lost if array in taken else lost
    return taken


def _takers(ledgers: Sequence[EnergyLedger]) -> tuple[str, ...]:
    """The contacts and links that take most, as many as there are colours, in their own order."""
    share: dict[str, float] = {}
    for ledger in ledgers:
        for name, lost in _losses(ledger).items():
            share[name] = max(share.get(name, 0.0), float(lost[-1] / max(_input(ledger)[-1], np.finfo(float).tiny)))
    most = sorted(share, key=lambda name: -share[name])[: len(LOST_COLOURS)]
    return tuple(name for name in share if name in most and share[name] >= NAMED)


def _stack(
    axes: Axes, response: Response, by: tuple[float, float], end: float, beside: Sequence[str], takers: Sequence[str]
) -> None:
    factor, scale = by  # of energies and of times
    ledger, t = response.ledger, np.linspace(0.0, end, 500)
    bodies = np.sum(list(ledger.bodies.values()), axis=0) if ledger.bodies else np.zeros_like(ledger.t)
    structure, none = np.interp(t, ledger.t, ledger.structure), np.zeros_like(t)
    held, taken = held_over_time(response, t), _losses(ledger)
    lost = {f"lost in {name}": np.interp(t, ledger.t, taken[name]) if name in taken else none for name in takers}
    rest = np.interp(t, ledger.t, ledger.dissipated) - np.sum(list(lost.values()), axis=0)
    layers = {
        "bodies": np.interp(t, ledger.t, bodies),
        "structure": held.get("structure", structure),
        **{name: held.get(name, none) for name in beside},
        "contacts, links": np.interp(t, ledger.t, ledger.stored),
        **lost,
        "lost elsewhere" if takers else "dissipated": rest,
    }
    colours = {
        **{name: BESIDE_COLOURS[i % len(BESIDE_COLOURS)] for i, name in enumerate(beside)},
        **HELD_COLOURS,
        **dict(zip(lost, LOST_COLOURS, strict=False)),
    }
    axes.stackplot(
        scale * t,
        [factor * layer for layer in layers.values()],
        labels=list(layers),
        colors=[colours.get(name, NOBODYS_COLOUR) for name in layers],
        linewidth=0,
    )
    axes.plot(scale * t, factor * np.interp(t, ledger.t, _input(ledger)), "k--", linewidth=1.0, label="put in")


def _input(ledger: EnergyLedger) -> Floats:
    """Energy at the start and what work and blows brought since [nt] [J]."""
    put_in: Floats = ledger.start.total + ledger.work + ledger.blows
    return put_in
