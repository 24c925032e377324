"""Three rigid bodies in a row: who takes the energy of the ball (section 2.2, Figs 2.3 to 2.5, Table 2.2).

The damper's share over its contact frequency, for several contact frequencies of the ball, beside the two limits that
restitution knows: one blow after the other (a soft damper) and one blow on both (a stiff one). Then what happens in
time, in the units of Figs 2.4 and 2.5, for a damper that is too soft, the best one and one that is too stiff.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import rigid
from systems.pictures import save

from femstruct.impact.collisions import collide, collide_as_one

BALL = 0.5
DAMPERS = (0.25, 0.5, 1.0, 1.5)
CONTACTS = (1.25, 2.5, 10.0, 100.0)  # omega_b / omega
RATIOS = np.geomspace(0.05, 8.0, 20)  # omega_d / omega_b


HISTORIES = {1.25: 1.3311, 2.5: 1.0457}  # omega_b / omega, and the best omega_d / omega_b for m_d / m = 0.5


def main() -> dict[str, float]:
    """Shares of the damper [1] at omega_d = omega_b and at its best, and the limits, for m_d/m = 1."""
    figure = Figure(figsize=(10, 7.5), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for axis, rd in zip(axes.flat, DAMPERS, strict=True):
        for i, wb in enumerate(CONTACTS):
            shares = [rigid.share(BALL, rd, wb, wb * ratio) for ratio in RATIOS]
            axis.semilogx(RATIOS, [one.damper for one in shares], f"C{i}-", label=f"damper, {wb:g}")
            axis.semilogx(RATIOS, [one.mass for one in shares], f"C{i}--", label=f"mass, {wb:g}")
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
