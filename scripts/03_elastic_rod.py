"""A free elastic rod between two masses (section 2.3, Figs 2.7 to 2.10): energies, times, and what 50 modes miss.

Modes miss the static flexibility of those left out, an error that falls with 1/N; with that flexibility in series with
the contacts it falls with N^-2 or faster. tests/against/test_impact_travelling_wave.py has the exact solution.
"""

import numpy as np
from matplotlib.figure import Figure
from systems.pictures import save
from systems.rod import RodCase, energies, hit

CONTACTS = (0.833, 1.1, 2.0, 5.05)  # omega_b / omega_1
RATIOS = np.geomspace(0.2, 20.0, 16)  # omega_d / omega_1
NUMBERS = (10, 20, 50, 100, 200)
EXACT = 0.636844  # damper's share at omega_b = omega_d = 0.8 omega_1 by travelling waves


def main() -> dict[str, float]:
    """Damper's shares [1], and errors of 50 modes without and with their residual flexibility."""
    figure = Figure(figsize=(11, 5.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for i, wb in enumerate(CONTACTS):
        shares = np.array([energies(RodCase(wb, wd)) for wd in RATIOS])
        left.semilogx(RATIOS, shares[:, 0], f"C{i}-", label=f"damper, {wb:g}")
        left.semilogx(RATIOS, shares[:, 2], f"C{i}--", label=f"rod, {wb:g}")
    left.set(
        xlabel="contact frequency of the damper over the rod's first [1]", ylabel="energy over that of the ball [1]"
    )
    figure.legend(
        *left.get_legend_handles_labels(),
        title="left: who, contact frequency of the ball over the rod's first",
        loc="outside lower left",
        fontsize=8,
        ncols=4,
    )
    left.set_title("Energy after the collision, rod of 2 m, 50 modes", fontsize=10)
    found: dict[str, float] = {}
    for residual, name in ((False, "modes alone"), (True, "with residual flexibility")):
        errors = [abs(energies(RodCase(0.8, 0.8, n, residual))[0] - EXACT) for n in NUMBERS]
        right.loglog(NUMBERS, errors, "o-", label=name)
        found[f"50 {name}"] = errors[NUMBERS.index(50)]
    right.set(xlabel="number of modes [1]", ylabel="error of the damper's share [1]")
    right.set_title("Against travelling waves (to 5e-7), contacts at 0.8 of the first", fontsize=10)
    right.legend(fontsize=8)
    for axis in (left, right):
        axis.grid(alpha=0.3, which="both")
    save(figure, "03_elastic_rod")
    _histories()
    for wb in (0.8, 2.0):
        found[f"damper at {wb:g}"] = energies(RodCase(wb, wb))[0]
    return found


def _histories() -> None:
    """Velocities over the ball's first one, forces over m_b omega_b v_b."""
    figure = Figure(figsize=(12, 9), layout="constrained")
    axes = figure.subplots(3, 3, sharey=True)
    for row, wb in zip(axes, (0.8, 1.1, 2.0), strict=True):
        for axis, wd in zip(row, (0.2, wb, 10.0), strict=True):
            case = RodCase(wb, wd)
            response = hit(case, duration=3e-3, sampling=4e5)
            unit = case.ball * wb * case.first  # [N s/m], the ball has 1 m/s
            t = response.t * wb * case.first / np.pi
            for i, name in enumerate(("ball", "damper")):
                axis.plot(t, response.bodies[name].velocity, f"C{i}--", label=f"velocity of the {name}")
                axis.plot(t, response.contacts[name].force / unit, f"C{i}-", label=f"force of the {name}")
            axis.set_title(f"contact frequencies: ball {wb:g}, damper {wd:g}", fontsize=9)
            axis.grid(alpha=0.3)
        row[0].set_ylabel("over their units [1]")
    for axis in axes[2]:
        axis.set_xlabel("time over half a period of the ball's contact [1]")
    axes[0, 0].legend(fontsize=7)
    figure.suptitle("Rod of 2 m in time, 50 modes; contact frequencies over the rod's first")
    save(figure, "03_elastic_rod_in_time")


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:32} {value:12.6g}")
