"""Universal files: round trips, and files by the public description of the data sets, as other programs write them."""

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import InputError
from femstruct.files.uff import read_uff, write_uff
from femstruct.modal.measured import MeasuredFrf, MeasuredHistory, MeasuredModes, MeasuredPlace, Measurement

pytest.importorskip("pyuff", reason="universal files need the package pyuff")
SIX_DIGITS = 5e-6  # of a number: what E13.5 keeps
POINTS = np.array([[0.0, 0.0, 0.1], [0.5, 0.0, 0.1], [0.5, 0.4, 0.1], [0.0, 0.4, 0.1]]) + 1.0 / 3.0


def measurement(shapes, frfs=(), histories=()):
    modes = MeasuredModes([20.123456, 50.5, 50.75], [0.01, 0.02, 0.0], shapes, POINTS, np.ones((4, 3), bool))
    return Measurement(
        "a plate", [3, 7, 8, 20], POINTS, [[0, 2]], [[0, 1, 2, 3]], modes=modes, frfs=frfs, histories=histories
    )


def there_and_back(some, tmp_path):
    return read_uff(write_uff(some, tmp_path / "some.uff"))


@pytest.mark.parametrize("is_complex", [False, True])
def test_modes_come_back(tmp_path, is_complex):
    random = np.random.default_rng(1)
    shapes = random.standard_normal((4, 3, 3)) + (1j * random.standard_normal((4, 3, 3)) if is_complex else 0.0)
    before = measurement(shapes)
    after = there_and_back(before, tmp_path)
    assert after.title == "a plate" and not after.notes
    assert after.nodes.tolist() == [3, 7, 8, 20]
    np.testing.assert_array_equal(after.points, POINTS)  # data set 2411 has all digits
    np.testing.assert_allclose(after.modes.shapes, shapes, atol=SIX_DIGITS * np.abs(shapes).max())
    np.testing.assert_allclose(after.modes.frequency_hz, before.modes.frequency_hz, rtol=SIX_DIGITS)
    np.testing.assert_allclose(
        after.modes.damping_ratio, before.modes.damping_ratio, rtol=1e-3, atol=SIX_DIGITS
    )  # small
    assert np.iscomplexobj(after.modes.shapes) == is_complex
    assert after.quads.tolist() == [[0, 1, 2, 3]]
    assert sorted(map(tuple, after.lines.tolist())) == [(0, 1), (0, 2), (0, 3), (1, 2), (2, 3)]


@pytest.mark.parametrize("is_complex", [False, True])
def test_nodes_of_data_set_15_and_modes_of_2414_are_what_pyuff_reads(tmp_path, is_complex):
    import pyuff

    random = np.random.default_rng(4)
    shapes = random.standard_normal((4, 3, 3)) + (1j * random.standard_normal((4, 3, 3)) if is_complex else 0.0)
    before = measurement(shapes)
    path = write_uff(before, tmp_path / "some.uff", sets=(15, 2414))
    file = pyuff.UFF(str(path))
    assert file.get_set_types().astype(int).tolist() == [151, 164, 15, 2412, 82, 2414, 2414, 2414]
    nodes, units = file.read_sets(2), file.read_sets(1)
    assert [int(number) for number in nodes["node_nums"]] == [3, 7, 8, 20] and units["length"] == 1.0
    np.testing.assert_allclose(np.stack([nodes[axis] for axis in "xyz"], axis=1), POINTS, rtol=SIX_DIGITS)
    for k in range(3):
        one = file.read_sets(5 + k)
        rows = np.array(one["data_at_node"])
        rows = rows[:, ::2] + 1j * rows[:, 1::2] if is_complex else rows
        np.testing.assert_allclose(rows, shapes[:, :, k], atol=SIX_DIGITS * np.abs(shapes).max())
        assert one["node_nums"].tolist() == [3, 7, 8, 20] and one["record10_field6"] == k + 1
        root = complex(one["record13_field1"], one["record13_field2"])
        frequency = abs(root) / (2 * np.pi) if is_complex else one["record12_field2"]
        assert frequency == pytest.approx(before.modes.frequency_hz[k], rel=SIX_DIGITS)
    after = read_uff(path)
    assert not after.notes and np.iscomplexobj(after.modes.shapes) == is_complex
    np.testing.assert_allclose(after.modes.shapes, shapes, atol=SIX_DIGITS * np.abs(shapes).max())
    # a quotient of numbers of six digits, and small
    np.testing.assert_allclose(after.modes.damping_ratio, before.modes.damping_ratio, rtol=1e-3, atol=SIX_DIGITS)
    for wrong in ((15, 2411), (58,), (55, 2414)):
        with pytest.raises(InputError, match="expected one of nodes, 15 or 2411, and one of modes, 55 or 2414"):
            write_uff(before, tmp_path / "some.uff", sets=wrong)


