"""Forging press: energy left in the machine after a blow (Figs. 4.3 to 4.9, 4.12, 4.16 and 4.17), and how it got there.

The source reads from its maps that omega_d = omega_s is best, that the peak is at omega_s = omega_10, and that a damper
as heavy as the bed leaves 2.2 %. The first holds near omega_s / omega_6 = 150 only, the second on average over masses,
the third for two modes only.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import press
from systems.pictures import save
from systems.press import BED, UNIT, Machine

HARD = ("parts.springs.stiffness.x=6e6", "parts.springs.stiffness.y=6e6", "parts.springs.stiffness.z=1e7")
POINTS = {"P": 25.0, "Q": 150.0, "R": 220.0}  # omega_d / omega_6 at omega_s / omega_6 = 150
LIGHT = 0.35 * BED


def main(side: int = 100) -> dict[str, float]:
    """Machine's share of the energy at P, Q, R, and best frequency ratios; side : points along an edge of a map."""
    two = press.two_modes()
    _maps(two, side)
    _curves(two, side)
    _histories(two)
    found = {name: press.share(two, 150.0 * UNIT, wd * UNIT, LIGHT).machine for name, wd in POINTS.items()}
    found["mass ratio 1"] = press.share(two, 150.0 * UNIT, 150.0 * UNIT, BED).machine
    for ratio in (0.35, 1.0):
        found[f"best omega_d / omega_s, {ratio:g}"] = press.best_damper(two, 150.0 * UNIT, ratio * BED)[0]
    return found


def _maps(two: Machine, side: int) -> None:
    hard, ground = press.fitted(600.0, *HARD), press.fitted(600.0, model="press_clamped")
    w4 = float(ground.basis.omega[3])
    shown = {
        "case 1, m_d/m_b = 0.35 (Fig. 4.3 a)": (two, 0.35, UNIT, "6", np.linspace(10.0, 260.0, side)),
        "case 1, m_d/m_b = 0.7 (Fig. 4.3 b)": (two, 0.7, UNIT, "6", np.linspace(10.0, 260.0, side)),
        "case 2, springs of 1e7 N/m, 0.35 (Fig. 4.12)": (hard, 0.35, UNIT, "6", np.linspace(10.0, 260.0, side)),
        "case 3, columns on the ground, 0.35 (Fig. 4.16)": (ground, 0.35, w4, "4", np.linspace(0.2, 5.2, side)),
    }
    figure = Figure(figsize=(11, 9), layout="constrained")
    for axis, (title, (machine, ratio, unit, mode, grid)) in zip(
        figure.subplots(2, 2).flat, shown.items(), strict=True
    ):
        energy = press.machine_shares(machine, *np.meshgrid(grid * unit, grid * unit), ratio * BED)
        filled = axis.contourf(grid, grid, 100.0 * energy, levels=np.arange(0.0, 62.5, 2.5), extend="max")
        bar = figure.colorbar(filled, ax=axis, label="energy of the machine / slider's before [%]")
        bar.set_ticks(np.arange(0.0, 61.0, 10.0).tolist())
        axis.plot(grid, grid, "w--", linewidth=0.9, label="ω_d = ω_s")
        axis.plot(grid, grid[np.argmin(energy, axis=0)], "r.", markersize=4, label="best ω_d at this ω_s")
        if ratio == 0.35 and machine is two:
            for name, wd in POINTS.items():
                axis.annotate(name, (150.0, wd), color="w", fontsize=11, ha="center", va="center", fontweight="bold")
        reference = " (ω_6 = 40 rad/s)" if mode == "6" else f" (ω_4 = {w4:.0f} rad/s)"
        axis.set(title=title, xlabel=f"slider's contact frequency, ω_s/ω_{mode} [1]{reference}")
        axis.set_ylabel(f"damper's contact frequency, ω_d/ω_{mode} [1]")
        axis.legend(loc="upper left", fontsize=8)
    figure.suptitle("Energy left in the press when slider and damper have left the bed")
    save(figure, "06_press_maps")


