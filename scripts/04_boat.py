"""A boat under a half-sine wave (chapter 5, Figs 5.2, 5.5 and 5.23): the best contact frequency, and when it is not.

Equation 5.45 is the exact optimum from a mass ratio of 0.294 on; below, the peak of the acceleration splits. Above
1.447 a mass that is rigidly attached does better. A stiff hull that bends does the
same; how stiff the dissertation's is beside its wave is not given, so three are shown.
"""

import numpy as np
from matplotlib.figure import Figure
from systems import boat
from systems.pictures import save

CURVES = (0.1, 0.3, 0.6, 1.0)
GAMMAS = np.linspace(0.3, 4.0, 28)
HULLS = {20.0: "-", 5.0: "--", 3.0: ":"}  # first bending frequency over the wave's
MASSES = (0.1, 0.2, 0.3, 0.4, 0.6, 1.0, 1.4)


def main() -> dict[str, float]:
    """omega_d / omega_w at the smallest acceleration over that of 5.45, and that acceleration over that without [1]."""
    figure = Figure(figsize=(15, 4.6), layout="constrained")
    left, right, bending = figure.subplots(1, 3)
    for i, mu in enumerate(CURVES):
        gammas = np.sort([*GAMMAS, boat.optimum(mu)])
        left.plot(gammas, [boat.ratio(mu, float(gamma)) for gamma in gammas], f"C{i}-", label=f"{mu:g}")
        left.plot([boat.optimum(mu)], [boat.ratio(mu, boat.optimum(mu))], f"C{i}o")
    left.set(
        xlabel="contact frequency of the damper over the wave's [1]",
        ylabel="largest acceleration over that without [1]",
    )
    left.set_title("Damper on a boat; dots: equation 5.45", fontsize=10)
    left.legend(title="damper / boat mass", fontsize=8, loc="lower left")
    found: dict[str, float] = {}
    best = []
    for mu in MASSES:
        gamma, low = boat.best(mu)
        best.append(gamma)
        found[f"ratio to 5.45 at {mu:g}"], found[f"a / a0 at {mu:g}"] = gamma / boat.optimum(mu), low
    fine = np.linspace(0.05, 1.5, 100)
    right.plot(fine, [boat.optimum(mu) for mu in fine], "k-", label="equation 5.45")
    right.plot(MASSES, best, "C3o", label="smallest acceleration found")
    right.axvline(0.294287, color="0.6", lw=0.8, ls="--", label="0.294: from here on they agree")
    right.set(xlabel="damper / boat mass [1]", ylabel="best contact frequency over the wave's [1]")
    right.legend(fontsize=8)
    coarse = GAMMAS[::2]
    for elastic, line in HULLS.items():
        for i, mu in enumerate(CURVES[:3]):
            values = [boat.hull_ratio(mu, float(gamma), elastic) for gamma in coarse]
            bending.plot(coarse, values, f"C{i}{line}", label=f"{mu:g}, {elastic:g}")
    bending.set(
        xlabel="contact frequency of the damper over the wave's [1]",
        ylabel="largest acceleration at the front over that without [1]",
    )
    bending.set_title("A hull that bends", fontsize=10)
    bending.set_ylim(0.4, 1.02)
    bending.legend(
        title="damper / boat mass,\nbending / wave frequency", fontsize=7, ncols=3, title_fontsize=7, loc="lower left"
    )
    for axis in (left, right, bending):
        axis.grid(alpha=0.3)
    save(figure, "04_boat")
    found["5.43 at beta 0.5, mu 0.6"] = boat.best(0.6, 0.5)[0] / boat.optimum(0.6, 0.5)
    for elastic in (50.0, 20.0, 10.0):
        found[f"hull at {elastic:g}"] = boat.hull_ratio(0.3, boat.optimum(0.3), elastic)
    found["rigid mass over damper at mu 1.4"] = 1.0 / 2.4 / boat.ratio_at_optimum(1.4)
    found["rigid mass over damper at mu 1.5"] = 1.0 / 2.5 / boat.ratio_at_optimum(1.5)
    return found


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:36} {value:10.6f}")
