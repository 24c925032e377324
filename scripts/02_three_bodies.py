"""Three rigid bodies in a row: who takes the energy of the ball (section 2.2, Figs 2.3 to 2.5, Table 2.2).

The damper's share over both contact frequencies as maps, then over its own for several of the ball's, beside the two
limits that restitution knows: one blow after the other (a soft damper) and one blow on both (a stiff one). Then what
happens in time, in the units of Figs 2.4 and 2.5, for a damper that is too soft, the best one and one that is too
stiff.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import rigid
from systems.pictures import save

from femstruct.impact.collisions import collide, collide_as_one

BALL = 0.5
DAMPERS = (0.25, 0.5, 1.0, 1.5)
CONTACTS = (1.25, 2.5, 10.0, 100.0)  # omega_b / omega
RATIOS = np.geomspace(0.05, 8.0, 100)  # omega_d / omega_b

HISTORIES = {1.25: 1.3311, 2.5: 1.0457}  # omega_b / omega, and the best omega_d / omega_b for m_d / m = 0.5


def main(side: int = 70) -> dict[str, float]:
    """Shares of the damper [1] at omega_d = omega_b and at its best, and the limits, for m_d/m = 1.

    side : points along an edge of a map.
    """
    _maps(side)
    figure = Figure(figsize=(10, 7.5), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for axis, rd in zip(axes.flat, DAMPERS, strict=True):
        for i, wb in enumerate(CONTACTS):
            shares = rigid.shares(BALL, rd, np.array(wb), wb * RATIOS)
            axis.semilogx(RATIOS, shares.damper, f"C{i}-", label=f"damper, {wb:g}")
            axis.semilogx(RATIOS, shares.mass, f"C{i}--", label=f"mass, {wb:g}")
        for ends, found in (("left", _in_turn(rd)), ("right", _as_one(rd))):
            axis.plot([RATIOS[0 if ends == "left" else -1]], [found], "k<" if ends == "left" else "k>")
        axis.set_title(f"damper / mass = {rd:g}", fontsize=10)
        axis.grid(alpha=0.3)
    for axis in axes[1]:
        axis.set_xlabel("contact frequencies, damper over ball [1]")
    for axis in axes[:, 0]:
        axis.set_ylabel("energy over that of the ball [1]")
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(),
        title="who, contact frequency of the ball over that of the mass on its spring",
        loc="outside lower center",
        fontsize=8,
        ncols=4,
    )
    figure.suptitle(
        "Energy after the collision; triangles: damper's share by restitution, in turn (left) and as one (right)"
    )
    save(figure, "02_three_bodies")
    _histories()
    found = {"in turn": _in_turn(1.0), "as one": _as_one(1.0)}
    found["equal frequencies"] = rigid.share(BALL, 1.0, 100.0, 100.0).damper
    for wb in CONTACTS:
        found[f"best ratio at {wb:g}"], found[f"best share at {wb:g}"] = rigid.best_damper(BALL, 0.5, wb)
    return found


def _maps(side: int) -> None:
    grid = np.geomspace(0.5, 100.0, side)
    figure = Figure(figsize=(11, 9), layout="constrained")
    for axis, rd in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, DAMPERS, strict=True):
        taken = rigid.shares(BALL, rd, *np.meshgrid(grid, grid)).damper
        filled = axis.contourf(grid, grid, 100.0 * taken, levels=np.arange(0.0, 95.0, 5.0))
        figure.colorbar(filled, ax=axis, label="energy of the damper / ball's before [%]")
        axis.plot(grid, grid, "w--", linewidth=0.9, label="ω_d = ω_b")
        axis.plot(grid, grid[np.argmax(taken, axis=0)], "r.", markersize=3, label="best ω_d at this ω_b")
        axis.set(xscale="log", yscale="log", title=f"damper / mass = {rd:g}")
        axis.legend(loc="upper left", fontsize=8)
    for axis in figure.axes[2:4]:
        axis.set_xlabel("ball's contact frequency, ω_b/ω [1]")
    for axis in figure.axes[0:4:2]:
        axis.set_ylabel("damper's contact frequency, ω_d/ω [1]")
    figure.suptitle("Energy the damper takes from a ball of half the mass; ω of the mass on its spring")
    save(figure, "02_three_bodies_maps")


def _histories() -> None:
    """Velocities over the ball's first one, forces over m_b omega_b v_b; positive as the ball comes."""
    figure = Figure(figsize=(12, 6.5), layout="constrained")
    axes = figure.subplots(2, 3, sharex=True, sharey=True)
    for row, (wb, best) in zip(axes, HISTORIES.items(), strict=True):
        for axis, wd in zip(row, (0.1, wb * best, 15.0), strict=True):
            response = rigid.hit(BALL, 0.5, wb, wd, samples=600, window=4.0 * np.pi / wb)
            t = response.t * wb / np.pi
            for i, name in enumerate(("ball", "damper")):
                axis.plot(t, -response.bodies[name].velocity, f"C{i}--", label=f"velocity of the {name}")
                axis.plot(t, response.contacts[name].force / (BALL * wb), f"C{i}-", label=f"force of the {name}")
            axis.plot(t, -response.qd[0], "C2--", label="velocity of the mass")  # modal mass 1
            axis.set_title(f"contact frequencies: ball {wb:g}, damper {wd:.3g}", fontsize=9)
            axis.grid(alpha=0.3)
        row[0].set_ylabel("over their units [1]")
    for axis in axes[1]:
        axis.set_xlabel("time over half a period of the ball's contact [1]")
    axes[0, 0].legend(fontsize=7)
    figure.suptitle("Three bodies in time; contact frequencies over that of the mass, damper 0.5 of the mass")
    save(figure, "02_three_bodies_in_time")


def _in_turn(rd: float) -> float:
    return float(collide([BALL, 1.0, rd], [1.0, 0.0, 0.0], [1.0, 1.0]).energies[2])


def _as_one(rd: float) -> float:
    return float(collide_as_one([BALL, 1.0, rd], [1.0, 0.0, 0.0], 1.0).energies[2])


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:24} {value:10.6f}")
