"""The pictures of a study by kind: what each shows is told by the first words of its file's name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, NamedTuple

MODEL: Final = "model"
RATED: Final = "rated"
RESPONSE: Final = "frf"


class Kind(NamedTuple):
    """Pictures of one kind: how their file names begin, the heading over them, what one is called."""

    begins: str
    heading: str
    one: str


KINDS: Final = (
    Kind(MODEL, "Model", "Model"),
    Kind(RATED, "Rated bands", "Rated bands"),
    Kind("level", "Levels over time", "Levels over time"),
    Kind("own_sound", "Sound of the striking bodies", "Sound of the striking bodies"),
    Kind(RESPONSE, "Frequency responses", "Frequency response"),
    Kind("shock_spectrum", "Shock response spectra", "Shock response spectrum"),
    Kind("fatigue", "Ranges of fatigue", "Ranges of fatigue"),
    Kind("vibration", "Answers to excitations", "Answer to an excitation"),
    Kind("mode_shapes", "Mode shapes", "Mode shapes"),
    Kind("stress", "Largest stresses", "Largest stress"),
    Kind("history", "Histories", "History"),
    Kind("contact_forces", "Contact forces", "Contact forces"),
    Kind("bodies", "Motion of the bodies", "Motion of the bodies"),
    Kind("energy", "Energy", "Energy"),
    Kind("spectrum", "Spectra", "Spectrum"),
    Kind("sound_energy", "Sound energy", "Sound energy"),
    Kind("directivity", "Directivity", "Directivity"),
    Kind("sound", "Sound pressure", "Sound pressure"),
    Kind("pressure_map", "Pressure maps", "Pressure map"),
    Kind("pressure_surfaces", "Surfaces of equal pressure", "Surfaces of equal pressure"),
    Kind("animation", "Animations", "Animation"),
)
OTHER: Final = Kind("", "Other pictures", "Picture")


def kind_of(name: str) -> Kind:
    """The kind of a picture by its file name.

    >>> kind_of("sound_energy_air.png").heading, kind_of("sound_box.mic.png").heading, kind_of("a.png").heading
    ('Sound energy', 'Sound pressure', 'Other pictures')
    """
    stem = name.rpartition(".")[0]
    fitting = (kind for kind in KINDS if stem == kind.begins or stem.startswith(f"{kind.begins}_"))
    return max(fitting, key=lambda kind: len(kind.begins), default=OTHER)


def told(name: str) -> str:
    """What a picture shows, for who cannot see it.

    >>> told("frf_slab_centre.png"), told("energy.png")
    ('Frequency response: slab_centre', 'Energy')
    """
    kind = kind_of(name)
    rest = name.rpartition(".")[0].removeprefix(kind.begins).strip("_")
    return f"{kind.one}: {rest}" if rest else kind.one


def by_kind(names: Iterable[str]) -> dict[Kind, list[str]]:
    """Names of pictures by kind, the kinds in their order on the page."""
    kinds: dict[Kind, list[str]] = {kind: [] for kind in (*KINDS, OTHER)}
    for name in names:
        kinds[kind_of(name)].append(name)
    return {kind: found for kind, found in kinds.items() if found}
