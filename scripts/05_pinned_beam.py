"""A pinned beam falls on a wave mass, with a damper on it (section 5.3.1, Figs 5.8 to 5.14).

Energies of its modes in time, and that of the beam at the first instant with both contacts open. After the last contact
the motion is chaotic, and the mass ratio of Figs 5.11 to 5.13 is not printed: 0.30 fits.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import pinned_beam as pinned
from systems.pictures import save

WAVE, MU = 9.0, 0.3
POINT_P = 17.9  # omega_d / omega_1 at the lowest energy of the beam
PROFILES = {"no damper": (0.0, 0.0), "damper 5": (MU, 5.0), "point P, 17.9": (MU, POINT_P), "damper 40": (MU, 40.0)}
DAMPERS = np.geomspace(4.0, 60.0, 30)  # omega_d / omega_1
STIFF = 4.7e3 / (2 * np.pi * float(pinned.frequencies()[1]))  # omega_w / omega_1 of Fig. 5.14
RATIOS = np.linspace(0.8, 5.0, 30)  # omega_d / omega_w


def main() -> dict[str, float]:
    """Frequencies [Hz], contact time [ms], and energies of modes and of the beam [%]."""
    found = {f"f{i} Hz": float(f) for i, f in enumerate(pinned.frequencies()) if i}
    _profiles()
    none, at_5 = pinned.separation(pinned.fall(WAVE)), pinned.separation(pinned.fall(WAVE, MU, 5.0))
    found |= {"contact ms": 1e3 * none.t} | {f"mode {i} %": float(100 * none.modes[i]) for i in range(6)}
    found |= {f"mode {i} of beam %, damper 5": float(100 * at_5.shares[i]) for i in (1, 3)}
    return found | _energies()


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
        axis.set_ylabel("energy of the mode over all before [%]")
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
        left.plot(DAMPERS, [_beam(WAVE, mu, float(damper)) for damper in DAMPERS], label=f"{mu:g}")
        right.plot(RATIOS, [_beam(STIFF, mu, float(ratio) * STIFF) for ratio in RATIOS], label=f"{mu:g}")
    left.set(xlabel="contact frequency of the damper over the beam's first [1]", ylabel="energy of the beam (5.61) [%]")
    left.set_title("At the first separation, wave contact at 9 times the first", fontsize=10)
    right.set(xlabel="contact frequency of the damper over the wave's [1]")
    right.set_title("The same, wave contact at 4700 rad/s", fontsize=10)
    right.legend(title="damper / beam mass", fontsize=8)
    for axis in (left, right):
        axis.grid(alpha=0.3, which="both")
    save(figure, "05_pinned_beam_damper")
    return {
        f"beam % at {mu:g}, {ratio:g}": _beam(STIFF, mu, ratio * STIFF)
        for mu, ratio in ((0.1, 2.87), (0.3, 2.026), (0.3, 3.7), (0.6, 2.612))
    }


def _beam(wave: float, mu: float, damper: float) -> float:
    return 100 * pinned.separation(pinned.fall(wave, mu, damper)).beam


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:28} {value:10.4f}")
