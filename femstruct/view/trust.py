"""How far the numbers of a case may be off, a line each: what more modes change, and what the steps leave."""

from __future__ import annotations

from femstruct.study.result import AccuracyCheck


def accuracy(check: AccuracyCheck) -> str:
    """What more modes still change, and which are used."""
    if check.worst is None:
        return "accuracy: the basis holds every mode there is"
    name, worst = check.worst
    return (
        f"accuracy: {name} {worst.smaller:.4g} / {worst.larger:.4g} {worst.unit} with the modes up to "
        f"{check.smaller_hz:.5g} / {check.larger_hz:.5g} Hz, at most {100 * worst.share:.2g} % apart in "
        f"{check.band[0]:g} to {check.band[1]:g} Hz until {1e3 * check.window:.4g} ms; {100 * check.within:g} % asked; "
        f"used: {check.used_modes} modes up to {check.used_hz:.5g} Hz"
    )
