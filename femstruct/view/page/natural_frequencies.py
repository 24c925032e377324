"""The table of natural frequencies and damping ratios, structure beside structure."""

from __future__ import annotations

from math import isnan
from typing import Final

from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.damped_modes import damped_modes
from femstruct.sound.cavities import WOOL
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid

MOST: Final = 20  # modes of a structure; all are in results.h5


def natural_frequencies(result: StudyResult) -> Grid:
    """The first modes of every structure: frequency [Hz] and damping ratio, a column for the cases that share it.

    Of structures over wool those of the damped modes, as `femstruct modes` lists them: a ratio of one mode without
    losses says nothing there.
    """
    alike: dict[tuple[str, bytes], list[str]] = {}
    for name, case in result.cases.items():
        alike.setdefault((case.basis_key, case.basis.damping_ratio.tobytes()), []).append(name)
    columns = {", ".join(names): _modes(result.cases[names[0]].basis) for names in alike.values()}
    longest = max(map(len, columns.values()), default=0)
    more = f" (the first {MOST} of at most {longest} modes)" if longest > MOST else ""
    grid = Grid(f"natural frequencies [Hz], damping ratios{more}", ("mode", *columns))
    for mode in range(min(MOST, longest)):
        grid.add(str(mode + 1), *(column[mode] if mode < len(column) else "-" for column in columns.values()))
    return grid


def _modes(basis: ModalBasis) -> list[str]:
    if WOOL in basis.holders and (damped := damped_modes(basis)) is not None:
        pairs = zip(damped.frequency_hz.tolist(), damped.damping_ratio.tolist(), strict=True)
        return ["0.00"] * basis.n_rigid + [f"{f:.2f}, {100.0 * ratio:.3g} %" for f, ratio in pairs]
    true = basis.modes
    found = []
    for f, ratio, kind in zip(basis.frequency_hz[true], basis.damping_ratio[true], basis.kind[true], strict=True):
        found.append(f"{f:.2f}" + ("" if kind == "rigid" or isnan(ratio) else f", {100.0 * ratio:.3g} %"))
    return found