def _curves(two: Machine, side: int) -> None:
    figure = Figure(figsize=(11, 8), layout="constrained")
    (mass, resonance), (ground, ballast) = figure.subplots(2, 2)
    ratios, sliders = np.geomspace(0.2, 3.0, 2 * side), np.linspace(5.0, 260.0, 2 * side)
    clamped = press.fitted(600.0, model="press_clamped")
    w4 = float(clamped.basis.omega[3])
    for ratio in (0.2, 0.35, 0.5, 0.7, 1.0):
        m, label = ratio * BED, f"{ratio:g}"
        mass.plot(ratios, 100 * press.machine_shares(two, np.array(6000.0), 6000.0 * ratios, m), label=label)
        resonance.plot(sliders, 100 * press.machine_shares(two, sliders * UNIT, sliders * UNIT, m), label=label)
        across = np.linspace(0.2, 5.2, 2 * side)
        ground.plot(across, 100 * press.machine_shares(clamped, across * w4, across * w4, m), label=label)
    heavier = press.ballasted(LIGHT)
    for machine, m, label in (
        (two, 0.0, "neither"),
        (heavier, 0.0, "mass of 3.5 kg on the bed"),
        (two, LIGHT, "damper of 3.5 kg"),
    ):
        ballast.plot(sliders, 100 * press.machine_shares(machine, sliders * UNIT, sliders * UNIT, m), label=label)
    mass.set(
        title="Fig. 4.4: ω_s = 6000 rad/s, two modes",
        xlabel="damper's contact frequency over the slider's, ω_d/ω_s [1]",
    )
    resonance.set(title="Fig. 4.5: ω_d = ω_s, two modes", xlabel="ω_s/ω_6 [1] (ω_6 = 40 rad/s)")
    ground.set(title="Fig. 4.17: ω_d = ω_s, columns on the ground", xlabel=f"ω_s/ω_4 [1] (ω_4 = {w4:.0f} rad/s)")
    ballast.set(title="Fig. 4.9: damper (ω_d = ω_s) against added mass", xlabel="ω_s/ω_6 [1] (ω_6 = 40 rad/s)")
    for axis in (mass, resonance, ground, ballast):
        axis.set_ylabel("energy of the machine / slider's before [%]")
        axis.set_ylim(bottom=0.0)
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8, title=None if axis is ballast else "m_d/m_b")
    save(figure, "06_press_curves")


def _histories(two: Machine) -> None:
    figure = Figure(figsize=(13, 4.6), layout="constrained")
    for axis, (name, wd) in zip(figure.subplots(1, 3, sharey=True), POINTS.items(), strict=True):
        response = press.blow(two, 6000.0, wd * UNIT, LIGHT, 2.5e-3 if name == "P" else 1e-3, 500)
        t = 1e3 * response.t
        machine = 0.5 * ((response.qd**2).sum(axis=0) + ((two.basis.omega[:, None] * response.q) ** 2).sum(axis=0))
        shown = {"machine": machine}
        for body, m, k in (
            ("slider", press.SLIDER, press.SLIDER * 6000.0**2),
            ("damper", LIGHT, LIGHT * (wd * UNIT) ** 2),
        ):
            shown[f"{body}, kinetic"] = 0.5 * m * response.bodies[body].velocity ** 2
            shown[f"{body}'s contact spring"] = 0.5 * k * np.maximum(response.contacts[body].indentation, 0.0) ** 2
        for label, values in shown.items():
            axis.plot(t, values / press.START, label=label)
        axis.plot(t, sum(shown.values()) / press.START, "k:", label="sum")
        for body in ("slider", "damper"):
            opened = response.contacts[body].first_open
            assert opened is not None
            axis.axvline(1e3 * opened, color="grey", linewidth=0.8, linestyle="--" if body == "slider" else "-.")
        axis.set(title=f"{name}: ω_s/ω_6 = 150, ω_d/ω_6 = {wd:g}", xlabel="time [ms]")
        axis.grid(alpha=0.3)
    figure.axes[0].set_ylabel("energy over the slider's before [1]")
    figure.axes[0].legend(fontsize=8, loc="center right", bbox_to_anchor=(1.0, 0.74))
    figure.suptitle("Figs. 4.6 to 4.8, m_d/m_b = 0.35; the slider leaves the bed at -- and the damper at -·")
    save(figure, "06_press_histories")


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:32} {value:10.4g}")
