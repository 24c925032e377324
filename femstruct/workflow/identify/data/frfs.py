"""A measured frequency response: its amplitude by logarithm, and its phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.errors import InputError, some_of
from femstruct.files.exchange.frf_files import read_frf_csv
from femstruct.files.exchange.uff_reading import read_uff
from femstruct.modal.frf import FrfKind, frf, frf_unit
from femstruct.modal.measured.measurement import MeasuredPlace, Measurement
from femstruct.modal.sensitivity.modal_slopes import POWERS, frf_slopes, motions
from femstruct.model.probe import Probe
from femstruct.study.asked import FrfRequest, Spot
from femstruct.study.matched import Beside
from femstruct.workflow.identify.data.datum import Datum
from femstruct.workflow.identify.data.modes import UNIVERSAL
from femstruct.workflow.identify.needs import Needs
from femstruct.workflow.identify.trial import Change, Moded, Trial
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.responses import response_row

USUAL: Final = 0.1  # of every line: mounting, calibration and excitation of usual tests
BEYOND: Final = 2.5  # times the highest line: residual vectors have the rest
NEAR: Final = 1e-3  # of the size of a structure: a node of a universal file that is a point of the model

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class FrfDatum(Datum):
    """Lines [n] of a response: frequency [n] [Hz], above 0, values [n], not 0, scatter [n] as a share of each.

    Notes
    -----
    Residuals are ln(computed / measured) over the scatter, real and imaginary part: the amplitude in Neper and the
    phase in radian. Resonances and the valleys between them weigh alike, and a peak that is beside its place is no huge
    number. For small differences they are those of the complex values as shares of the measured ones.
    """

    request: FrfRequest
    frequency_hz: Floats
    values: Complex
    scatter: Floats

    @property
    def needs(self) -> Needs:
        top = float(self.frequency_hz[-1])
        return Needs(up_to_hz=BEYOND * top, top_hz=top, frfs=(self.request,))

    @property
    def size(self) -> float:
        return float(np.sqrt(2.0 * (1.0 / self.scatter**2).sum()))

    @property
    def tracks(self) -> int:
        return 2

    def residuals(self, trial: Trial) -> Floats:
        computed = self._computed(trial)
        if not computed.all():
            raise InputError("--frf", got=f"'{self.name}', which the model answers with 0", expected="a motion")
        return _both(np.asarray(np.log(computed / self.values) / self.scatter, dtype=np.complex128))

    def slopes(self, trial: Trial, change: Change) -> Floats | None:
        moded, request = _moded(trial), self.request
        drive, response = self._ends(moded)
        if not change.of_damping or request.kind not in POWERS or not isinstance(response, Probe):
            return None
        kind: FrfKind = request.kind  # type: ignore[assignment]  # one of a model: no pressure, no power
        moving = trial.once(f"moving {id(self)}", lambda: motions(moded.damped, drive, response, self.frequency_hz))
        slope = frf_slopes(moving, change.modal, self.frequency_hz, kind)
        return _both(slope / self._computed(trial) / self.scatter)

    def beside(self, trial: Trial) -> Sequence[Beside]:
        unit = frf_unit(self.request.kind, self.request.drive.what, self.request.response.what)  # type: ignore[arg-type]
        scatter, computed = self.scatter * np.abs(self.values), self._computed(trial)
        return (Beside("frf", self.name, unit, self.frequency_hz, self.values, computed, scatter),)

    def _computed(self, trial: Trial) -> Complex:
        found: Complex = trial.once(f"frf {id(self)}", lambda: self._answer(_moded(trial)))
        return found

    def _answer(self, moded: Moded) -> Complex:
        drive, response = self._ends(moded)
        return frf(moded.damped, drive, response, self.frequency_hz, self.request.kind)  # type: ignore[arg-type]

    def _ends(self, moded: Moded) -> tuple[Probe, object]:
        request = self.request
        drive = moded.places.point(request.drive.name, "--frf").probe(request.drive.what)
        return drive, response_row(request.response, moded.places, moded.damped, "--frf")


def read_frfs(
    path: Path, scatter: float | None, places: Places, band: tuple[float, float] | None, length: float
) -> tuple[FrfDatum, ...]:
    """Frequency responses of a table of `femstruct frf --to csv`, or of a universal file (data set 58).

    scatter : of real and imaginary part, as a share of the amplitude of each line. places : of the model, which nodes
    of a universal file are found in by name, else by position. band : what of them is fitted [Hz]; all without it.

    Raises InputError for a file without responses of motion or force, places that the model does not have, and a band
    without lines.
    """
    if path.suffix.lower() in UNIVERSAL:
        measured = read_uff(path, length)
        read: list[tuple[Spot, Spot, FrfKind, Floats, Complex, Floats | None]] = [
            (_spot(one.drive, measured, places), _spot(one.response, measured, places), one.kind, one.frequency_hz,
             one.values, None) for one in measured.frfs if one.kind != "unknown"
        ]  # fmt: skip
        if not read:
            raise InputError(str(path), got="no frequency responses", expected="functions of data set 58")
    else:
        read = [
            (_named(one.drive), _named(one.response), one.kind, one.frequency_hz, one.values, one.scatter)
            for one in read_frf_csv(path)
        ]
    return tuple(_datum(path, *one, scatter, band) for one in read)


def _datum(
    path: Path,
    drive: Spot,
    response: Spot,
    kind: FrfKind,
    frequency: Floats,
    values: Complex,
    column: Floats | None,
    scatter: float | None,
    band: tuple[float, float] | None,
) -> FrfDatum:
    if column is not None and scatter is not None:
        raise InputError("--frf", got=f"'{path}' with a column of its scatter, and +-", expected="one of them")
    low, high = band or (0.0, np.inf)
    kept = (frequency > 0.0) & (frequency >= low) & (frequency <= high) & (values != 0.0)
    if not kept.any():
        raise InputError(
            "--band", got=f"no line of '{path}' from {low:g} to {high:g} Hz", expected="lines other than 0"
        )
    frequency, values = frequency[kept], values[kept]
    share = np.full(len(values), scatter or USUAL) if column is None else column[kept] / np.abs(values)
    name, ends = f"{kind} {response} / {drive}", (float(frequency[0]), float(np.nextafter(frequency[-1], np.inf)))
    step = float(np.median(np.diff(frequency))) if len(frequency) > 1 else 1.0
    request = FrfRequest("", drive, response, kind, ends, step)
    return FrfDatum(name, column is not None or scatter is not None, request, frequency, values, share)


def _named(text: str) -> Spot:
    name, _, what = text.rpartition(".")
    return Spot(name, what)


def _spot(place: MeasuredPlace, measured: Measurement, places: Places) -> Spot:
    """The point of the model at a node of a universal file: by its name, else where it is."""
    if place.name in places.points:
        return Spot(place.name, place.direction)
    at = measured.points[measured.nodes == place.node]
    names = [*places.points]
    points = np.array([places.points[name].position for name in names]).reshape(-1, 3)
    size = float(np.ptp(np.concatenate([points, at]), axis=0).max(initial=0.0))
    apart = np.linalg.norm(points - at[:1], axis=1) if len(at) else np.full(len(names), np.inf)
    if not len(names) or not apart.min(initial=np.inf) <= NEAR * size:
        where = f" at ({', '.join(f'{x:.4g}' for x in at[0])}) m" if len(at) else ""
        do = "give the model a point there, or a name of the file to one"
        got, known = f"'{place}'{where}, which is no point of the model", some_of(names) or "none"
        raise InputError("--frf", got=got, expected=f"one of its points: {known}", do=do)
    return Spot(names[int(apart.argmin())], place.direction)


def _both(values: Complex) -> Floats:
    return np.concatenate([values.real, values.imag])


def _moded(trial: Trial) -> Moded:
    assert trial.modes is not None
    return trial.modes
