"""What is not computed, as it is likely to be written: each key with what to write instead, for `Spec.instead`."""

from __future__ import annotations

from typing import Final

GROUND: Final = "ground."  # begins addresses of what does not move
Instead = tuple[tuple[str, str, str], ...]

BASE_IN_TIME: Final = (
    "motion of the base in time is not computed: in place of the ground take a block of 1000 times the mass, and push "
    "it with its mass times the acceleration, 'loads: {shock: {at: POINT.z, file: F}}'; steady motion of the base is "
    "'vibration: {NAME: {base: z, ..}}'"
)
FALLING_PARTS: Final = (
    "parts do not fall: start the structure with its speed when it strikes, of 1 m "
    "'initial: {rigid: {about: POINT, velocity: [0, 0, -4.43 m/s]}}', and contacts to the ground; or write a rigid "
    "part as a body, 'bodies: {NAME: {mass: 10 kg, above: ground, drop_height: 1 m}}'"
)


def instead_of(do: str, *keys: str) -> Instead:
    """Keys that are unknown where they are written, all with the same answer.

    >>> instead_of("write b", "a", "c")
    (('a', '', 'write b'), ('c', '', 'write b'))
    """
    return tuple((key, "", do) for key in keys)
