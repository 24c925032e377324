"""Contact stiffness and damping from a measured force (sections 2.4.2 and 3.3, Tables 2.6 and 3.1).

The dissertation reconciles simulation and measurement and prints the parameters, not the records. Here its parameters
make the records, noise of 1 % of the peak is added, and least squares find them again, with intervals. Then one law is
asked to explain the tennis ball from all three heights at once: with the parameters of Table 3.1 no power of the
indentation does, since they are not constants of a contact.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from systems import wall
from systems.pictures import save

from femstruct.workflow.fit import Fit

COLOURS = ("C0", "C1", "C2")


def main(csv: Path | None = None) -> dict[str, float]:
    """Found over printed values, half widths of intervals [%]; csv : where to write the first record, if at all."""
    tennis, acrylic, hits = wall.drops(wall.TENNIS), wall.drops(wall.ACRYLIC), wall.collisions()
    fits = {"tennis": [wall.found_hertz(one) for one in tennis], "acrylic": [wall.found_hertz(one) for one in acrylic]}
    springs = {name: wall.found_linear(one) for name, one in hits.items()}
    together = wall.found_together(tennis)
    if csv is not None:
        lines = (f"{1e3 * t:.4f}, {f:.3f}" for t, f in zip(tennis[0].t, tennis[0].force, strict=True))
        csv.write_text("\n".join(("time [ms], force [N]", *lines, "")), encoding="utf-8")
    found: dict[str, float] = {}
    for ball, (_, stiffnesses, damping) in (("tennis", wall.TENNIS), ("acrylic", wall.ACRYLIC)):
        for height, k, one in zip(wall.HEIGHTS, stiffnesses, fits[ball], strict=True):
            for word, printed in (("stiffness", k), ("damping", damping)):
                found |= _told(one, word, printed, f"{ball} {height:g} m: {word}")
    for name, one in springs.items():
        found |= _told(one, "stiffness", wall.TABLE_2_6[name], f"{name}: stiffness")
    found |= {
        "one law for all heights, explained %": 100 * together.explained,
        "its exponent": together.values["exponent"],
    }
    _picture(tennis, fits["tennis"], together, found)
    return found


def _told(one: Fit, word: str, printed: float, name: str) -> dict[str, float]:
    half = 50.0 * (one.high[word] - one.low[word]) / one.values[word]
    return {name: one.values[word] / printed, f"{name} +- %": half}


def _picture(tennis: list[wall.Record], fits: list[Fit], together: Fit, found: dict[str, float]) -> None:
    figure = Figure(figsize=(13, 5.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
    computed = np.split(together.residuals, len(tennis))
    for record, one, residuals, height, colour in zip(tennis, fits, computed, wall.HEIGHTS, COLOURS, strict=True):
        t = 1e3 * record.t
        left.plot(t[::3], record.force[::3], ".", color=colour, markersize=4, label=f"record with noise, {height:g} m")
        left.plot(t, record.force + one.residuals, color=colour, label="its own law")
        left.plot(t[::2], record.force[::2] + residuals, "--", color=colour, label="one law for all")
    left.set(xlabel="time [ms]", ylabel="force [N]", title="Tennis ball of 54 g on a rigid plate, Table 3.1")
    left.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.12))
    names = [name for name in found if f"{name} +- %" in found]
    for i, name in enumerate(names):
        half = found[f"{name} +- %"]
        right.errorbar(
            100 * found[name] - 100, i, xerr=half, fmt="o", color="C3" if "damping" in name else "C0", capsize=3
        )
    right.axvline(0.0, color="0.4", lw=0.8)
    right.set_yticks(range(len(names)), names, fontsize=8)
    right.invert_yaxis()
    right.set(
        xlabel="found less printed, with 95 % interval [%]", title="From 300 samples with noise of 1 % of the peak"
    )
    for axis in (left, right):
        axis.grid(alpha=0.3)
    save(figure, "09_contact_identification")


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:40} {value:10.4f}")
