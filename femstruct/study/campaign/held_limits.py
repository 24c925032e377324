"""In how many samples of a campaign a limit is held, exceeded, or cannot be judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nan, sqrt
from typing import Final

import numpy as np

from femstruct.study.campaign.swept import EXCEEDED, MET, Swept, independent, limit_name, verdict_name

SURE: Final = 1.959963984540054  # standard deviations of a 95 % interval


@dataclass(frozen=True)
class HeldLimit:
    """What became of the limit of a number over the samples of a case that are to be trusted.

    limits : the smallest and the largest limit, which are one unless it varies. held, exceeded, unknown : how many
    samples; of the last the run cannot tell, such as of a rating some of whose bands are blank. share : of the samples
    that hold it [1], nan where some are unknown; low, high : its 95 % interval (Wilson) as far as they may be either.
    """

    name: str
    unit: str
    case: str
    limits: tuple[float, float]
    held: int
    exceeded: int
    unknown: int
    share: float
    low: float
    high: float

    @property
    def count(self) -> int:
        """All samples that it is of."""
        return self.held + self.exceeded + self.unknown


def held_limits(rows: Swept, names: Sequence[str]) -> Iterator[HeldLimit]:
    """What became of the limits of these numbers, by number and case; nothing of a case without the limit.

    Every sample is judged as its own run judges it: by the limit of its case and sample, of several places that are
    struck by the worst, and "not at rest in time" is an answer.

    >>> import tempfile
    >>> from pathlib import Path
    >>> import femstruct as fs
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... limits: {m.z velocity: 1.2 m/s}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... vary: {bodies.ball.mass: {values: [0.5 kg, 1 kg, 2 kg]}}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     rows = fs.sweep(fs.read_campaign(Path(place, "hit.study.yaml")), workers=1)
    >>> [(one.held, one.exceeded) for one in held_limits(rows, ["m.z velocity"])]
    [(2, 1)]
    """
    for name in names:
        for case in rows.cases:
            known = rows.trusted(case) & independent(rows)
            verdicts, limits = (rows.told(each(name), case)[known] for each in (verdict_name, limit_name))
            if not np.isfinite(verdicts).any():
                continue
            held, exceeded = (int((verdicts == one).sum()) for one in (MET, EXCEEDED))
            unknown = int(known.sum()) - held - exceeded
            of = held + exceeded + unknown
            yield HeldLimit(
                name=name,
                unit=rows.unit_of(limit_name(name)),
                case=case,
                limits=(float(np.nanmin(limits)), float(np.nanmax(limits))),
                held=held,
                exceeded=exceeded,
                unknown=unknown,
                share=nan if unknown else held / of,
                low=wilson(held, of)[1],
                high=wilson(held + unknown, of)[2],
            )


def wilson(held: int, of: int) -> tuple[float, float, float]:
    """A share and its 95 % interval, which stays within 0 and 1 where all are held.

    References
    ----------
    Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.

    >>> [round(one, 3) for one in wilson(10, 10)]
    [1.0, 0.722, 1.0]
    """
    share, square = held / of, SURE**2 / of
    middle = (share + 0.5 * square) / (1.0 + square)
    half = sqrt(share * (1.0 - share) * square + 0.25 * square**2) / (1.0 + square)
    return share, max(middle - half, 0.0), min(middle + half, 1.0)
