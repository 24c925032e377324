"""Five blows of a forging hammer: what its isolators, an eccentric blow and an impact damper change.

The dimensions are plausible, no maker's (see models/forging_hammer.study.yaml); the picture has the force on the ground
and the travel of the block, over the five blows and over the first one. Run it with the name of a PNG to draw it.
"""

import sys
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow.run import run_study

STUDY = Path(__file__).parents[1] / "models" / "forging_hammer.study.yaml"
ROWS = (("ground force", "force on the ground [kN]", 1e-3), ("corner.z displacement", "travel of the block [mm]", 1e3))
FIRST = 0.5  # s


def main(picture: str = "") -> dict[str, float]:
    """Ground forces [kN], travels [mm], times to rest [s] and energies [%] by case."""
    result = run_study(read_study(STUDY))
    found: dict[str, float] = {}
    for name, row in result.machine.items():
        found[f"ground force {name} kN"] = row.ground.dynamic / 1e3
        found[f"with weight {name} kN"] = row.ground.with_weight / 1e3
        found[f"block travel {name} mm"] = 1e3 * row.travels["corner.z displacement"]
        found[f"rest {name} s"] = row.rest.after
        found[f"forged {name} %"] = 100.0 * row.at_separation.forged / row.at_separation.put_in
        found[f"ledger {name}"] = result.cases[name].response.ledger.residual
        found[f"limits exceeded {name}"] = sum(verdict.met is False for verdict in result.verdicts[name])
    if picture:
        draw(result, picture)
    return found


def draw(result: StudyResult, path: str) -> None:
    """All cases over each other: on the left the five blows, on the right the first one."""
    figure = Figure(figsize=(12, 7), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(ROWS), 2, sharex="col", sharey="row", width_ratios=(2, 1))
    for axes, (channel, label, factor) in zip(grid, ROWS, strict=True):
        for name, case in result.cases.items():
            for part in axes:
                part.plot(case.response.t, factor * case.channels[channel].values, label=name, linewidth=0.9)
        axes[0].set_ylabel(label)
    grid[0, 1].set_xlim(0.0, FIRST)
    figure.suptitle(result.plan.title)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize="small")
    for part in grid.flat:
        part.grid(alpha=0.3)
    for part in grid[-1]:
        part.set_xlabel("time [s]")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    for key, value in main(*sys.argv[1:2]).items():
        print(f"{key:45} {value:10.4g}")
