"""Modes as data set 2414 of universal files, written here: pyuff 2.5 moves the columns of numbers below zero in it.

Source: description of data set 2414, Structural Dynamics Research Laboratory, University of Cincinnati,
https://www.ceas3.uc.edu/sdrluff/.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.files.exchange.uff_codes import DISPLACEMENT
from femstruct.modal.measured.measurement import MeasuredModes

AT_NODES: Final = 1
STRUCTURAL, TRANSLATIONS = 1, 2
NORMAL, COMPLEX = 2, 3  # kinds of analysis
REAL, BOTH = 2, 5  # kinds of values: real, complex, both of single precision


def eigenvalue(frequency_hz: float, ratio: float) -> complex:
    """lambda [1/s] of a mode.

    >>> round(abs(eigenvalue(10.0, 0.05)) / 2 / np.pi, 9)
    10.0
    """
    return 2.0 * np.pi * frequency_hz * complex(-ratio, np.sqrt(max(1.0 - ratio**2, 0.0)))


def result_lines(modes: MeasuredModes, k: int, nodes: Integers) -> list[str]:
    """The lines of data set 2414 for one mode, with its marks. nodes [p] : numbers of its places."""
    frequency, ratio = float(modes.frequency_hz[k]), float(modes.damping_ratio[k])
    shapes = modes.shapes[:, :, k]
    is_complex = np.iscomplexobj(shapes)
    whole = [0.0, frequency, 0.0, 1.0, ratio, 0.0]  # time, frequency, eigenvalue, modal mass, damping
    parts = [0.0] * 6
    if is_complex:
        root = eigenvalue(frequency, ratio)
        whole, parts[:2] = [0.0] * 6, [root.real, root.imag]
    kinds = (STRUCTURAL, COMPLEX if is_complex else NORMAL, TRANSLATIONS, DISPLACEMENT, BOTH if is_complex else REAL, 3)
    values = np.stack([shapes.real, shapes.imag], axis=2).reshape(len(shapes), 6) if is_complex else shapes
    lines = [f"{-1:6d}", f"{2414:6d}", _whole([k + 1]), f"mode {k + 1}", _whole([AT_NODES])]
    lines += [f"mode {k + 1}, {frequency:.6g} Hz, damping ratio {ratio:.4g}", *["NONE"] * 4, _whole(kinds)]
    lines += [_whole([1, 1, 1, 1, 1, k + 1, 0, 0]), _whole([0] * 8), _real(whole), _real(parts)]
    for node, row in zip(nodes.tolist(), values.tolist(), strict=True):
        lines += [_whole([node]), _real(row)]
    return [*lines, f"{-1:6d}"]


def _whole(values: Sequence[int]) -> str:
    return "".join(f"{value:10d}" for value in values)


def _real(values: Sequence[float]) -> str:
    return "".join(f"{value:13.5E}" for value in values)