@pytest.mark.parametrize("kind", ["receptance", "mobility", "accelerance", "transmissibility", "unknown"])
@pytest.mark.parametrize("step", [0.5, np.pi], ids=["even", "uneven"])
def test_responses_come_back(tmp_path, kind, step):
    random = np.random.default_rng(2)
    unit = {"receptance": "m/N", "mobility": "m/(N s)", "accelerance": "m/(N s^2)", "transmissibility": "1"}
    values = random.standard_normal(11) + 1j * random.standard_normal(11)
    frf = MeasuredFrf(
        MeasuredPlace(7, "z", "hammer"),
        MeasuredPlace(20, "x"),
        kind,
        step * np.arange(1, 12),
        values,
        unit.get(kind, "Pa/V"),
    )
    (back,) = there_and_back(replace(measurement(np.ones((4, 3, 3))), frfs=(frf,)), tmp_path).frfs
    np.testing.assert_allclose(back.values, values, rtol=1e-11)  # E20.11: twelve digits
    np.testing.assert_allclose(back.frequency_hz, frf.frequency_hz, rtol=SIX_DIGITS)
    assert (str(back.drive), back.drive.node, str(back.response)) == ("hammer.z", 7, "20.x")
    assert (back.kind, back.unit) == (kind, frf.unit)


def test_histories_come_back(tmp_path):
    history = MeasuredHistory(MeasuredPlace(8, "y"), "force", np.arange(20) * 1e-4, np.sin(np.arange(20.0)), "N")
    (back,) = there_and_back(measurement(np.ones((4, 3, 3)), histories=(history,)), tmp_path).histories
    np.testing.assert_allclose(back.values, history.values, rtol=1e-11)  # twelve digits
    np.testing.assert_allclose(back.t, history.t, atol=1e-15)  # a step of 1e-4 is one number
    assert (str(back.place), back.what, back.unit) == ("8.y", "force", "N")


# What follows is written by the descriptions of the data sets alone, with the columns that Fortran makes.
def e(values, width=13, digits=5, letter="E"):
    """1PEw.d of Fortran: six numbers a line at 13 columns, four at 20."""
    return "".join(f"{value:{width}.{digits}E}".replace("E", letter) for value in values)


def i(*values, width=10):
    return "".join(f"{value:{width}d}" for value in values)


def data_set(number, *lines):
    return ["    -1", f"{number:6d}", *lines, "    -1"]


UNITS = data_set(164, f"{5:10d}mm (milli newton)   {2:10d}", e([1e3, 1e3, 1.0], 25, 17, "D"), e([273.15], 25, 17, "D"))
HEADER = data_set(151, "plate under test", "NONE", "ANALYSER", *["01-JUN-24 12:00:00"] * 2, "ANALYSER", "01-JUN-24")
PLACES = {1: (0.0, 0.0, 0.0), 2: (500.0, 0.0, 0.0), 3: (500.0, 400.0, 0.0)}
NODES = data_set(15, *(i(node, 1, 1, 11) + e(place) for node, place in PLACES.items()))
NODES_2411 = data_set(2411, *(line for n, xyz in PLACES.items() for line in (i(n, 1, 1, 11), e(xyz, 25, 16, "D"))))
TRACE = data_set(82, i(1, 5, 7), "OUTLINE", i(1, 2, 3, 0, 1))
TEXTS = ["NONE"] * 5
Z = {1: 1.0, 2: -0.5, 3: 0.25}


def mode_55(frequency, vis=0.0, hys=0.0, number=1):
    rows = [line for node, z in Z.items() for line in (i(node), e([0.0, 0.0, z * number]))]
    heads = [i(1, 2, 2, 8, 2, 3), i(2, 4, 1, number), e([frequency, 1.0, vis, hys])]
    return data_set(55, *TEXTS, *heads, *rows)


