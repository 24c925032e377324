"""What can be wrong in measured data and in what is asked of them, in one line each with its place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import FemstructError
from femstruct.files.measured_frequencies import read_frequencies
from femstruct.workflow.identify import identify
from femstruct.workflow.measured_data import MeasuredFiles
from femstruct.workflow.trial import parameters_of

FLOOR = Path(__file__).parents[1] / "data" / "floor_to_fit.yaml"
DROP = Path(__file__).parents[2] / "models" / "tennis_ball_drop.study.yaml"
CONCRETE = "materials.concrete.E=26 GPa"
RESPONSE = "accelerance Q.z / P.z [m/(N s^2)]"


def refused(folder: Path, text: str, expected: str, option: str = "modes", scatter: str = "", **more: str) -> None:
    """`text` as the file m.csv of an option is refused."""
    file = folder / "m.csv"
    file.write_text(text, encoding="utf-8")
    named = {option: (f"{file}{scatter}",), **more}
    with pytest.raises(FemstructError, match=expected) as error:
        identify(FLOOR, MeasuredFiles(**named), parameters=(CONCRETE,))  # type: ignore[arg-type]
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", r"m\.csv:1:1: got an empty table"),
        ("mode, frequency [Hz]\n", r"m\.csv:1:1: got no numbers"),
        ("3, 11.9\n5, 25.4\n", r"m\.csv:1:1: got 2 columns without heads, expected a line of heads"),
        ("mode, colour\n3, red\n", r"m\.csv:1:1: got 'mode, colour', expected a line of heads"),
        ("mode, frequency [Hz]\n3, soft\n", r"m\.csv:2:1: got 'soft', expected a number"),
        ("mode, frequency [Hz]\n3\n", r"m\.csv:2:1: got no value, expected a number"),
        ("mode, frequency [Hz]\n3, 11.9\n0, 25.4\n", r"m\.csv:3:1: got mode 0, expected a mode number from 1"),
        ("mode, frequency [Hz]\n3, 11.9\n3, 25.4\n", r"m\.csv:3:1: got a mode number twice"),
        ("mode, frequency [Hz]\n30, 11.9\n", r"--modes: got \d+ modes of the model up to 17\.85 Hz, expected mode 30"),
        ("frequency [Hz]\n-11.9\n", r"m\.csv:2:1: got a frequency of -11\.9 Hz, expected one above 0"),
        ("frequency [Hz], scatter [%]\n11.9, 0\n", r"m\.csv:2:1: got a scatter of 0 Hz, expected one above 0"),
        ("frequency [kg]\n11.9\n", r"m\.csv:1:1: got 'kg', expected a frequency"),
        ("29,35\n63,40\n", r"m\.csv:1:1: got 2 columns without heads, .*; if 29,35 is a decimal, put a line"),
        ("frequency [Hz], mode\n11,9,3\n", r"m\.csv:2:1: got 3 cells below 2 heads, .* by semicolons"),
        ("frequency\n11,9,3\n", r"m\.csv:2:1: got 3 cells below 1 head, expected one below each; where decimals"),
        ("frequency\n11,9\n25.4\n", r"m\.csv:3:1: got '25\.4' in a table whose decimals have a comma"),
        ("frequency\n1.211,9\n", r"m\.csv:2:1: got 2 cells below 1 head"),
    ],
)
def test_tables_of_frequencies(text: str, expected: str, tmp_path: Path) -> None:
    refused(tmp_path, text, expected)


@pytest.mark.parametrize(
    "text",
    [
        "frequency\n29,35\n63,40\n82,95\n",
        "frequency [Hz]\n29,35\n63,4\n82,95",
        "f\n29.35\n63.40\n82.95\n",
        "29.35\n63.40\n82.95\n",
        'frequency\n"29,35"\n"63,40"\n"82,95"\n',
        "frequency [Hz];mode\n29,35;1\n63,40;2\n82,95;3\n",
        "frequency [Hz]\tmode\n29,35\t1\n63,40\t2\n82,95\t3\n",
        "frequency [Hz],mode\n29.35,1\n63.4,2\n82.95,3\n",
        "frequency [kHz]\n0,02935\n0,0634\n0,08295\n",
    ],
)
def test_decimal_commas_of_frequencies_lose_nothing(text: str, tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text(text, encoding="utf-8")
    assert read_frequencies(tmp_path / "m.csv").frequency_hz == pytest.approx([29.35, 63.4, 82.95], rel=1e-14)  # kHz


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("frequency_hz\n", r"m\.csv:1:1: got 1 lines, expected 'frequency_hz' and pairs of columns"),
        ("f, speed\n10, 1\n", r"m\.csv:1:1: got 'speed', expected 'frequency_hz' and pairs"),
        (
            f"f,{RESPONSE} real,{RESPONSE} imag,{RESPONSE} real\n10,1,2,3\n",
            r"m\.csv:1:1: got two columns '.* real', expected one of each name",
        ),
        (f"f,{RESPONSE} real\n10,1\n", r"m\.csv:1:1: got 'accelerance Q\.z / P\.z' without its real or imag column"),
        ("f,mobility Q.z / P.z [g] real\n10,1\n", r"m\.csv:1:1: got a mobility in 'g', expected one in m/\(N s\)"),
        (
            f"f,{RESPONSE} real,{RESPONSE} imag\n10,5,1,0,2,0\n",
            r"m\.csv:2:1: got 6 numbers, expected 3, one below each",
        ),
        (f"f,{RESPONSE} real,{RESPONSE} imag\n10,1\n", r"m\.csv:2:1: got 2 numbers, expected 3"),
        (f"f,{RESPONSE} real,{RESPONSE} imag\n10,1,1\n9,1,1\n", r"m\.csv:3:1: got 9 Hz, expected a frequency above 10"),
        (
            f"f,{RESPONSE} real,{RESPONSE} imag,{RESPONSE} scatter\n10,1,1,0\n",
            r"m\.csv:2:1: got a scatter of 0 or less, expected one above 0",
        ),
        (f"f,{RESPONSE} real,{RESPONSE} imag\n10,0,0\n", r"--band: got no line of '.*m\.csv' from 0 to inf Hz"),
        (f"f,{RESPONSE.replace('Q.z', 'R.z')} real,{RESPONSE.replace('Q.z', 'R.z')} imag\n10,1,1\n", "--frf: got 'R'"),
    ],
)
def test_tables_of_responses(text: str, expected: str, tmp_path: Path) -> None:
    refused(tmp_path, text, expected, "frfs")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", r"--levels: got '.*m\.csv' with columns without heads, expected a column hall\.mic, hall"),
        (
            "Hz,attic.mic\n63,50\n",
            r"--levels: got '.*m\.csv' with columns attic\.mic, expected a column hall\.mic",
        ),
        ("Hz,hall.mic,hall.mic bands_db\n63,50,51\n", r"m\.csv:1:1: got two columns of hall\.mic, expected one"),
        ("Hz,soft: hall.mic bands_db\n63,50\n", "of the case 'as given', which is fitted"),
        ("Hz,hall.mic\n60,50\n", r"m\.csv:2:1: got a band of '60', expected a nominal octave or third octave"),
        ("Hz,hall.mic\n63,50\n63,51\n", r"m\.csv:3:1: got '63', expected a third octave or octave, .* each once"),
        ("Hz,hall.mic\n63,50,5\n", r"m\.csv:2:1: got 3 cells below 2 heads, .* by semicolons"),
        ("Hz,hall.mic\n63,loud\n", r"m\.csv:2:1: got 'loud', expected a level in dB, or nothing"),
        ("Hz,hall.mic\n63,\n", r"m\.csv:1:1: got no level below 'hall\.mic', expected one or more"),
        ("Hz,hall.mic\n8000,30\n", r"--levels: got bands that the study does not compute: 8000 Hz"),
    ],
)
def test_tables_of_levels(text: str, expected: str, tmp_path: Path) -> None:
    study = f"""
        model: {FLOOR.name}
        modes: {{up_to: 100 Hz}}
        bodies: {{ball: {{mass: 2 kg, above: P, speed: 4 m/s, contact: {{type: linear, stiffness: 60 kN/m}}}}}}
        time: {{duration: 0.1 s, sampling: 2 kHz}}
        rooms: {{hall: {{size: [4, 3, 2], under: ceiling, losses: {{t60: 1 s}}, receivers: {{mic: [1.2, 1, 1.2]}}}}}}
    """
    (tmp_path / FLOOR.name).write_text(FLOOR.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "drop.study.yaml").write_text(study, encoding="utf-8")
    (tmp_path / "m.csv").write_text(text, encoding="utf-8")
    files = MeasuredFiles(levels=(f"{tmp_path / 'm.csv'} +- 1 dB",))
    with pytest.raises(FemstructError, match=expected):
        identify(tmp_path / "drop.study.yaml", files, parameters=("bodies.ball.mass=2 kg",))


def test_scatter_and_options_that_do_not_fit(tmp_path: Path) -> None:
    one = "mode, frequency [Hz]\n3, 11.9"
    refused(tmp_path, one, r"--modes: got '1 kg', which is a mass, .* behind \+-", scatter=" +- 1 kg")
    refused(tmp_path, one, r"--modes: got a scatter of 0 %, expected one above 0", scatter=" +- 0 %")
    fifty = r"--modes: got a scatter of 50 %, expected 20 % or less; did you mean 0\.5 %\?"
    refused(tmp_path, one, fifty, scatter=" +- 0.5")
    refused(tmp_path, one, r"--modes: got a scatter of 0\.1: 10 %\?, expected .* 0\.1 %\?; write", scatter=" +- 0.1")
    refused(tmp_path, one, r"--modes: got a scatter of 50 %, expected 20 % or less; state", scatter=" +- 50 %")
    refused(tmp_path, one, r"--shapes: got a scatter of 5: 500 %\?, expected a per cent sign: 5 %\?", shapes="5")
    wide = "frequency [Hz], scatter\n11.9, 5"
    refused(
        tmp_path, wide, r"m\.csv:2:1: got a scatter of 5 Hz at 11\.9 Hz, expected 20 % of it or less; write its unit"
    )
    refused(tmp_path, one, r"--shapes: got '.*m\.csv', which has none, expected a universal file", shapes="5 %")
    refused(tmp_path, one, r"--near: got 200 %, expected 0 % to below 100 %", near="200 %")
    refused(tmp_path, one, r"--band: got no frequency response, expected --frf", band="1 Hz:2 Hz")
    refused(tmp_path, one, r"--length: got '1 parsec' with an unknown unit", length="parsec")
    refused(tmp_path, one, r"--measured and --channel: got one of them", channel="ball on P force")
    twice = "frequency [Hz], scatter [%]\n11.9, 1"
    refused(tmp_path, twice, r"m\.csv' with a column of its scatter, and \+-, expected one of them", scatter=" ± 1 %")
    refused(tmp_path, "", r"--levels: got a model, expected a study", "levels")
    response = f"f,{RESPONSE} real,{RESPONSE} imag\n10,1,1\n"
    refused(tmp_path, response, r"--frf: got a scatter of 0\.5: 50 %\?, expected a per cent sign", "frfs", " +- 0.5")
    refused(tmp_path, response, r"--band: got '5:2', expected a lower and a higher frequency", "frfs", band="5:2")
    refused(tmp_path, response, r"--band: got no line of '.*' from 50 to 60 Hz", "frfs", band="50:60")
    with pytest.raises(FemstructError, match="identify: got no measured data, expected one file or more; give --modes"):
        identify(FLOOR, MeasuredFiles(), parameters=(CONCRETE,))
    with pytest.raises(FemstructError, match="--case: got 'soft' of a model, expected a study"):
        identify(FLOOR, MeasuredFiles(modes=("m.csv",)), parameters=(CONCRETE,), case="soft")
    with pytest.raises(FemstructError, match="--levels: got a study without rooms, expected one with receivers"):
        fits = ("bodies.ball.contact.stiffness=1e5",)
        identify(DROP, MeasuredFiles(levels=(str(tmp_path / "m.csv"),)), parameters=fits)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("materials.concrete.E=26 GPa:20 GPa", "got no PATH=START and no PATH=START:LOW:HIGH"),
        ("materials.concrete.E=26 GPa:soft:40 GPa", "got a bound 'soft', expected a number"),
        ("materials.concrete.E=26 GPa:20 kg:40 kg", "got a bound '20 kg', expected one in GPa, as the start"),
        ("materials.concrete.E=26 GPa:20 Gpa:40 GPa", "unknown unit 'Gpa'"),
        (
            "materials.concrete.E=26 GPa:30 GPa:40 GPa",
            "got a start of 26 GPa and bounds of 30 GPa and 40 GPa, expected a start between",
        ),
        (
            "materials.concrete.E=26 GPa:40 GPa:20000 MPa",
            "got a start of 26 GPa and bounds of 40 GPa and 20000 MPa, expected a start between two bounds, the lower "
            "one first; write materials.concrete.E=26 GPa:20000 MPa:40 GPa",
        ),
        ("materials.concrete.E=26 GPa:40:20", "got a start of 26 GPa and bounds of 40 GPa and 20 GPa"),
        ("materials.concrete.nu=0.2:0.3:0.1", "got a start of 0.2 and bounds of 0.3 and 0.1"),
        ("materials.concrete.E=0 GPa:-1 GPa:1 GPa", "got a start of 0 GPa"),
    ],
)
def test_bounds(text: str, expected: str) -> None:
    with pytest.raises(FemstructError, match=f"--fit {text}: .*{expected}"):
        parameters_of([text])


def test_a_path_of_a_model_that_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("8.1\n9.4\n11.9", encoding="utf-8")  # the last depends on concrete
    files = MeasuredFiles(modes=(str(tmp_path / "m.csv"),))
    with pytest.raises(FemstructError, match=r"--fit materials.concret.E=26 GPa:1:90: .* did you mean"):
        identify(FLOOR, files, parameters=("materials.concret.E=26 GPa:1:90",))
    known = MeasuredFiles(modes=(f"{tmp_path / 'm.csv'} +- 1 %",))
    with pytest.raises(FemstructError, match=r"fit materials\.concrete\.loss_factor: got data that"):
        identify(FLOOR, known, parameters=("materials.concrete.loss_factor=2 %", CONCRETE))
    three = (CONCRETE, "parts.posts.stiffness.z=20 MN/m", "materials.concrete.rho=2400")
    with pytest.raises(FemstructError, match=r"measured: got 3 samples, expected more than 3, .* or state the scatter"):
        identify(FLOOR, files, parameters=three)
    with pytest.raises(FemstructError, match="expected each path once"):
        identify(FLOOR, files, parameters=(CONCRETE, CONCRETE))


def test_a_mode_that_the_model_does_not_have_is_no_pair(tmp_path: Path) -> None:
    """A shape like none: the finding names its frequency."""
    from femstruct.files.uff import write_uff
    from femstruct.modal.measured import MeasuredModes, Measurement

    places = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
    shapes = np.zeros((5, 3, 2))
    shapes[:, 2, 0], shapes[:, 2, 1] = 1.0, [1.0, -1.0, 1.0, -1.0, 1.0]
    directed = np.zeros((5, 3), dtype=bool)
    directed[:, 2] = True
    modes = MeasuredModes([12.0, 25.0], np.zeros(2), shapes, places, directed)
    write_uff(Measurement("odd", np.arange(1, 6), places, modes=modes), tmp_path / "odd.uff")
    found = identify(FLOOR, MeasuredFiles(modes=(str(tmp_path / "odd.uff"),)), parameters=(CONCRETE,))
    lost = next(one for one in found.findings if one.code == "mode-pair-lost")
    assert "at 25 Hz (MAC 0." in lost.message and lost.values["modes"] == 1.0
