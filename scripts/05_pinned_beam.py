"""A pinned beam falls on a wave mass, with a damper on it (section 5.3.1, Figs 5.8 to 5.17).

Energies of its modes in time, and that of the beam at the first instant with both contacts open. After the last contact
the motion is chaotic, and the mass ratio of Figs 5.11 to 5.13 is not printed: 0.30 fits. Accelerations of the free end
with the six modes of the source are two thirds of those with forty, where an added mass does better than the damper.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import boat
from systems import pinned_beam as pinned
from systems.pictures import save

WAVE, MU = 9.0, 0.3
POINT_P = 17.9  # omega_d / omega_1 at the lowest energy of the beam
PROFILES = {"no damper": (0.0, 0.0), "damper 5": (MU, 5.0), "point P, 17.9": (MU, POINT_P), "damper 40": (MU, 40.0)}
STIFFNESS = 5e5  # of the wave contact in Figs 5.16 and 5.17 [N/m]
MANY = 40  # modes, the rigid one with them: peaks within 3 % of those with 60
DAMPERS = np.geomspace(4.0, 60.0, 60)  # omega_d / omega_1
STIFF = 4.7e3 / (2 * np.pi * float(pinned.frequencies()[1]))  # omega_w / omega_1 of Fig. 5.14
RATIOS = np.linspace(0.8, 5.0, 100)  # omega_d / omega_w


def main() -> dict[str, float]:
    """Frequencies [Hz], contact time [ms], energies of modes and of the beam [%], accelerations [m/s^2]."""
    found = {f"f{i} Hz": float(f) for i, f in enumerate(pinned.frequencies()) if i}
    _profiles()
    none, at_5 = pinned.separation(pinned.fall(WAVE)), pinned.separation(pinned.fall(WAVE, MU, 5.0))
    found |= {"contact ms": 1e3 * none.t} | {f"mode {i} %": float(100 * none.modes[i]) for i in range(6)}
    found |= {f"mode {i} of beam %, damper 5": float(100 * at_5.shares[i]) for i in (1, 3)}
    _lowest()
    return found | _energies() | _in_time() | _accelerations()


def _profiles() -> None:
    """Figs 5.10 to 5.13."""
    figure = Figure(figsize=(11, 7), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for axis, (name, (mu, damper)) in zip(axes.flat, PROFILES.items(), strict=True):
        response = pinned.fall(WAVE, mu, damper)
        energies, start = pinned.modal_energies(response), response.ledger.start.total
        for mode in range(1, 6):
            axis.plot(1e3 * response.t, 100 * energies[mode] / start, label=f"{mode}")
        axis.axvline(1e3 * pinned.separation(response).t, color="0.6", lw=0.8, ls="--")
        axis.set_title(name, fontsize=10)
        axis.grid(alpha=0.3)
    for axis in axes[1]:
        axis.set(xlabel="time [ms]", xlim=(0.0, 1.5))
    for axis in axes[:, 0]:
        axis.set_ylabel("energy of the mode / initial energy [%]")
    axes[0, 0].legend(title="elastic mode", fontsize=8)
    figure.suptitle(
        "Wave contact at 9 times the beam's first frequency, damper 0.3 of its mass; dashed: first separation"
    )
    save(figure, "05_pinned_beam")


def _energies() -> dict[str, float]:
    """Figs 5.8 and 5.14; energies of the beam [%] at some of the lowest places of the latter."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for mu in (0.1, 0.2, MU, 0.6):
        left.plot(DAMPERS, 100 * pinned.beam_energies(WAVE, mu, DAMPERS), label=f"{mu:g}")
        right.plot(RATIOS, 100 * pinned.beam_energies(STIFF, mu, RATIOS * STIFF), label=f"{mu:g}")
    left.set(
        xlabel="contact frequency of the damper over the beam's first [1]",
        ylabel="energy of the beam (5.61) / initial energy [%]",
    )
    left.set_title("At the first separation, wave contact at 9 times the first", fontsize=10)
    right.set(xlabel="contact frequency of the damper over the wave's [1]")
    right.set_title("The same, wave contact at 4700 rad/s", fontsize=10)
    right.legend(title="damper / beam mass", fontsize=8)
    for axis in (left, right):
        axis.grid(alpha=0.3, which="both")
    save(figure, "05_pinned_beam_damper")
    return {
        f"beam % at {mu:g}, {ratio:g}": 100 * float(pinned.beam_energies(STIFF, mu, np.array([ratio * STIFF]))[0])
        for mu, ratio in ((0.1, 2.87), (0.3, 2.026), (0.3, 3.7), (0.6, 2.612))
    }


