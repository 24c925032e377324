"""The table of natural frequencies and damping ratios, structure beside structure."""

from __future__ import annotations

from typing import Final

from femstruct.modal.basis import ModalBasis
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid

MOST: Final = 20  # modes of a structure; all are in results.h5


def natural_frequencies(result: StudyResult) -> Grid:
    """The first modes of every structure: frequency [Hz] and damping ratio, a column for the cases that share it."""
    alike: dict[tuple[str, bytes], list[str]] = {}
    for name, case in result.cases.items():
        alike.setdefault((case.basis_key, case.basis.damping_ratio.tobytes()), []).append(name)
    bases = {", ".join(names): result.cases[names[0]].basis for names in alike.values()}
    counts = [len(basis.omega[basis.modes]) for basis in bases.values()]
    longest = max(counts, default=0)
    more = f" (the first {MOST} of at most {longest} modes)" if longest > MOST else ""
    grid = Grid(f"natural frequencies [Hz], damping ratios{more}", ("mode", *bases))
    for mode in range(min(MOST, longest)):
        grid.add(str(mode + 1), *(_mode(basis, mode) for basis in bases.values()))
    return grid


def _mode(basis: ModalBasis, mode: int) -> str:
    if mode >= len(basis.omega[basis.modes]):
        return "-"
    ratio = "" if basis.kind[mode] == "rigid" else f", {100.0 * basis.damping_ratio[mode]:.3g} %"
    return f"{basis.frequency_hz[mode]:.2f}{ratio}"
