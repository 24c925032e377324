"""Histories as sound: scale kept, nothing clipped."""

import json

import numpy as np
import pytest
from scipy.io import wavfile

from femstruct.errors import InputError
from femstruct.files.audio import listening_scale, write_sequence, write_wav


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


def test_a_sequence_holds_every_sound_at_one_scale_where_its_side_car_says(tmp_path):
    rng = np.random.default_rng(0)
    sounds = {name: rng.uniform(-1, 1, length) for name, length in (("as is", 4000), ("damper", 8000), ("screed", 400))}
    write_sequence(tmp_path / "all.wav", sounds, 8000.0, full_scale=2.0)
    rate, samples = wavfile.read(tmp_path / "all.wav")
    told = json.loads((tmp_path / "all.wav.json").read_text(encoding="utf-8"))
    assert told["starts_s"] == {"as is": 0.0, "damper": 1.0, "screed": 2.5}  # half a second between
    assert len(samples) == 4000 + 4000 + 8000 + 4000 + 400
    for name, start in told["starts_s"].items():
        first = round(start * rate)
        # 32-bit floats: 6e-8
        assert samples[first : first + len(sounds[name])] == pytest.approx(sounds[name] / 2.0, rel=1e-6)
    assert not samples[4000:8000].any()


def test_a_sequence_is_not_clipped(tmp_path):
    with pytest.raises(InputError, match="above full scale"):
        write_sequence(tmp_path / "all.wav", {"a": np.ones(10), "b": 3 * np.ones(10)}, 8000.0, full_scale=2.0)
    assert not (tmp_path / "all.wav").exists()


def test_24_bits_for_listening_come_back_to_half_of_the_last(tmp_path):
    p = np.array([0.0, 1.0, -1.0, 0.3, -2e-5])
    scale = listening_scale(1.0)
    write_wav(tmp_path / "a.wav", p, 48000.0, full_scale=scale, form="pcm24")
    rate, samples = wavfile.read(tmp_path / "a.wav")  # scipy puts 24 bits into the upper three bytes of 32
    assert rate == 48000 and samples.dtype == np.int32 and not (samples & 0xFF).any()
    # rounding of the half unit
    assert samples / 256 / (2**23 - 1) * scale == pytest.approx(p, abs=0.5 / (2**23 - 1) * scale * (1 + 1e-9))
    told = json.loads((tmp_path / "a.wav.json").read_text())
    assert told["form"] == "pcm24" and 20 * np.log10(told["full_scale"] / told["peak"]) == pytest.approx(1.0)
