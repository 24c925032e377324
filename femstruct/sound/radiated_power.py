"""Sound power of surfaces in the open, and striking bodies as spheres that sound themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from acoustics.air import Air
from acoustics.errors import Advice
from acoustics.levels.sound_energy import (
    SHARE_ALLOWED,
    SoundEnergy,
    bring_to_rest,
    loudest,
    radiated_energy,
    truncate_energy,
)
from acoustics.open_air.power import Directivity, plane_wave_power, radiated_power, radiation_pattern
from acoustics.open_air.rayleigh import POINTS_PER_WAVE, Baffle
from acoustics.open_air.sphere import Sphere
from acoustics.source import combine_surfaces, side_by_side
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.response import Response
from femstruct.impact.scene import Body
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import modal_amplitudes
from femstruct.model.probe import Probe
from femstruct.reported import Reported
from femstruct.sound.placed import Placed
from femstruct.sound.surfaces import surface_velocity
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Sound power of a surface in the open: per force on the structure, and of what was put into it in a record.
# ----------------------------------------------------------------------------------------------------------------------

SHOWN: Final = 3  # frequencies whose directivity is shown where none are asked for
# sound energy over the losses of the structure above which it damps the structure by 5 % in amplitude
LOSSES_ALLOWED: Final = 0.1


@stored_as("power response/1")
@dataclass(frozen=True, eq=False)
class PowerResponse:
    """Sound power [nf] [W/N^2] of a surface over the mean square of a harmonic force, its radiation efficiency [nf],
    the power [nf] [W/N^2] that the force puts in, and directivities at some frequencies."""

    power: Floats
    efficiency: Floats
    put_in: Floats
    pattern: Directivity


@stored_as("radiated sound/1")
@dataclass(frozen=True, eq=False)
class Radiated:
    """What a surface radiated into a half space in a record, and what was given to the structure until its end [J]:
    what it started with, and the work of all that pushed it."""

    energy: SoundEnergy
    given_j: Annotated[float, Reported("J", "Energy given to the structure", "given_to_structure_j")]
    pattern: Directivity

    @property
    def share(self) -> Annotated[float, Reported("1", "Sound energy over the energy given", "share_of_given")]:
        """What of the energy given to the structure became sound [1]; nan where nothing was given."""
        return self.energy.energy_j / self.given_j if self.given_j > 0 else float("nan")


def power_per_force(
    basis: ModalBasis, drive: Probe, room: Placed, frequency_hz: Floats, pattern_hz: Sequence[float] = ()
) -> tuple[PowerResponse, tuple[Advice, ...]]:
    """Sound power of a baffled surface per unit of a harmonic force on the structure, and advice.

    Parameters
    ----------
    room : Placed
        A half space beside its surfaces.
    frequency_hz : Floats [nf]
        Above 0 [Hz].
    pattern_hz : Sequence[float]
        Of the directivity, the loudest frequencies if left out.

    Notes
    -----
    A force of 1 N rms; of its peak value the power is half as much. The air takes nothing from the motion.
    """
    moved, air = side_by_side(room.shapes(basis)), room.room.air
    points, shapes, weights = moved.points, moved.shapes, moved.weights
    moving = 2j * np.pi * frequency_hz * modal_amplitudes(basis, drive, frequency_hz)
    plane = plane_wave_power(weights, shapes, moving, air)
    power = radiated_power(points, weights, shapes, moving, frequency_hz, air)
    shown = np.array(pattern_hz or loudest(frequency_hz, power, SHOWN))
    rates = 2j * np.pi * shown * modal_amplitudes(basis, drive, shown) * np.sqrt(2)
    answer = PowerResponse(
        power=2 * power,
        efficiency=np.divide(power, plane, out=np.full_like(power, np.nan), where=plane > 0),
        put_in=(drive.of(basis.shapes) @ moving).real,
        pattern=radiation_pattern(
            points,
            weights,
            shapes=shapes,
            rates=rates,
            frequency_hz=shown,
            air=air,
            normal=room.first.normal,
            along=room.first.along,
        ),
    )
    return answer, (*_coarse(weights, air, float(frequency_hz.max())), *_beyond(basis, float(frequency_hz.max())))


def radiated_sound(
    response: Response, room: Placed, pattern_hz: Sequence[float] = ()
) -> tuple[Radiated, tuple[Advice | Finding, ...]]:
    """What a surface radiates into a half space while a structure moves as simulated, and reasons to trust it less.

    Parameters
    ----------
    room, pattern_hz : Placed, Sequence[float]
        As of `power_per_force`.
    """
    moving, air = combine_surfaces(surface_velocity(response, room)), room.room.air
    whole = radiated_energy(moving, air)
    energy = truncate_energy(whole, response.basis.complete_below_hz)
    end = response.ledger.end
    shown = np.array(pattern_hz or energy.loudest_hz(SHOWN))
    kernel = moving.dt * np.exp(-2j * np.pi * np.outer(moving.t, shown))
    rates = np.asarray(bring_to_rest(moving.rates) @ kernel, dtype=np.complex128)
    found = Radiated(
        energy,
        end.structure + end.lost_modes,
        radiation_pattern(
            moving.points,
            moving.weights,
            shapes=moving.shapes,
            rates=rates,
            frequency_hz=shown,
            air=air,
            normal=room.first.normal,
            along=room.first.along,
        ),
    )
    return found, (*energy.findings, *_modes_missing(whole, response.basis))


def _coarse(weights: Floats, air: Air, highest_hz: float) -> tuple[Advice, ...]:
    apart = float(np.sqrt(weights.max()))
    wave = air.c / highest_hz
    if wave >= POINTS_PER_WAVE * apart:
        return ()
    return (
        Advice(
            "surface-points-coarse",
            f"the wavelength in air at {highest_hz:.4g} Hz is {wave:.3g} m and the points of the surface are "
            f"{apart:.3g} "
            f"m apart: {wave / apart:.1f} points a wavelength, {POINTS_PER_WAVE:g} are needed. Use a finer mesh",
            {"points_per_wave": wave / apart, "needed": POINTS_PER_WAVE},
        ),
    )


def _beyond(basis: ModalBasis, highest_hz: float) -> tuple[Advice, ...]:
    if highest_hz <= basis.complete_below_hz:
        return ()
    return (
        Advice(
            "power-beyond-modes",
            f"the band ends at {highest_hz:.4g} Hz, the modes at {basis.complete_below_hz:.4g} Hz: the power above is "
            "too low. Use more modes",
            {"highest_hz": highest_hz, "complete_below_hz": basis.complete_below_hz},
        ),
    )


def _modes_missing(energy: SoundEnergy, basis: ModalBasis) -> tuple[Advice, ...]:
    top = basis.complete_below_hz
    share, weighted = (energy.share_above(top, kind) if np.isfinite(top) else 0.0 for kind in ("Z", "A"))
    if max(share, weighted) <= SHARE_ALLOWED:
        return ()
    return (
        Advice(
            "sound-energy-beyond-modes",
            f"{100 * share:.2g} % of the sound energy, A-weighted {100 * weighted:.2g} %, lies above {top:.4g} Hz, "
            "where modes are left out: it is not counted, and bands there are blank. Use more modes",
            {"share": share, "share_a": weighted, "complete_below_hz": top, "allowed": SHARE_ALLOWED},
        ),
    )


def energy_advice(energy_j: float, lost_j: float) -> tuple[Advice, ...]:
    """Advice where the sound energy [J] of all surfaces, which is not taken from the structure, would be felt beside
    what it lost in its own damping [J]."""
    if energy_j <= LOSSES_ALLOWED * lost_j or not lost_j > 0:
        return ()
    ratio = energy_j / lost_j
    return (
        Advice(
            "sound-energy-not-taken",
            f"the sound energy into the open is {ratio:.2g} of the energy that the structure lost in its own "
            f"damping, and is not subtracted from its energy. Above {LOSSES_ALLOWED:g}, motion and sound are too "
            "strong and decay too slowly",
            {"sound_over_losses": ratio, "allowed": LOSSES_ALLOWED},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# The crossing from striking bodies to the air: a body that is pushed becomes a sphere whose own sound is computed.
# ----------------------------------------------------------------------------------------------------------------------

MOVED: Final = 0.1  # radii by which a sphere may move while it is pushed: 1 dB, as the sound goes with its height


def velocity_from_forces(response: Response, name: str) -> Floats:
    """What contacts, links and loads made of a body's velocity since the start [nt] [m/s], along its axis.

    Notes
    -----
    Left out is what makes no sound: the speed it starts with, as if it had always had it; its weight, which is there
    all the time and would add a constant of rho a^3 g / 2 r^2, 60 uPa of a ball of 1 cm a metre away; and the hand that
    gives it its starting state again for the next blow, in the interval of the samples where it does.
    """
    body, t = _body(response, name), response.t
    velocity = response.bodies[name].velocity
    gained = np.diff(velocity)
    blows = np.array([blow.t for blow in response.blows if blow.body == name])
    started = next((plan.first for plan in response.scene.blows if plan.body == name), 0.0)
    if body.falls:
        gained = gained + response.scene.gravity * np.diff(t)
    dt = 1.0 / response.clock.sampling
    handled = t[1:] <= started + 1e-9 * dt
    for blow in blows[blows > 0.0]:
        handled |= (t[:-1] - 1e-9 * dt <= blow) & (blow <= t[1:] + 1e-9 * dt)
    gained[handled] = 0.0
    return np.concatenate([[0.0], np.cumsum(gained)])


def sphere_of(response: Response, name: str, radius: float, place: Floats, space: Baffle) -> Sphere:
    """A body as a sphere in a half space above or below a surface; place [3] of its centre from the space's origin."""
    along = float(space.normal[2]) * velocity_from_forces(response, name)
    return Sphere(radius, place, along, 1.0 / response.clock.sampling)


def moved_advice(response: Response, name: str, radius: float) -> tuple[Advice, ...]:
    """Advice on a sphere that moves far from where it is first pushed, and is pushed there, though it is heard from
    one place."""
    pushed = np.zeros(len(response.t), dtype=bool)
    for contact in response.scene.contacts:
        if name in (contact.upper, contact.lower):
            pushed |= response.contacts[contact.name].force != 0.0
    there = response.bodies[name].displacement[pushed]
    travel = float(np.abs(there - there[:1]).max(initial=0.0))
    if travel <= MOVED * radius:
        return ()
    return (
        Advice(
            "impactor-moves",
            f"{name} moves by {1e3 * travel:.3g} mm during contact, {travel / radius:.2g} of its radius; {MOVED:g} is "
            "allowed. "
            "Its own sound is computed for a sphere at a fixed place: the error may be more than 1 dB",
            {"moved_m": travel, "radius_m": radius, "allowed": MOVED},
        ),
    )


def _body(response: Response, name: str) -> Body:
    return next(body for body in response.scene.bodies if body.name == name)