def complex_55(eigenvalue):
    rows = [line for node, z in Z.items() for line in (i(node), e([0.0, 0.0, 0.0, 0.0, z, -z]))]
    heads = [i(1, 3, 2, 8, 5, 3), i(2, 6, 1, 2), e([eigenvalue.real, eigenvalue.imag, 0.0, 0.0, 0.0, 0.0])]
    return data_set(55, *TEXTS, *heads, *rows)


def mode_2414(frequency, ratio):
    heads = [i(1), "MODES", i(1), *TEXTS, i(1, 2, 2, 8, 2, 3), i(*[0] * 8), i(*[0] * 8)]
    numbers = [e([0.0, frequency, 0.0, 1.0, ratio, 0.0]), e([0.0] * 6)]
    return data_set(2414, *heads, *numbers, *(line for node, z in Z.items() for line in (i(node), e([0.0, 0.0, z]))))


def function_58(values, response=(2, -3), label="g", above=12, kind=4, data_type=5, even=1):
    head = f"{kind:5d}{1:10d}{0:5d}{0:10d} {'NONE':10s}{response[0]:10d}{response[1]:4d} {'NONE':10s}{1:10d}{3:4d}"
    lines = [*TEXTS, head, i(data_type, len(values), even) + e([10.0, 0.25, 0.0])]
    for code, name, unit in (
        (18, "Frequency", "Hz"),
        (above, "Motion", label),
        (13, "Force", "N"),
        (0, "NONE", "NONE"),
    ):
        lines.append(f"{code:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}")
    pairs = np.stack([values.real, values.imag], axis=1).ravel()
    pairs = np.concatenate([pairs, np.zeros(-len(pairs) % 6)])  # the last line filled up, as some programs do
    return data_set(58, *lines, *(e(pairs[at : at + 6]) for at in range(0, len(pairs), 6)))


def written(tmp_path, *sets, end="\n"):
    path = tmp_path / "foreign.unv"
    path.write_bytes((end.join(line for one in sets for line in one) + end).encode("ascii"))
    return path


@pytest.mark.parametrize("nodes", [NODES, NODES_2411], ids=["15", "2411"])
@pytest.mark.parametrize("end", ["\n", "\r\n"], ids=["unix", "dos"])
def test_a_file_in_millimetres(tmp_path, nodes, end):
    """Factors of data set 164 divide; directions with a minus are turned; g is a unit; a loss factor is halved."""
    values = np.array([1.0 + 2.0j, 3.0 - 1.0j, 0.5j, -2.0 + 0.0j])
    read = read_uff(
        written(
            tmp_path,
            HEADER,
            UNITS,
            nodes,
            TRACE,
            mode_55(88.5, 0.0, 0.04, 2),
            mode_55(41.2, 0.01),
            function_58(values),
            end=end,
        )
    )
    assert read.title == "plate under test" and not read.notes
    np.testing.assert_allclose(read.points[2], [0.5, 0.4, 0.0], rtol=1e-15)  # one division
    assert read.lines.tolist() == [[0, 1], [1, 2]]
    assert read.modes.frequency_hz.tolist() == [41.2, 88.5]  # sorted
    assert read.modes.damping_ratio.tolist() == [0.01, 0.02]
    assert read.modes.directed.tolist() == [[False, False, True]] * 3
    assert read.modes.measured_shapes[:, 0].tolist() == [1.0, -0.5, 0.25]
    (frf,) = read.frfs
    assert (str(frf.drive), str(frf.response), frf.kind, frf.unit) == ("1.z", "2.z", "accelerance", "m/(N s^2)")
    assert frf.frequency_hz.tolist() == [10.0, 10.25, 10.5, 10.75]  # the zeros that fill the line are no lines
    np.testing.assert_allclose(frf.values, -9.80665 * 1e3 * values, rtol=1e-12)  # over millinewtons: rounding


def test_lengths_in_millimetres_and_forces_in_millinewtons(tmp_path):
    """mm/s^2 per mN is m/s^2 per N."""
    read = read_uff(written(tmp_path, UNITS, NODES, function_58(np.array([1.0 + 1.0j, 2.0]), (2, 1), "mm/s2")))
    np.testing.assert_allclose(read.frfs[0].values, [1.0 + 1.0j, 2.0], rtol=1e-15)  # one multiplication
    assert str(read.frfs[0].response) == "2.x"


