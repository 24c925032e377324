"""How well the bars of a frame carry waves of a frequency: bars to a wavelength, and how many it takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.elements.frame import nodes_per_bar
from femstruct.parts.of_frames.frame_mesh import FrameMesh

LINEAR = 13.0  # bars to a wave where an element errs by (k h)^2 / 24: 1 % of a frequency
CUBIC = 4.0  # where it errs by (k h)^4 / 1440: 0.4 %


@dataclass(frozen=True)
class FrameWave:
    """A kind of wave in a frame: its length [m] at 1 Hz, and the bars a wave needs.

    power : the length falls with this power of the frequency: 1, or 1/2 for bending.
    """

    kind: str
    length_at_1_hz: float
    power: float
    needed: float

    def length(self, frequency_hz: float) -> float:
        """Length of the wave at a frequency [m]."""
        return float(self.length_at_1_hz / frequency_hz**self.power)

    def carried_hz(self, bar: float) -> float:
        """The highest frequency of which bars of a length [m] are short enough [Hz]."""
        return float((self.length_at_1_hz / (self.needed * bar)) ** (1.0 / self.power))


def frame_waves(mesh: FrameMesh) -> tuple[FrameWave, ...]:
    """Bending about the weaker axis, shear, torsion and stretch of a frame; none without mass.

    Notes
    -----
    Bending of a slender bar, with any of the elements, is that of cubic deflections. Bars of two nodes have straight
    lines for stretch and torsion and, for "timoshenko", constant shear strain: of a frequency its share is
    (k_s h)^2 / 24 with the wavenumber of shear waves, k_s^2 = omega^2 rho / k G (measured: `test_frame_waves`). The
    torsional wave of a thin open section is slow: c^2 = G J / rho (I_y + I_z).
    """
    (E, G, section), rho = mesh.part.along, mesh.part.material.rho
    if rho == 0.0:
        return ()
    modulus = E * min(section.Iy, section.Iz)
    bending = float(np.sqrt(2.0 * np.pi) * (modulus / (rho * section.A)) ** 0.25)
    torsion = float(np.sqrt(G * section.J / (rho * (section.Iy + section.Iz))))
    straight = CUBIC if nodes_per_bar(mesh.part.element) == 3 else LINEAR
    waves = [
        FrameWave("bending", bending, 0.5, CUBIC),
        FrameWave("torsional", torsion, 1.0, straight),
        FrameWave("longitudinal", float(np.sqrt(E / rho)), 1.0, straight),
    ]
    if mesh.part.element == "timoshenko":
        shear = float(np.sqrt(min(section.ky, section.kz) * G / rho))
        waves.append(FrameWave("shear", shear, 1.0, LINEAR))
    return tuple(waves)
