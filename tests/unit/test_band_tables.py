"""Tables of bands as analysers write them: separators, decimals, heads, encodings, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.files.band_tables import read_bands
from femstruct.files.columns import read_history
from femstruct.files.measured_frequencies import read_frequencies
from femstruct.language.cases import read_study

WANTED = {50.0: 0.52, 63.0: 0.48, 1000.0: 0.4, 1250.0: 0.41}
TABLES = {
    "semicolons": "Frequenz [Hz];T20 [s]\n50;0,52\n63;0,48\n1000;0,40\n1250;0,41\n",
    "tabs and blanks above": "Raum\nDatum\t12.3.2024\n\nf / Hz\tT20 / ms\n50\t520\n63\t480\n1k\t400\n1,25 kHz\t410\n",
    "commas": 'f,T20 (s)\n"50 Hz",0.52\n63 Hz,.48\n1k,0.4\n1k25,4.1e-1\n',
    "commas in quotes": 'f,T20\n50,"0,52"\n63,"0,48"\n1000,"0,4"\n1250,"0,41"\n',
    "blanks": "50  0,52\n63  0,48\n1000 0,4\n1250 0,41\n",
    "kilohertz": "f [kHz];T [s]\n0,05;0,52\n0,063;0,48\n1;0,4\n1,25;0,41\n",
    "exact centres": "f,T\n50.12,0.52\n63.10,0.48\n1000.00,0.4\n1258.93,0.41\n",
    "side by side": "Raum;50 Hz;63 Hz;1 kHz;1,25 kHz;A\nT20 [s];0,52;0,48;0,4;0,41;0,45\n",
    "units in a line and totals": "f;T20\nHz;s\n50;0,52\n63;0,48\n1000;0,4\n1250;0,41\nA;0,4\nSumme;1,8\n",
    "German": "Frequenz;Nachhallzeit in s (Mittel über Räume)\n50;0,52\n63;0,48\n1000;0,4\n1250;0,41\n",
    "Japanese": "中心周波数[Hz],残響時間[s]\n50,0.52\n63,0.48\n1k,0.4\n1.25k,0.41\n合計,1\n",
    "Korean": "주파수 [Hz],잔향시간 [s]\n50,0.52\n63,0.48\n1k,0.4\n1.25k,0.41\n",
}
WIDE = {  # bands from the first cell on: none of them is a label
    "numbers": "50;63;1000;1250\n0,52;0,48;0,4;0,41\n",
    "units": "50 Hz;63 Hz;1 kHz;1,25 kHz\n0,52;0,48;0,4;0,41\n",
    "a total": "50 Hz;63 Hz;1 kHz;1,25 kHz;A\n0,52;0,48;0,4;0,41;0,45\n",
    "a label of values": "50 Hz,63 Hz,1 kHz,1.25 kHz\nT20 [ms],520,480,400,410\n",
    "a title": "Raum 7\n50,63,1k,1k25\n.52,.48,.4,.41\n",
    "a value that could be a band": "50;63;1000;1250\n0,52;0,48;0,4;0,41\n",
}


@pytest.mark.parametrize("name", WIDE)
def test_bands_from_the_first_cell_on_are_all_taken(name: str, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(WIDE[name], encoding="utf-8")
    found = read_bands(tmp_path / "t.csv", "time", {})
    assert {band: one.value for band, one in found.items()} == pytest.approx(WANTED)


def test_forces_that_could_be_bands_are_asked_for(tmp_path: Path) -> None:
    """A force of 80 N at 63 Hz below bands, or a force of 125 N at 63 Hz beside them: the table does not say."""
    path = tmp_path / "t.csv"
    path.write_text("63;125;250\n80;1;1\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"1:1: got bands in the first line and in the first column, expected one of"):
        read_bands(path, "force", {})
    path.write_text("63;125;250\n10;1;1\n", encoding="utf-8")
    assert {band: one.value for band, one in read_bands(path, "force", {}).items()} == {
        63.0: 10.0,
        125.0: 1.0,
        250.0: 1.0,
    }
    path.write_text("Band;F1;F2;F3\n63;100;125;160\n80;1;1;1\n", encoding="utf-8")  # heads above, values like bands
    assert {band: one.value for band, one in read_bands(path, "force", {}, "F2").items()} == {63.0: 125.0, 80.0: 1.0}


ENCODINGS = {"German": ("cp1252",), "Japanese": ("cp932",), "Korean": ("cp949",)}


@pytest.mark.parametrize("name", TABLES)
def test_tables_are_read_as_they_are(name: str, tmp_path: Path) -> None:
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", *ENCODINGS.get(name, ())):
        path = tmp_path / f"{encoding}.csv"
        path.write_bytes(TABLES[name].replace("\n", "\r\n").encode(encoding))
        sources: dict[str, str] = {}
        found = read_bands(path, "time", sources)
        assert {band: one.value for band, one in found.items()} == pytest.approx(WANTED), encoding
        assert list(sources) == [str(path)]


def test_a_column_is_chosen_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("f [Hz];EDT [s];T30 [ms]\n63;0,5;600\n80;0,4;700\n", encoding="utf-8")
    assert {band: one.value for band, one in read_bands(path, "time", {}, "T30").items()} == pytest.approx(
        {63.0: 0.6, 80.0: 0.7}
    )
    assert {band: one.line for band, one in read_bands(path, "time", {}, "EDT").items()} == {63.0: 2, 80.0: 3}


def test_levels_have_their_reference_in_the_head(tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    for unit in ("dB re 1 µN", "dB ref 1e-6 N", "dB re. 1 uN", "dB re 1e-6 N"):
        path.write_text(f"f;L_F [{unit}]\n63;120\n80;100,0\n", encoding="utf-8")
        found = read_bands(path, "force", {})
        assert [one.value for one in found.values()] == pytest.approx([1.0, 0.1]), unit


WRONG = {  # text of t60.csv: what the line says after its file
    "thousands in bands": ("f;T [s]\n800;0,5\n1.250;0,5\n", r"3:1: got a band of '1\.250'.*1k25"),
    "thousands in values": ("f;T [ms]\n63;1.234,5\n", r"2:1: got '1\.234,5', a number with a thousands separator"),
    "two decimals": ("f;T\n63;0,5\n80;0.5\n", r"3:1: got '0\.5' in a table whose decimals have a comma"),
    "no band": ("f;T\n63;0,5\n70;0,5\n", r"3:1: got a band of '70', expected a nominal octave or third octave"),
    "twice": ("f;T\n63;0,5\n63 Hz;0,5\n", r"3:1: got 63 Hz again \(line 2\), expected each band once"),
    "a blank": ("f;T\n63;0,5\n80;---\n", r"3:1: got no value at 80 Hz, expected a number in every band"),
    "a word": ("f;T\n63;0,5\n80;kurz\n", r"3:1: got 'kurz', expected a number in every band"),
    "two columns": ("f;T20;T30\n63;0,5;0,6\n", r"2:1: got 2 columns of values: T20, T30, expected one"),
    "another unit": ("f;T [kg]\n63;0,5\n", r"1:1: got 'T \[kg\]', expected a time \[s\]"),
    "beyond what there is": ("f;T\n63;0,5\n80;500\n", r"3:1: got 500, expected a time of at most 120 s; .*500 ms"),
    "no table": ("nothing\n", r"1:1: got no table of bands, expected lines of a band and a value"),
    "a label below a band": (
        "63 Hz;125 Hz;250 Hz\nT20;0,5;0,4\n",
        r"2:1: got 'T20' below the band 63 Hz, expected a val",
    ),
    "no label and no band": ("8;16;31,5;63\n1;1;1;1\n", r"1:1: got '8' before bands, expected a label, or a nominal"),
    "a value below no band": ("f;63;125;;500\nT;1;1;1;1\n", r"2:1: got '1' below no band, expected a band above"),
    "more values than bands": ("f;63;125;500\nT;1;1;1;1\n", r"2:1: got 4 values, expected one for each of the 3 bands"),
    "more values than heads": ("f;T\n63;0,5\n80;0,5;7\n", r"3:1: got '7' beyond the columns above, expected 1 values"),
    "a word in the first band": ("f;T\n63;O,5\n80;0,5\n", r"2:1: got 'O,5', expected a number in every band"),
    "another word": ("f;T\n63;0,5\nEnde;1\n", r"3:1: got 'Ende', expected a band"),
}


def study(tmp_path: Path, t60: str) -> Path:
    (tmp_path / "m.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, frequency: 5 Hz}\npoints: {m: {}}\n", encoding="utf-8"
    )
    path = tmp_path / "a.study.yaml"
    path.write_text(
        "model: m.yaml\nrooms:\n  r: {size: [5, 4, 2.5], under: s, losses: {t60: " + t60 + "}}\n", encoding="utf-8"
    )
    return path


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_in_a_table_is_one_line(name: str, tmp_path: Path) -> None:
    text, told = WRONG[name]
    (tmp_path / "t60.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_study(study(tmp_path, "{file: t60.csv}"))
    (line,) = caught.value.errors
    assert re.search(r"t60\.csv:" + told, line), line


@pytest.mark.parametrize(
    ("t60", "told"),
    [
        ("{file: t61.csv}", r"a\.study\.yaml:3:\d+: rooms\.r\.losses\.t60: got no file '.*t61\.csv'"),
        ("{file: t60.csv, colum: T20}", r"got the key 'colum' beside 'file', expected 'file' and 'column'"),
        ("{file: t60.csv, column: T99}", r"t60\.csv:2:1: got no column 'T99', expected one of T20"),
        ("{file: /etc/passwd}", r"got the absolute path"),
        ("{file: two.csv, column: T30}", r"two\.csv:2:1: got 2 columns 'T30', expected one of that name"),
    ],
)
def test_what_names_a_table_wrongly(t60: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "t60.csv").write_text("f;T20\n63;0,5\n", encoding="utf-8")
    (tmp_path / "two.csv").write_text("f;T30;T30\n63;0,5;0,6\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_study(study(tmp_path, t60))


def test_an_encoding_that_cannot_be_determined_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(b"f;T\n63;0,5\n" + "частота;время\n".encode("koi8-r"))
    with pytest.raises(InputErrors, match=r"t\.csv:3:1: got a character in an unknown encoding \(byte 0x.*UTF-8"):
        read_bands(path, "time", {})
    path.write_bytes("f;T\n63;0,5\n".encode("utf-16-le")[:-1])
    with pytest.raises(InputErrors, match="UTF-16"):
        read_bands(path, "time", {})


def test_a_first_line_of_data_with_a_mistake_is_no_head(tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    path.write_text("t;F\n0;O\n1;1\n2;1\n", encoding="utf-8")
    with pytest.raises(InputErrors, match=r"f\.csv:2:1: got '0, O', expected two numbers"):
        read_history(path, "force", {})
    path.write_text("Kanal;7\nt;F\n0;0\n1;1\n", encoding="utf-8")  # words and a number: still above the numbers
    assert read_history(path, "force", {}).values.tolist() == [0.0, 1.0]


@pytest.mark.parametrize("heads", ["f [Hz];frequency [Hz]", "frequency;scatter;sd"])
def test_two_columns_of_one_meaning_are_asked_for(heads: str, tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    path.write_text(
        f"{heads}\n1;2;3\n2;3;4\n".replace(";3\n", "\n" if heads.count(";") == 1 else ";3\n"), encoding="utf-8"
    )
    with pytest.raises(InputErrors, match=r"f\.csv:1:1: got columns .*, all of them a .*, expected one of each"):
        read_frequencies(path)


def test_histories_are_read_as_they_are_too(tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    path.write_bytes("Messung 7\nZeit in ms;Kraft in kN\n0;0\n0,5;1,25\n1;0\n".encode("cp1252"))
    table = read_history(path, "force", {})
    assert table.times.tolist() == pytest.approx([0.0, 0.5e-3, 1e-3])
    assert table.values.tolist() == pytest.approx([0.0, 1250.0, 0.0])
