"""The room and what is heard in it.

The way through this wing, each step a pure function or a frozen noun::

    Air, Losses -> Room, Receiver      what the room is                          air, room
    SurfaceVelocity                    how its ceiling moves: the one door in    source
    pressure(...) -> RoomResponse      what is heard, in time and frequency      pressure (transfer functions: cavity)
    cavity_pressure(...)               the same in rooms of any shape            cavity_pressure (fem, walls, together)
    sphere_pressures(...)              the sound of a striking ball itself       sphere (field, multipoles)
    sound_levels(...) -> Levels        peaks, maxima, exposures, bands           levels (bands, weighting)
    heavy_impact_level(...), ...       single numbers of the standards           ratings grades
    rate_room(...) -> RatedRoom        a room as the standards state it          rated
    radiated_energy(...) -> SoundEnergy    what goes into the open air           sound_energy (radiation, directivity)
    force_exposure_levels(...)         how hard a source strikes                 exposure

Layers, lowest first: ``errors arrays air room source walls | extension cavity meshes fem yielding shaped | orders
judgement absorption together pressure transfers cavity_pressure maps harmonic coupled coupled_fem field multipoles
sphere sheet radiation directivity | bands ending filters weighting levels ratings grades decay exposure methods
rated sound_energy``; a module imports from lower ones only. Nothing here knows of finite elements, opens a file or
prints.

Harmonic quantities are the real part of X exp(+j omega t). The surface's velocity is positive into the room, where it
raises the pressure. Coordinates are the room's own: from its lower corner, z up, the ceiling at z = Lz.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from acoustics.air import Air
from acoustics.errors import AcousticsError, Advice
from acoustics.pressure import RoomResponse, pressure
from acoustics.room import (
    Losses,
    Receiver,
    Room,
    air_stiffness_ratio,
    losses_from_beta,
    losses_from_loss_factor,
    losses_from_t60,
    losses_from_t60_bands,
    modal_damping_ratio,
    room_modes,
    t60_of,
)
from acoustics.source import SurfaceVelocity

if TYPE_CHECKING:
    from acoustics.bands import octave_bands, third_octave_bands
    from acoustics.cavity_pressure import cavity_pressure
    from acoustics.decay import reverberation_time
    from acoustics.directivity import Directivity, radiation_pattern
    from acoustics.exposure import force_exposure_levels
    from acoustics.fem import CavityModes, cavity_modes
    from acoustics.field import HalfSpace
    from acoustics.grades import ImpactGrade, InverseALevel, impact_grade, inverse_a_level
    from acoustics.levels import Levels, equivalent_levels, level_history, level_spectrum, response_levels, sound_levels
    from acoustics.maps import PressureMap, pressure_map
    from acoustics.meshes import CavityMesh, box_mesh
    from acoustics.radiation import radiated_power, radiation_efficiency, radiation_impedance, radiation_modes
    from acoustics.rated import RatedRoom, rate_room
    from acoustics.ratings import (
        HeavyImpactRating,
        ImpactRating,
        energy_average,
        heavy_impact_level,
        normalised_impact_level,
        standardised_impact_level,
        standardised_maximum_level,
        weighted_impact_level,
    )
    from acoustics.shaped import ShapedRoom
    from acoustics.sound_energy import SoundEnergy, radiated_energy
    from acoustics.sphere import Sphere, sphere_pressures
    from acoustics.walls import Wall, YieldingWall, absorbing
    from acoustics.weighting import frequency_weighting, time_weighted, weighted

# What needs scipy.signal, scipy.linalg or scikit-fem is slow to import: it is fetched when first asked for (PEP 562).
_FETCHED = {
    "acoustics.cavity_pressure": ("cavity_pressure",),
    "acoustics.decay": ("reverberation_time",),
    "acoustics.directivity": ("Directivity", "radiation_pattern"),
    "acoustics.exposure": ("force_exposure_levels",),
    "acoustics.fem": ("CavityModes", "cavity_modes"),
    "acoustics.field": ("HalfSpace",),
    "acoustics.grades": ("ImpactGrade", "InverseALevel", "impact_grade", "inverse_a_level"),
    "acoustics.radiation": ("radiated_power", "radiation_efficiency", "radiation_impedance", "radiation_modes"),
    "acoustics.maps": ("PressureMap", "pressure_map"),
    "acoustics.meshes": ("CavityMesh", "box_mesh"),
    "acoustics.shaped": ("ShapedRoom",),
    "acoustics.sphere": ("Sphere", "sphere_pressures"),
    "acoustics.walls": ("Wall", "YieldingWall", "absorbing"),
    "acoustics.bands": ("octave_bands", "third_octave_bands"),
    "acoustics.levels": (
        "Levels",
        "equivalent_levels",
        "level_history",
        "level_spectrum",
        "response_levels",
        "sound_levels",
    ),
    "acoustics.rated": ("RatedRoom", "rate_room"),
    "acoustics.ratings": (
        "HeavyImpactRating",
        "ImpactRating",
        "energy_average",
        "heavy_impact_level",
        "normalised_impact_level",
        "standardised_impact_level",
        "standardised_maximum_level",
        "weighted_impact_level",
    ),
    "acoustics.sound_energy": ("SoundEnergy", "radiated_energy"),
    "acoustics.weighting": ("frequency_weighting", "time_weighted", "weighted"),
}

__all__ = [
    "AcousticsError",
    "Advice",
    "Air",
    "CavityMesh",
    "CavityModes",
    "Directivity",
    "HalfSpace",
    "HeavyImpactRating",
    "ImpactGrade",
    "ImpactRating",
    "InverseALevel",
    "Levels",
    "Losses",
    "PressureMap",
    "RatedRoom",
    "Receiver",
    "Room",
    "RoomResponse",
    "ShapedRoom",
    "SoundEnergy",
    "Sphere",
    "SurfaceVelocity",
    "Wall",
    "YieldingWall",
    "absorbing",
    "air_stiffness_ratio",
    "box_mesh",
    "cavity_modes",
    "cavity_pressure",
    "energy_average",
    "equivalent_levels",
    "force_exposure_levels",
    "frequency_weighting",
    "heavy_impact_level",
    "impact_grade",
    "inverse_a_level",
    "level_history",
    "level_spectrum",
    "losses_from_beta",
    "losses_from_loss_factor",
    "losses_from_t60",
    "losses_from_t60_bands",
    "modal_damping_ratio",
    "normalised_impact_level",
    "octave_bands",
    "pressure",
    "pressure_map",
    "radiated_energy",
    "radiated_power",
    "radiation_efficiency",
    "radiation_impedance",
    "radiation_modes",
    "radiation_pattern",
    "rate_room",
    "response_levels",
    "reverberation_time",
    "room_modes",
    "sound_levels",
    "sphere_pressures",
    "standardised_impact_level",
    "standardised_maximum_level",
    "t60_of",
    "third_octave_bands",
    "time_weighted",
    "weighted",
    "weighted_impact_level",
]


def __getattr__(name: str) -> Any:
    for home, names in _FETCHED.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