def test_without_units_it_says_what_it_took(tmp_path):
    read = read_uff(written(tmp_path, NODES, mode_55(41.2)), length=1e-3)
    assert read.points[1].tolist() == [0.5, 0.0, 0.0]
    assert read.notes == ("no data set 164 (units): taken to be in units of 0.001 m, and newtons",)


def test_a_header_that_cannot_be_read_is_left_out(tmp_path):
    read = read_uff(written(tmp_path, HEADER[:4] + HEADER[-1:], UNITS, NODES))
    assert read.notes == ("left out: 1 x data set 151",) and len(read.nodes) == 3


def test_complex_modes_and_modes_of_data_set_2414(tmp_path):
    """lambda = -zeta omega + j omega sqrt(1 - zeta^2), here of 10 Hz and 5 %, with six digits."""
    omega, zeta = 20.0 * np.pi, 0.05
    read = read_uff(
        written(tmp_path, UNITS, NODES, complex_55(omega * complex(-zeta, np.sqrt(1 - zeta**2))), mode_2414(30.0, 0.02))
    )
    assert read.modes.frequency_hz == pytest.approx([10.0, 30.0], rel=SIX_DIGITS)
    assert read.modes.damping_ratio == pytest.approx([0.05, 0.02], rel=2 * SIX_DIGITS)  # a quotient
    assert read.modes.shapes[:, 2, 0].tolist() == [1.0 - 1.0j, -0.5 + 0.5j, 0.25 - 0.25j]
    assert read.modes.shapes[:, 2, 1].tolist() == [1.0, -0.5, 0.25]


def test_what_is_left_out_is_named(tmp_path):
    coherence = function_58(np.array([1.0 + 0j, 0.9]), kind=6)
    read = read_uff(written(tmp_path, UNITS, NODES, data_set(2467, i(1)), coherence, coherence))
    assert read.notes == (
        "left out: 1 x data set 2467",
        "left out: 2 x function of kind 6 (no frequency response, no history)",
    )
    assert read.modes is None and read.frfs == ()


LOCAL = data_set(
    2420, i(1), "PART", i(1, 0, 8), "CS1", e([0.0, 1.0, 0.0], 25, 16), e([-1.0, 0.0, 0.0], 25, 16),
    e([0.0, 0.0, 1.0], 25, 16), e([0.0, 0.0, 0.0], 25, 16),
)  # fmt: skip
GLOBAL = data_set(
    2420, i(1), "PART", i(1, 0, 8), "CS1", e([1.0, 0.0, 0.0], 25, 16), e([0.0, 1.0, 0.0], 25, 16),
    e([0.0, 0.0, 1.0], 25, 16), e([0.0, 0.0, 0.0], 25, 16),
)  # fmt: skip


def test_the_global_coordinate_system_may_have_a_number(tmp_path):
    assert read_uff(written(tmp_path, UNITS, GLOBAL, NODES_2411)).nodes.tolist() == [1, 2, 3]


SPOILT = [*mode_55(41.2)[:12], "no numbers", "    -1"]
SHORT = [*function_58(np.ones(40) + 0j)[:16], "    -1"]
NO_UNIT = data_set(164, f"{5:10d}mm{2:28d}", e([0.0, 1.0, 1.0]), e([0.0]))


@pytest.mark.parametrize(
    ("sets", "told"),
    [
        ((UNITS, NODES[:-1]), r"foreign.unv:7:1: got a data set without its end, expected a line with -1; .* cut off"),
        ((["nothing"],), "without a line of -1 in columns 5 and 6, expected a universal file"),
        ((UNITS, NODES, SPOILT), r"foreign.unv:13:1: got data set 55, which cannot be read \(.*no numbers"),
        ((UNITS, mode_55(41.2)), r":7:1: got a mode with nodes without places: 1, 2, 3, expected their coordinates"),
        ((LOCAL, NODES), r":12:1: got nodes in coordinate system 1, which is turned or shifted, .* global axes"),
        ((UNITS, NODES, SHORT), r":13:1: got \d+ values of 40, expected as many"),
        ((NO_UNIT,), "got factors 0, 1, expected positive"),
    ],
    ids=["cut off", "no file", "words", "no places", "turned", "too few", "zero"],
)
def test_what_cannot_be_read_is_told_with_its_line(tmp_path, sets, told):
    with pytest.raises(InputError, match=told):
        read_uff(written(tmp_path, *sets))