def _in_time() -> dict[str, float]:
    """Fig. 5.9; kinetic energies of damper and wave mass at the first separation [%]."""
    figure = Figure(figsize=(12, 4.4), layout="constrained")
    damper, wave, apart = figure.subplots(1, 3)
    found: dict[str, float] = {}
    for ratio in (5.0, POINT_P, 40.0):
        response = pinned.fall(WAVE, MU, ratio)
        start, parted = response.ledger.start.total, pinned.separation(response)
        for axis, name, mass in ((damper, "damper", MU * pinned.MASS), (wave, "wave", pinned.WAVE_MASS)):
            kinetic = 0.5 * mass * response.bodies[name].velocity ** 2 / start
            (line,) = axis.plot(1e3 * response.t, 100 * kinetic, label=f"{ratio:g}")
            axis.plot(1e3 * parted.t, 100 * getattr(parted, name), "o", color=line.get_color(), markersize=5)
            found[f"{name} % at {ratio:g}"] = 100 * getattr(parted, name)
    parts = [pinned.separation(pinned.fall(WAVE, MU, float(ratio))) for ratio in DAMPERS]
    for name, label in (("damper", "damper"), ("wave", "wave mass")):
        apart.plot(DAMPERS, [100 * getattr(one, name) for one in parts], label=label)
    apart.plot(DAMPERS, [100 * one.beam for one in parts], label="beam (5.61)")
    for axis, name in ((damper, "damper"), (wave, "wave mass")):
        axis.set(xlabel="time [ms]", title=f"kinetic energy of the {name}", xlim=(0.0, 1.5))
        axis.legend(title="ω_d/ω_1 [1]", fontsize=8)
    damper.set_ylabel("energy / initial energy [%]")
    apart.set(xlabel="damper's contact frequency, ω_d/ω_1 [1]", title="at the first separation", ylim=(0.0, 90.0))
    apart.legend(fontsize=8)
    for axis in (damper, wave, apart):
        axis.grid(alpha=0.3)
    figure.suptitle(
        "Wave contact at 9 times the beam's first frequency, damper 0.3 of its mass; dots: first separation"
    )
    save(figure, "05_pinned_beam_in_time")
    return found


def _lowest() -> None:
    """Fig. 5.15."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axis = figure.subplots()
    ratios, masses = np.linspace(0.3, 5.0, 236), np.linspace(0.1, 1.0, 46)
    places = [(float(mu), *lowest) for mu in masses for lowest in pinned.minima(STIFF, float(mu), ratios)]
    mu, ratio, energy = np.array(places).T
    best = np.array([max(places, key=lambda one: (one[0] == m, -one[2])) for m in masses])
    shown = axis.scatter(mu, ratio, c=100 * energy, s=14, cmap="viridis")
    axis.plot(best[:, 0], best[:, 1], "ro", fillstyle="none", markersize=7, label="the lowest of them")
    axis.plot(masses, [boat.optimum(float(m)) for m in masses], "k--", linewidth=1, label="two rigid masses, 5.45")
    figure.colorbar(shown, ax=axis, label="energy of the beam (5.61) [%]")
    axis.set(xlabel="damper / beam mass [1]", ylabel="contact frequency of the damper over the wave's [1]")
    axis.set_title("Where the beam keeps least: each line a minimum, wave contact at 4700 rad/s", fontsize=10)
    axis.legend(fontsize=8)
    axis.grid(alpha=0.3)
    save(figure, "05_pinned_beam_minima")


def _accelerations() -> dict[str, float]:
    """Figs 5.16 and 5.17, with the modes of the source and with more; peaks [m/s^2] without a damper."""
    figure = Figure(figsize=(13, 7.5), layout="constrained")
    axes = figure.subplots(2, 3, sharex=True, sharey=True)
    found: dict[str, float] = {}
    for row, modes in zip(axes, (6, MANY), strict=True):
        none = pinned.accelerations(STIFFNESS, modes=modes)
        for axis in row:
            axis.plot(1e3 * none[0], none[1], "0.6", linewidth=1, label="neither")
        for mu in (0.1, 0.2, 0.4):
            damper = pinned.accelerations(STIFFNESS, mu, boat.optimum(mu), modes)
            row[0].plot(1e3 * damper[0], damper[1], linewidth=1, label=f"damper {mu:g}")
            added = pinned.accelerations(STIFFNESS, modes=modes, added=mu)
            found[f"{modes} modes, damper over added mass {mu:g}"] = _peak(damper) / _peak(added)
            if mu < 0.4:
                axis = row[1 if mu == 0.1 else 2]
                axis.plot(1e3 * damper[0], damper[1], linewidth=1, label=f"damper {mu:g}")
                axis.plot(1e3 * added[0], added[1], linewidth=1, label=f"added mass {mu:g}")
        row[0].set_ylabel(f"acceleration of the free end [m/s²], {modes} modes")
        titles = ("damper (Fig. 5.16)", "mass ratio 0.1 (Fig. 5.17)", "mass ratio 0.2 (Fig. 5.17)")
        for axis, title in zip(row, titles, strict=True):
            axis.set_title(title if modes == 6 else "", fontsize=10)
        for place in ("free end", "middle"):
            values = pinned.accelerations(STIFFNESS, modes=modes, place=place)[1]
            found |= {
                f"{modes} modes, {place} max": float(values.max()),
                f"{modes} modes, {place} min": float(values.min()),
            }
    for axis in axes.flat:
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8, loc="lower left")
    for axis in axes[1]:
        axis.set_xlabel("time [ms]")
    figure.suptitle("Wave contact of 5e5 N/m, damper's contact by 5.45: six modes are not enough for an acceleration")
    save(figure, "05_pinned_beam_acceleration")
    return found


def _peak(history: tuple[np.ndarray, np.ndarray]) -> float:
    return float(np.abs(history[1]).max())


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:28} {value:10.4f}")
