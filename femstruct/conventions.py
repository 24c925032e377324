"""Axes, degrees of freedom, signs and references: the one page of signs.

Units are SI everywhere inside; Hz is for people and rad/s for formulas, and the name says which
(``frequency_hz``, ``omega``).

Axes are right-handed and global, z up. The components of a node are, in this order, three translations, three
right-hand rotations and the local twist of a plate, d2w/dxdy in the plate's own axes::

    UX UY UZ RX RY RZ TWIST

These are what joints, supports, probes and pictures see of a node. The degrees of freedom are those of each part, by
names of its own (`OwnDofs` of `femstruct.model.part`): a node may have fewer of them, and a plate that is rigid in
its plane has three for all its nodes together. The twist is known to plates alone.

On a plate with its normal along z, RX = +dw/dy and RY = -dw/dx.

Harmonic quantities are the real part of X exp(+j omega t); a loss factor makes a stiffness K (1 + j eta).
Frequency responses have the axes (response, drive, frequency).

A contact is compressive: its force is positive or zero, and zero when it is open. The indentation ``delta`` of a
contact is positive when closed; ``gap`` = -delta is positive when open. Velocity of a surface is positive into the
room below or above it, where it raises the pressure.

Levels of sound are 20 lg(rms / 20 uPa), of sound power 10 lg(W / 1 pW), of sound energy 10 lg(J / 1 pJ), and the
reference is always printed.
"""

from typing import Final

COMPONENTS: Final = ("UX", "UY", "UZ", "RX", "RY", "RZ", "TWIST")
UX, UY, UZ, RX, RY, RZ, TWIST = range(7)
N_COMPONENTS: Final = 7
DIRECTIONS: Final = ("x", "y", "z", "rx", "ry", "rz")
"""What a point can do, as it is written: the first six components."""

GRAVITY: Final = 9.80665  # m/s^2, the standard acceleration of free fall