def test_a_missing_package_is_told_once(monkeypatch, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "pyuff", None)
    with pytest.raises(InputError, match=r"no package pyuff, expected it installed; pip install '.\[uff\]'"):
        read_uff(tmp_path / "some.uff")
    with pytest.raises(InputError, match="no package pyuff"):
        write_uff(measurement(np.ones((4, 3, 3))), tmp_path / "some.uff")
    assert not list(tmp_path.iterdir())


def test_a_response_of_one_line_is_refused(tmp_path):
    frf = MeasuredFrf(MeasuredPlace(7, "z"), MeasuredPlace(8, "z"), "mobility", [1.0], [1.0], "m/(N s)")
    with pytest.raises(InputError, match="data set 58 that cannot be written"):
        write_uff(measurement(np.ones((4, 3, 3)), frfs=(frf,)), tmp_path / "some.uff")
    assert not list(tmp_path.iterdir())


def test_binary_functions_are_read(tmp_path):
    """58b: little-endian doubles between lines of text, as analysers write long records."""
    values = np.linspace(0.0, 1.0, 7) + 1j * np.linspace(2.0, -3.0, 7)
    heads = function_58(values, (2, -2), "mm/s", above=11, data_type=6)[2:13]
    kind = f"    58b{1:6d}{2:6d}{11:12d}{16 * len(values):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    path = written(tmp_path, UNITS, NODES, ["    -1", kind, *heads])
    path.write_bytes(path.read_bytes() + values.astype("<c16").tobytes() + b"    -1\n")
    (frf,) = read_uff(path).frfs
    # y is turned round, z of the drive is not; mm/s per mN is m/s per N
    np.testing.assert_allclose(frf.values, -values, rtol=1e-15, atol=0)  # one multiplication
    assert (str(frf.response), str(frf.drive), frf.kind) == ("2.y", "1.z", "mobility")


def test_a_spoilt_file_is_read_or_refused_with_a_sentence(tmp_path, capsys):
    """Single characters replaced, lines lost or doubled, ends cut off: no traceback, and pyuff prints nothing."""
    cells = data_set(2412, i(1, 94, 1, 1, 7, 4), i(1, 2, 3, 1))
    sets = (HEADER, UNITS, GLOBAL, NODES_2411, NODES, TRACE, cells, mode_55(88.5), complex_55(-1.0 + 60.0j))
    whole = written(tmp_path, *sets, mode_2414(30.0, 0.02), function_58(np.array([1.0 + 2.0j, 0.5j]))).read_bytes()
    random = np.random.default_rng(8)
    path, read = tmp_path / "spoilt.uff", 0
    for turn in range(240):
        spoilt = bytearray(whole)
        lines = whole.split(b"\n")
        if turn % 4 < 2:
            spoilt[random.integers(len(spoilt))] = random.choice(list(b"0123456789 -+.EDnax\n\0\xff"))
        elif turn % 4 == 2:
            at, other = random.integers(len(lines), size=2)
            lines[at : at + 1] = [] if turn % 8 == 2 else [lines[at], lines[other]]
            spoilt = bytearray(b"\n".join(lines))
        else:
            spoilt = spoilt[: random.integers(len(spoilt))]
        path.write_bytes(bytes(spoilt))
        try:
            read_uff(path)
            read += 1
        except InputError as error:
            assert str(error).startswith(str(path))
    assert 20 < read < 220
    assert capsys.readouterr().out == ""


def test_nouns_refuse_what_does_not_fit():
    with pytest.raises(InputError, match="frequencies >= 0 that ascend"):
        MeasuredModes([2.0, 1.0], [0.0, 0.0], np.ones((4, 3, 2)), POINTS, np.ones((4, 3)))
    with pytest.raises(InputError, match=r"shapes: got shape \(4, 3, 1\), expected shape \(4, 3, 2\)"):
        MeasuredModes([1.0, 2.0], [0.0, 0.0], np.ones((4, 3, 1)), POINTS, np.ones((4, 3)))
    with pytest.raises(InputError, match="nan or infinity"):
        MeasuredModes([1.0], [0.0], np.full((4, 3, 1), np.nan), POINTS, np.ones((4, 3)))
    with pytest.raises(InputError, match="got 'up', expected x, y, z"):
        MeasuredPlace(1, "up")
