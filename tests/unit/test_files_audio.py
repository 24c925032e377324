"""Histories as sound: scale kept, nothing clipped."""

import json

import numpy as np
import pytest
from scipy.io import wavfile

from femstruct.errors import InputError
from femstruct.files.audio import write_wav


def test_pressure_comes_back_through_the_scale(tmp_path):
    path = tmp_path / "mic.wav"
    p = 3.0 * np.sin(np.arange(4800) / 7)
    write_wav(path, p, 48000.0, full_scale=4.0)
    rate, samples = wavfile.read(path)
    scale = json.loads((tmp_path / "mic.wav.json").read_text())
    assert rate == 48000 and samples.dtype == np.float32
    assert scale["unit"] == "Pa" and scale["peak"] == np.abs(p).max()
    # single precision: half a unit in the last of 24 bits, of full scale
    np.testing.assert_allclose(samples * scale["full_scale"], p, atol=4.0 * 2**-24)


@pytest.mark.parametrize(
    ("values", "sampling", "full_scale", "told"),
    [
        ([0.0, 2.0], 48000.0, 1.0, "above full scale"),
        ([0.0, np.nan], 48000.0, 1.0, "not finite"),
        ([], 48000.0, 1.0, "no samples"),
        ([0.5], 48000.4, 1.0, "whole number of hertz"),
        ([0.5], 48000.0, 0.0, "positive"),
    ],
)
def test_what_would_sound_wrong_is_refused_and_not_written(tmp_path, values, sampling, full_scale, told):
    with pytest.raises(InputError, match=told):
        write_wav(tmp_path / "a.wav", values, sampling, full_scale=full_scale)
    assert list(tmp_path.iterdir()) == []
