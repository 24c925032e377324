"""Histories as sound files."""

from __future__ import annotations

import json
import wave
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.io import wavfile

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.files.writing import replacing

PAUSE: Final = 0.5  # s of silence between two sounds of a sequence
HEADROOM_DB: Final = 1.0  # that a sound for listening stays below full scale: players that resample overshoot a little
_FULL_24: Final = 2**23 - 1


def write_wav(
    path: str | Path,
    values: ArrayLike,
    sampling: float,
    *,
    full_scale: float,
    unit: str = "Pa",
    starts: Mapping[str, float] | None = None,
    form: Literal["float32", "pcm24"] = "float32",
) -> None:
    """A history as WAV, with a side-car PATH.json that says what full scale means.

    values [nt] in `unit`; sampling [Hz], rounded to whole hertz by the format and refused when that changes it.

    Parameters
    ----------
    full_scale : float
        The value that becomes 1.0. Use one for all files that are to be compared by ear.
    starts : Mapping[str, float] | None
        When each of several sounds begins [s], by name, kept beside the scale.
    form : Literal['float32', 'pcm24']
        32-bit float, which keeps what was computed, or 24-bit integers, which every player knows.

    Raises
    ------
    InputError
        When a value exceeds full scale (players would clip it), or is not finite, or the sampling is not a whole number
        of hertz. The side-car is written first: a sound is never there without its scale.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_wav(Path(folder, "a.wav"), [0.0, 0.5, -1.0], 48000.0, full_scale=2.0)
    ...     wavfile.read(Path(folder, "a.wav"))
    (48000, array([ 0.  ,  0.25, -0.5 ], dtype=float32))
    """
    path = Path(path)
    samples = np.asarray(values, dtype=np.float64)
    if samples.ndim != 1 or not len(samples) or not np.isfinite(samples).all():
        raise InputError(str(path), got="no samples, or some not finite", expected="one row of finite samples")
    if not full_scale > 0:
        raise InputError(f"{path} full_scale", got=f"{full_scale:g} {unit}", expected="a positive value")
    peak = float(np.abs(samples).max())
    if peak > full_scale:
        raise InputError(
            str(path),
            got=f"a peak of {peak:g} {unit} above full scale, {full_scale:g} {unit}",
            expected="a full scale no smaller than the peak",
            do="raise full_scale: a clipped sound is another sound",
        )
    rate = round(sampling)
    if not rate > 0 or abs(rate - sampling) > 1e-9 * sampling:
        raise InputError(f"{path} sampling", got=f"{sampling:g} Hz", expected="a whole number of hertz, as WAV stores")
    scale: dict[str, Any] = {"unit": unit, "full_scale": full_scale, "peak": peak, "sampling_hz": rate, "form": form}
    if starts is not None:
        scale["starts_s"] = dict(starts)
    with replacing(path.with_name(path.name + ".json")) as temporary:
        temporary.write_text(json.dumps(scale, indent=2) + "\n", encoding="utf-8")
    with replacing(path) as temporary:
        if form == "float32":
            wavfile.write(temporary, rate, (samples / full_scale).astype(np.float32))
        else:
            _write_pcm24(temporary, rate, samples / full_scale)


def listening_scale(loudest: float) -> float:
    """Full scale [of the same unit] of a sound for listening whose largest value is `loudest`.

    >>> round(listening_scale(1.0), 4)
    1.122
    """
    return float(loudest * 10.0 ** (HEADROOM_DB / 20.0))


def write_sequence(
    path: str | Path,
    sounds: Mapping[str, Floats],
    sampling: float,
    *,
    full_scale: float,
    unit: str = "Pa",
    form: Literal["float32", "pcm24"] = "float32",
) -> None:
    """Sounds one after the other at one scale, silence of half a second between, to be compared by ear: A, B, ...

    Parameters
    ----------
    sounds : Mapping[str, Floats]
        Histories [nt] in `unit` by name; when each begins is in the side-car. Otherwise as `write_wav`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     both = {"light": np.ones(800), "heavy": np.ones(800)}
    ...     write_sequence(Path(folder, "ab.wav"), both, 8000.0, full_scale=2.0)
    ...     json.loads(Path(folder, "ab.wav.json").read_text(encoding="utf-8"))["starts_s"]
    {'light': 0.0, 'heavy': 0.6}
    """
    silence = np.zeros(round(PAUSE * sampling))
    pieces: list[Floats] = []
    starts: dict[str, float] = {}
    length = 0
    for name, values in sounds.items():
        if pieces:
            pieces.append(silence)
            length += len(silence)
        starts[name] = length / sampling
        pieces.append(values)
        length += len(values)
    write_wav(path, np.concatenate(pieces), sampling, full_scale=full_scale, unit=unit, starts=starts, form=form)


def _write_pcm24(path: Path, rate: int, values: Floats) -> None:
    """Values within -1 to 1 as integers of three bytes."""
    integers = np.round(values * _FULL_24).astype("<i4")
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 3, rate, len(integers), "NONE", "not compressed"))
        file.writeframes(integers.view(np.uint8).reshape(-1, 4)[:, :3].tobytes())
