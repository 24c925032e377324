"""What measured data need to be computed."""

from __future__ import annotations

from dataclasses import dataclass

from femstruct.study.asked import FrfRequest


@dataclass(frozen=True)
class Needs:
    """What measured data need of a computation: modes up to a frequency [Hz], 0 for none, of which what was measured
    ends at `top_hz`; residual vectors for frequency responses; a run of the study, with rooms or without, and with
    this sampling [Hz] and duration [s] where a history asks for a sampling; else as it is planned."""

    up_to_hz: float = 0.0
    top_hz: float = 0.0
    frfs: tuple[FrfRequest, ...] = ()
    run: bool = False
    rooms: bool = False
    sampling: float = 0.0
    duration: float = 0.0

    def __add__(self, other: Needs) -> Needs:
        return Needs(
            max(self.up_to_hz, other.up_to_hz),
            max(self.top_hz, other.top_hz),
            self.frfs + other.frfs,
            self.run or other.run,
            self.rooms or other.rooms,
            max(self.sampling, other.sampling),
            max(self.duration, other.duration),
        )

    @property
    def timing(self) -> tuple[str, ...]:
        """Changes of the study's window."""
        if not self.sampling:
            return ()
        return (f"time.sampling={self.sampling!r}", f"time.duration={self.duration!r}")
