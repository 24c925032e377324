"""Frequency responses of several responses to several drives, as a test with a hammer and a set of sensors has them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from femstruct.arrays import Floats, frozen
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.frf import A_PROBE, FrfKind, frf, frf_unit, modal_amplitudes, moves
from femstruct.model.probe import Probe


@dataclass(frozen=True, eq=False)
class FrfTable:
    """Frequency responses, many by many.

    frequency_hz [nf] : [Hz]. drives [nd], responses [nr] : their names, POINT.direction or NAME.force. kinds [nr] :
    what each response is. values [nr, nd, nf] : complex. title : of the structure.

    Raises FemstructError for arrays that do not fit each other.

    >>> kinds = ("mobility", "transmissibility")
    >>> table = FrfTable([1.0, 2.0], ("a.z",), ("b.z", "ground.force"), kinds, np.ones((2, 1, 2)))
    >>> table.unit(0, 0), table.unit(1, 0), table.name(1, 0)
    ('m/(N s)', '1', 'transmissibility ground.force / a.z')
    """

    frequency_hz: Floats
    drives: tuple[str, ...]
    responses: tuple[str, ...]
    kinds: tuple[FrfKind, ...]
    values: NDArray[np.complex128]
    title: str = ""

    def __post_init__(self) -> None:
        frequency = frozen("FrfTable frequency_hz", self.frequency_hz, (None,))
        values = np.array(self.values, dtype=np.complex128)
        expected = (len(self.responses), len(self.drives), len(frequency))
        if values.shape != expected or len(self.kinds) != len(self.responses):
            raise FemstructError("FrfTable values", got=f"shape {values.shape}", expected=f"shape {expected}")
        values.flags.writeable = False
        object.__setattr__(self, "frequency_hz", frequency)
        object.__setattr__(self, "values", values)

    def unit(self, response: int, drive: int) -> str:
        """Unit of one response to one drive, by their places."""
        directions = (name.rpartition(".")[2] for name in (self.drives[drive], self.responses[response]))
        return frf_unit(self.kinds[response], *directions)

    def name(self, response: int, drive: int) -> str:
        """What one of them is, without its unit."""
        return f"{self.kinds[response]} {self.responses[response]} / {self.drives[drive]}"


def frf_table(
    basis: ModalBasis,
    drives: Mapping[str, Probe],
    responses: Mapping[str, Probe | ForceRow],
    frequency_hz: ArrayLike,
    kind: FrfKind | None = None,
    title: str = "",
) -> FrfTable:
    """Frequency responses of all responses to harmonic unit forces at all drives, by superposition of modes.

    drives, responses : by name, POINT.direction or NAME.force. kind : as for `frf`; None for accelerance of places and
    transmissibility of forces.

    Raises InputError as `frf`: a direction without motion, zero frequency of a free structure, a kind that is none.

    Notes
    -----
    Modal amplitudes are computed once for every drive. Residual vectors are wanted for the probes on both sides.

    >>> from femstruct import oscillator
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> here = points["m"].probe("x")
    >>> table = frf_table(basis, {"m.x": here}, {"m.x": here}, [0.0], "receptance")
    >>> float(table.values[0, 0, 0].real.round(12)), table.unit(0, 0)
    (0.02, 'm/N')
    """
    expect("frf basis", basis, ModalBasis, "modal_basis makes one of an Assembly")
    expect("frf drives", drives, Mapping[str, Probe], A_PROBE)
    expect("frf responses", responses, Mapping[str, Probe | ForceRow], A_PROBE)
    frequency = frozen("frf frequency", np.atleast_1d(np.asarray(frequency_hz)), (None,))
    kinds: list[FrfKind] = [
        kind or ("accelerance" if isinstance(one, Probe) else "transmissibility") for one in responses.values()
    ]
    for name, one in (*drives.items(), *responses.items()):
        if isinstance(one, Probe) and not moves(basis, one):
            raise InputError(f"frf {name}", got="a direction without motion in any mode", expected="one with motion")
    values = np.empty((len(responses), len(drives), len(frequency)), dtype=np.complex128)
    for j, drive in enumerate(drives.values()):
        amplitudes = modal_amplitudes(basis, drive, frequency)
        for i, response in enumerate(responses.values()):
            if isinstance(response, Probe) and kinds[i] in _POWERS:
                rate = (2j * np.pi * frequency) ** _POWERS[kinds[i]]
                values[i, j] = rate * (response.of(basis.shapes) @ amplitudes)
            else:
                values[i, j] = frf(basis, drive, response, frequency, kinds[i])
    return FrfTable(frequency, tuple(drives), tuple(responses), tuple(kinds), values, title)


_POWERS: Mapping[str, int] = {"receptance": 0, "mobility": 1, "accelerance": 2}  # of j omega
