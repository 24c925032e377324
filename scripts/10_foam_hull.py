"""A small foam hull under a wave (section 5.3.2, Figs 5.22 and 5.23): our own, since the dissertation's is not printed.

A flat bottom with walls gets its thickness and its E from the two printed frequencies. Walls of 40, 50 and 60 mm fit
them alike, with 199, 126 and 87 MPa: two numbers do not describe a hull. The acceleration ratio hardly differs (0.657
to 0.661 at a mass ratio of 0.3), and is nearly that of two rigid masses while the wave is slow; what decides, and is
not printed, is the wave's period.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import RectBivariateSpline
from systems import boat, hull
from systems.pictures import save

HEIGHTS = (0.04, 0.05, 0.06)  # of the walls [m]
GAMMAS, MASSES = np.linspace(0.5, 4.0, 29), np.linspace(0.05, 1.0, 20)
CURVES = (0.1, 0.3, 0.6)


def main(every: int = 1) -> dict[str, float]:
    """Thickness [mm], E [MPa] and frequencies [Hz] by height of the walls; acceleration ratios at 5.45; every : of how
    many points of the map and the curves one is computed."""
    hulls = {height: hull.identified(height) for height in HEIGHTS}
    found: dict[str, float] = {}
    for height, one in hulls.items():
        name = f"walls {1e3 * height:g} mm"
        bending, torsion = hull.frequencies(one.basis, one.model)
        found |= {f"{name}: thickness mm": 1e3 * one.thickness, f"{name}: E MPa": one.E / 1e6, f"{name}: kg": one.mass}
        found |= {f"{name}: bending Hz": bending, f"{name}: torsion Hz": torsion}
        found[f"{name}: a / a0 at 0.3"] = hull.ratio(one, 0.3, boat.optimum(0.3))
    chosen = hulls[0.05]
    _modes(chosen)
    _ratios(chosen, every)
    for part in (20.0, 5.0, 3.0):
        found[f"bending / wave {part:g}: a / a0 at 0.3"] = hull.ratio(
            chosen, 0.3, boat.optimum(0.3), hull.BENDING / part
        )
    return found


def _modes(one: hull.Hull) -> None:
    """Fig. 5.22: the bottom in its first four elastic modes."""
    figure = Figure(figsize=(12, 4), layout="constrained")
    plate = one.model.parts["bottom"]
    x, y = np.linspace(0.0, plate.x[-1], 91), np.linspace(0.0, plate.y[-1], 31)
    elastic = np.flatnonzero(one.basis.omega > 1.0)[:4]
    for axis, mode in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, elastic, strict=True):
        w = RectBivariateSpline(plate.x, plate.y, one.basis.shapes[plate.grid, 2, mode])(x, y).T
        filled = axis.contourf(x, y, w / np.abs(w).max(), levels=np.linspace(-1.0, 1.0, 21), cmap="RdBu_r")
        axis.contour(x, y, w, levels=[0.0], colors="k", linewidths=1)
        axis.set(title=f"mode {mode + 1}: {one.basis.frequency_hz[mode]:.1f} Hz", aspect="equal")
        axis.set(xlabel="x [m]", ylabel="y [m]")
        axis.label_outer()
    figure.colorbar(filled, ax=figure.axes, label="deflection / largest [1]", ticks=[-1.0, -0.5, 0.0, 0.5, 1.0])
    figure.suptitle("Hull with walls of 50 mm: the first four elastic modes (printed: bending 293, torsion 388 Hz)")
    save(figure, "10_foam_hull_modes")


def _ratios(one: hull.Hull, every: int) -> None:
    """Fig. 5.23, and its section beside two rigid masses."""
    figure = Figure(figsize=(14, 6), layout="constrained")
    left, right = figure.subplots(1, 2)
    gammas, masses = GAMMAS[::every], MASSES[::every]
    values = np.array([[hull.ratio(one, float(mu), float(gamma)) for gamma in gammas] for mu in masses])
    filled = left.contourf(gammas, masses, values, levels=np.arange(0.4, 1.025, 0.025), extend="both")
    bar = figure.colorbar(filled, ax=left, label="acceleration of the front end / that without a damper [1]")
    bar.set_ticks(np.arange(0.4, 1.05, 0.1).tolist())
    left.plot([boat.optimum(float(mu)) for mu in masses], masses, "w--", label="5.45")
    left.set(xlabel="damper's contact frequency over the wave's, ω_d/ω_w [1]", ylabel="damper / hull mass [1]")
    left.set_title("Wave at a tenth of the bending frequency", fontsize=10)
    left.legend(fontsize=8)
    for i, mu in enumerate(CURVES):
        for part, line in ((10.0, "-"), (5.0, "--"), (3.0, ":")):
            ratios = [hull.ratio(one, mu, float(gamma), hull.BENDING / part) for gamma in gammas]
            right.plot(gammas, ratios, f"C{i}{line}", label=f"hull, {mu:g}, bending / wave {part:g}")
        right.plot(gammas, [boat.ratio(mu, float(gamma)) for gamma in gammas], f"C{i}.", label=f"two masses, {mu:g}")
    right.set(xlabel="damper's contact frequency over the wave's, ω_d/ω_w [1]", ylim=(0.5, 1.02))
    right.set_ylabel("acceleration / that without a damper [1]")
    right.set_title("Against two rigid masses, by damper / hull mass", fontsize=10)
    right.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.13))
    right.grid(alpha=0.3)
    save(figure, "10_foam_hull")


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:40} {value:10.4f}")
