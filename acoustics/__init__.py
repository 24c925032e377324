"""Rooms and the sound in them.

The way through this package, each step a pure function or a frozen noun::

    Air, Losses -> Room, ShapedRoom,   what the sound field is, a kind a file    fields
      HalfSpace, Receiver
    SurfaceVelocity                    how surfaces of it move: the only way in  source
    field.pressures(...) ->            sound at receivers, in time; `harmonic`   fields.sound_field
      RoomResponse                       in frequency
    pressure(...), cavity_pressure(...)    the formulas of one kind              rooms, meshed
    Cavity, Wool, cavity_air(...)      air and wool between two surfaces         cavities
    sphere_pressures(...)              the sound of a striking ball itself       open_air.sphere
    sound_levels(...) -> Levels        peaks, maxima, exposures, bands           levels.sound_levels
    heavy_impact_level(...), ...       single numbers of the standards           levels.iso, levels.jis_ks
    rate_room(...) -> RatedRoom        a room as the standards state it          levels.rated
    steady_levels(...), largest_levels(...)  the same by statistical energies    statistical.energies
    radiated_energy(...) -> SoundEnergy    what goes into the open air           open_air.sound_energy
    force_exposure_levels(...)         how hard a source strikes                 levels.exposure

``rooms`` (boxes, by cosines), ``meshed`` (any shape, by finite elements) and ``open_air`` stand beside each other with
their formulas, the kinds of ``fields`` above them, then levels and ratings; `tests/unit/test_layers.py` holds the order
of their modules. Nothing here knows of structures, opens a file or prints.

Harmonic quantities are the real part of X exp(+j omega t). The surface's velocity is positive into the room, where it
raises the pressure. Coordinates are the room's own: from its lower corner, z up, the ceiling at z = Lz.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from acoustics.air import Air
from acoustics.errors import AcousticsError, Advice
from acoustics.losses import (
    Losses,
    losses_from_beta,
    losses_from_loss_factor,
    losses_from_t60,
    losses_from_t60_bands,
    modal_damping_ratio,
    t60_of,
)
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import room_modes
from acoustics.rooms.box_pressure import pressure
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration

if TYPE_CHECKING:
    from acoustics.fields.half_space import HalfSpace
    from acoustics.fields.rectangular import Room
    from acoustics.fields.shaped import ShapedRoom
    from acoustics.fields.sound_field import SoundField, air_stiffness_ratio
    from acoustics.levels.bands import octave_bands, third_octave_bands
    from acoustics.levels.rated import RatedRoom, rate_room
    from acoustics.levels.sound_energy import SoundEnergy, radiated_energy
    from acoustics.levels.sound_levels import (
        Levels,
        equivalent_levels,
        force_exposure_levels,
        level_history,
        level_spectrum,
        response_levels,
        reverberation_time,
        sound_levels,
    )
    from acoustics.levels.standards import (
        HeavyImpactRating,
        ImpactGrade,
        ImpactRating,
        InverseALevel,
        energy_average,
        heavy_impact_level,
        impact_grade,
        inverse_a_level,
        normalised_impact_level,
        standardised_impact_level,
        standardised_maximum_level,
        weighted_impact_level,
    )
    from acoustics.levels.statistical import (
        DiffuseRoom,
        InfinitePlate,
        RadiatingPlate,
        band_exposures,
        diffuse_radiation,
        isotropic_plate,
        largest_levels,
        steady_levels,
    )
    from acoustics.levels.weighting import frequency_weighting, time_weighted, weighted
    from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
    from acoustics.meshed.finite_elements import CavityModes, cavity_modes
    from acoustics.meshed.meshed_pressure import cavity_pressure
    from acoustics.meshed.walls import Wall, YieldingWall, absorbing
    from acoustics.open_air.power import (
        Directivity,
        radiated_power,
        radiation_efficiency,
        radiation_impedance,
        radiation_modes,
        radiation_pattern,
    )
    from acoustics.open_air.sphere import Sphere, sphere_pressures
    from acoustics.rooms.box_harmonic import PressureMap, pressure_map
    from acoustics.rooms.cavities import Cavity, CavityAir, Wool, cavity_air

# What needs scipy.signal, scipy.linalg or scikit-fem is slow to import: it is fetched when first asked for (PEP 562).
_FETCHED = {
    "acoustics.rooms.cavities": (
        "Cavity",
        "CavityAir",
        "cavity_air",
        "Wool",
    ),
    "acoustics.fields.half_space": ("HalfSpace",),
    "acoustics.fields.rectangular": ("Room",),
    "acoustics.fields.shaped": ("ShapedRoom",),
    "acoustics.fields.sound_field": (
        "SoundField",
        "air_stiffness_ratio",
    ),
    "acoustics.meshed.meshed_pressure": ("cavity_pressure",),
    "acoustics.levels.sound_levels": (
        "reverberation_time",
        "force_exposure_levels",
        "Levels",
        "equivalent_levels",
        "level_history",
        "level_spectrum",
        "response_levels",
        "sound_levels",
    ),
    "acoustics.open_air.power": (
        "Directivity",
        "radiation_pattern",
        "radiated_power",
        "radiation_efficiency",
        "radiation_impedance",
        "radiation_modes",
    ),
    "acoustics.meshed.finite_elements": (
        "CavityModes",
        "cavity_modes",
    ),
    "acoustics.levels.standards": (
        "ImpactGrade",
        "InverseALevel",
        "impact_grade",
        "inverse_a_level",
        "HeavyImpactRating",
        "ImpactRating",
        "energy_average",
        "heavy_impact_level",
        "normalised_impact_level",
        "standardised_impact_level",
        "standardised_maximum_level",
        "weighted_impact_level",
    ),
    "acoustics.rooms.box_harmonic": (
        "PressureMap",
        "pressure_map",
    ),
    "acoustics.meshed.cavity_mesh": (
        "CavityMesh",
        "box_mesh",
    ),
    "acoustics.open_air.sphere": (
        "Sphere",
        "sphere_pressures",
    ),
    "acoustics.meshed.walls": (
        "Wall",
        "YieldingWall",
        "absorbing",
    ),
    "acoustics.levels.bands": (
        "octave_bands",
        "third_octave_bands",
    ),
    "acoustics.levels.rated": (
        "RatedRoom",
        "rate_room",
    ),
    "acoustics.levels.sound_energy": (
        "SoundEnergy",
        "radiated_energy",
    ),
    "acoustics.levels.weighting": (
        "frequency_weighting",
        "time_weighted",
        "weighted",
    ),
    "acoustics.levels.statistical": (
        "diffuse_radiation",
        "DiffuseRoom",
        "RadiatingPlate",
        "band_exposures",
        "largest_levels",
        "steady_levels",
        "InfinitePlate",
        "isotropic_plate",
    ),
}

__all__ = [
    "AcousticsError",
    "Advice",
    "Air",
    "Cavity",
    "CavityAir",
    "CavityMesh",
    "CavityModes",
    "DiffuseRoom",
    "Directivity",
    "HalfSpace",
    "HeavyImpactRating",
    "ImpactGrade",
    "ImpactRating",
    "InfinitePlate",
    "InverseALevel",
    "Levels",
    "Losses",
    "PressureMap",
    "RadiatingPlate",
    "RatedRoom",
    "Receiver",
    "Room",
    "RoomResponse",
    "ShapedRoom",
    "SoundEnergy",
    "SoundField",
    "Sphere",
    "SurfaceShapes",
    "SurfaceVelocity",
    "SurfaceVibration",
    "Wall",
    "Wool",
    "YieldingWall",
    "absorbing",
    "air_stiffness_ratio",
    "band_exposures",
    "box_mesh",
    "cavity_air",
    "cavity_modes",
    "cavity_pressure",
    "diffuse_radiation",
    "energy_average",
    "equivalent_levels",
    "force_exposure_levels",
    "frequency_weighting",
    "heavy_impact_level",
    "impact_grade",
    "inverse_a_level",
    "isotropic_plate",
    "largest_levels",
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
    "steady_levels",
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
