"""Slips of everyday: keyboards, editors, names of other kinds, keys without a value, cases and --set; one line each."""

from __future__ import annotations

import unicodedata
from pathlib import Path

import numpy as np
import pytest

from femstruct.campaign.designs import campaigns_of
from femstruct.errors import InputError, InputErrors
from femstruct.impact.fatigue import SNLine
from femstruct.language.campaigns import read_campaign, read_search
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file
from femstruct.units import QuantityError, quantity
from femstruct.workflow.run import run_study

MODEL = """\
title: Small plate
materials:
  steel: {E: 210 GPa, nu: 0.3, rho: 7850}
sections:
  bar: {shape: circle, diameter: 10 mm}
parts:
  sheet: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0], size: [0.4, 0.3], mesh: 100 mm}
  legs: {type: spring, between: [feet, ground], stiffness: {x: 1 kN/m, y: 1 kN/m, z: 2 kN/m}}
points:
  O: {on: sheet, at: center}
  feet: {on: sheet, at: [[0, 0], [0.4, 0], [0.4, 0.3], [0, 0.3]]}
surfaces:
  top: {on: sheet}
damping: {ratio: 1 %}
"""
STUDY = """\
title: Ball on plate
model: m.yaml
modes: {up_to: 500 Hz}
frf:
  drive point: {drive: O.z, response: O.z, kind: mobility, band: [10 Hz, 100 Hz], step: 10 Hz}
bodies:
  ball: {mass: 10 g, above: O, drop_height: 10 mm, contact: {type: linear, stiffness: 10 kN/m}}
record: {O.z: acceleration, ball on O: force}
time: {duration: 10 ms, sampling: 10 kHz}
cases:
  light: {}
  heavy: {bodies.ball.mass: 20 g}
"""
HEAVY = "heavy: {bodies.ball.mass: 20 g}"
SHAKEN = "vibration.shaker: {at: O.z, harmonic: 1 N, band: [10 Hz, 20 Hz]}"


def written(folder: Path, model: str = MODEL, study: str = STUDY) -> Path:
    (folder / "m.yaml").write_text(model, encoding="utf-8")
    (folder / "s.study.yaml").write_text(study, encoding="utf-8")
    return folder / "s.study.yaml"


def the_mistake(folder: Path, *overrides: str, model: str = MODEL, study: str = STUDY) -> str:
    """The one mistake of a study, without the folder."""
    with pytest.raises(InputErrors) as caught:
        read_study(written(folder, model, study), overrides)
    assert len(caught.value.errors) == 1, caught.value.errors
    return caught.value.errors[0].replace(f"{folder}/", "")


@pytest.mark.parametrize(
    ("text", "typed"),
    [
        ("2 \u339c", "\u339c (U+339C), expected a length [m]; type it as 2 mm"),  # one character, of Korean keyboards
        ("\uff12 mm", "\uff12 (U+FF12), expected a length [m]; type it as 2 mm"),
        ("\u22122 mm", "\u2212 (U+2212), expected a length [m]; type it as -2 mm"),
        ("\u201c2 mm\u201d", "\u201c (U+201C), expected a length [m]; type it as 2 mm"),
    ],
)
def test_characters_of_print_are_named_with_what_to_type(text: str, typed: str) -> None:
    with pytest.raises(QuantityError) as caught:
        quantity(text, "length")
    assert str(caught.value).endswith(f"with the character {typed}")


def test_blanks_of_any_width_and_raised_powers_are_read() -> None:
    assert quantity("2\u00a0mm", "length") == quantity("2\u202fmm", "length") == 2e-3
    assert quantity("7850 kg m⁻³", "density") == 7850.0 and quantity("3 m s⁻¹", "speed") == 3.0
    for text in ("10² mm", "10⁻³ m", "7\u00a0850 mm"):  # no powers of numbers, no thousands apart
        with pytest.raises(QuantityError, match="write it like 5 mm"):
            quantity(text, "length")


IN_MODEL = {
    "a key without a value": ("top: {on: sheet}", "top:", "m.yaml:13:3: surfaces.top: got nothing, expected a mapping"),
    "a group without a value": ("  top: {on: sheet}\n", "", "m.yaml:12:1: surfaces: got nothing"),
    "a spring has no place": ("on: sheet, at: center", "on: legs, at: center",
        "m.yaml:10:11: points.O.on: got 'legs', of type spring, expected the name of a part with nodes; known"),
    "a point is no part": ("on: sheet, at: center", "on: feet, at: center",
        "points.O.on: got 'feet', one of the points, expected the name of a part;"),
    "a section is no material": ("material: steel", "material: bar", "got 'bar', one of the sections, expected"),
    "a spring of one point": ("[feet, ground]", "[feet, feet]",
        "m.yaml:8:33: parts.legs.between: got 'feet' twice, expected two different places"),
    "a blank in a name": ("  top: {on", "  'top ': {on",
        "13:3: surfaces.top : got the name 'top ', expected a name without blanks at its ends; remove them"),
    "no damping constant": ("ratio: 1 %", "rayleigh: {}", "damping.rayleigh: got no alpha and no beta, expected one"),
    "no shape": ("shape: circle", "shape: round", "got 'round', expected one of rectangle, circle, tube, box, I"),
    "a material by its name": ("{E: 210 GPa, nu: 0.3, rho: 7850}", "steel",
        "m.yaml:3:10: materials.steel: got 'steel', expected a mapping"),
    "an entry of the library by its class": ("{E: 210 GPa, nu: 0.3, rho: 7850}", "{like: C30/37}",
        "m.yaml:3:17: materials.steel.like: got 'C30/37', expected a material of the library; "
        "did you mean 'concrete C30/37'?"),
    "an entry of the library by its kind": ("{E: 210 GPa, nu: 0.3, rho: 7850}", "{like: concrete}",
        "did you mean one of concrete C12/15, concrete C16/20, concrete C20/25,"),
    "cells in millimetres": ("mesh: 100 mm", "mesh: 25", "m.yaml:7:101: parts.sheet.mesh: got 25, expected "
        "a length of at most 10 m; a plain number is in metres: did you mean 25 mm?"),
    "a slab with the size of a plate": ("type: plate, material", "type: slab, material",
        "m.yaml:7:76: parts.sheet.size: got the unknown key 'size', expected a key of the language; for a rectangle of "
        "5 m by 4 m write outline: [[0, 0], [5, 0], [5, 4], [0, 4]]"),
    "a slab with cells counted": (
        "{type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0], size: [0.4, 0.3], mesh: 100 mm}",
        "{type: slab, material: steel, thickness: 2 mm, outline: [[0, 0], [1, 0], [1, 1], [0, 1]], mesh: [4, 4]}",
        "parts.sheet.mesh: got a list [4, 4], expected a largest side of its elements; write it like 200 mm"),
    "a region of corners": ("top: {on: sheet}", "top: {on: sheet, region: [0, 0.2]}",
        "m.yaml:13:28: surfaces.top.region: got a list [0, 0.2], expected whole, {rectangle: [2.5, 4], at: [1.25, 2]}"),
    "a region that is a line": ("top: {on: sheet}", "top: {on: sheet, region: {rim: [0.2, 0.1]}}", "13:28: "
        "surfaces.top.region: got a rim or line, expected an area; use whole or {rectangle: [2.5, 4], at: [1.25, 2]},"),
    "unseen": ("material: steel", "material: steel\u200b", "got a character that cannot be seen (U+200B), expected"),
    "no space in a key": ("  steel:", "  \u00a0steel:", "got a blank that is no space (U+00A0) in a key, expected"),
    "no space in a name": ("material: steel", "material: steel\u00a0", "'steel' looks alike, but has other characters"),
    "colon of full width": ("title: Small", "title\uff1aSmall", "line 1 is no 'key: value': write a colon and a space"),
    "no space after a colon": ("title: Small", "title:Small", "line 1 is no 'key: value'"),
}  # fmt: skip


@pytest.mark.parametrize("name", IN_MODEL)
def test_slips_in_a_model(name: str, tmp_path: Path) -> None:
    old, new, told = IN_MODEL[name]
    assert told in the_mistake(tmp_path, model=MODEL.replace(old, new, 1))


IN_STUDY = {
    "a group without a value": ("record: {O.z: acceleration, ball on O: force}", "record:", "8:1: record: got nothing"),
    "a step beyond the band": ("step: 10 Hz", "step: 100 Hz",
        "step: got 100 Hz, expected at most the width of the band, 90 Hz"),
    "a list of models": ("model: m.yaml", "model: [m.yaml]", "2:8: model: got a list [m.yaml], expected a name"),
    "no model": ("model: m.yaml", "model:", "s.study.yaml:2:1: model: got nothing, expected a name or text"),
    "a baseline of one case": (HEAVY, "heavy: {compare.baseline: heavy}",
        "12:11: cases.heavy.compare.baseline: got 'compare' in a case, expected what a case can change; 'compare:' is"),
    "a case in a case": (HEAVY, "heavy: {cases.light.bodies.ball.mass: 20 g}", "got 'cases' in a case"),
    "a new excitation that is not added": (HEAVY, f"heavy: {{{SHAKEN}}}",
        "the path 'vibration.shaker', which does not exist, expected a path of the files; there is no 'vibration:'"),
    "a channel that is none": (HEAVY, "heavy: {record.O.w: velocity}", "12:11: record.O.w: got 'O.w', expected POINT."),
    "a receiver in the middle": (
        "time:", "rooms: {box: {size: [5, 4, 2.5], under: top, receivers: {mic: center}}}\ntime:",
        "receivers.mic: got 'center', expected [x, y, z] from the room's lower corner; of several places"),
    "above and under": ("time:", "rooms: {open: {above: top, under: top, receivers: {mic: [0, 0, 1]}}}\ntime:",
        "rooms.open: got both under and above, expected exactly one of under, above, below"),
    "a rating with a weighting": ("time:", "limits: {bed rating: 50 dB(A)}\ntime:", "9:22: limits.bed rating: "
        "got '50 dB(A)', expected a level [dB]; write it like 53 dB"),
    "a length of a force": ("time:", "limits: {ground force: 5 lbf}\ntime:", "limits.ground force: got '5 lbf' with an "
        "unknown unit 'lbf', expected a force [N]; known units of a force: N,"),
    "a window in milliseconds": ("duration: 10 ms, sampling: 10 kHz", "duration: 2000, sampling: 1 kHz", "9:18: "
        "time.duration: got 2000, expected a unit with a window of more than 300 s; a plain number is in seconds: did "
        "you mean 2000 ms? Else write 2000 s"),
    "a room that is a number": ("time:", "rooms: {box: 3}\ntime:", "9:14: rooms.box: got 3, expected a mapping"),
    "a motion of nothing": ("time:", "initial: {rigid: {about: O}}\ntime:",
        "initial.rigid: got no velocity and no spin, expected a motion"),
}  # fmt: skip


@pytest.mark.parametrize("name", IN_STUDY)
def test_slips_in_a_study(name: str, tmp_path: Path) -> None:
    old, new, told = IN_STUDY[name]
    assert told in the_mistake(tmp_path, study=STUDY.replace(old, new, 1))


def test_a_misspelt_excitation_is_no_second_one(tmp_path: Path) -> None:
    """All names of a file are alike to cases: a new one goes under `add`."""
    study = STUDY.replace(HEAVY, "heavy: {vibration.shake: {at: O.z}}") + SHAKEN.replace(".", ": {", 1) + "}\n"
    assert "did you mean 'shaker'?; a new one goes under 'add:'" in the_mistake(tmp_path, study=study)


def test_cases_add_excitations_and_change_channels(tmp_path: Path) -> None:
    change = f"heavy: {{record.O.x: velocity, limits.O.z acceleration: 3, add: {{{SHAKEN}}}}}"
    plan = read_study(written(tmp_path, study=STUDY.replace(HEAVY, change)))
    light, heavy = (case.study for case in plan.cases)
    assert [one.name for one in heavy.vibration] == ["shaker"] and not light.vibration
    assert "O.x" in [one.target for one in heavy.records] and heavy.limits[0].name == "O.z acceleration"
    with_set = read_study(written(tmp_path), ["record.feet.1.z=velocity"])
    assert "feet.1.z" in [one.target for one in with_set.cases[0].study.records]


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("bodies.ball.mass=", "--set bodies.ball.mass=: got no PATH=VALUE"),
        ("bodies.ball.mass=[1, 2", "got broken YAML"),
        ("model.parts.sheet.thickness=3 mm", "write paths of the model without 'model.': parts.sheet.thickness"),
        ("thickness=3 mm", "which does not exist, expected a path of the files; did you mean 'parts.sheet.thickness'?"),
        ("mass=3 g", "did you mean 'bodies.ball.mass'?"),
        ("stiffness=3", "did you mean one of bodies.ball.contact.stiffness, parts.legs.stiffness?"),
        ("record.feet.9.z=velocity", "record.feet.9.z: got 'feet.9.z', expected a direction of a point; did you mean"),
    ],
)
def test_slips_of_set(override: str, told: str, tmp_path: Path) -> None:
    assert told in the_mistake(tmp_path, override)


def test_a_key_of_studies_is_named_as_such_for_a_model(tmp_path: Path) -> None:
    written(tmp_path)
    with pytest.raises(InputErrors, match="'bodies:' is a key of studies: name the study file"):
        read_model_file(tmp_path / "m.yaml", ["bodies.ball.mass=20 g"])
    with pytest.raises(InputErrors, match="there is no 'joints:' in the file"):
        read_model_file(tmp_path / "m.yaml", ["joints.glue.reach=20 mm"])


def test_names_in_other_unicode_are_told_as_such(tmp_path: Path) -> None:
    """As macOS writes Korean and umlauts: what looks the same is not the same text."""
    apart = unicodedata.normalize("NFD", "바닥")
    model = MODEL.replace("surfaces:", "  바닥: {on: sheet, at: center}\nsurfaces:")
    study = STUDY.replace("above: O", f"above: {apart}").replace(", ball on O: force", "")
    assert "'바닥' looks alike, but has other characters (Unicode)" in the_mistake(tmp_path, model=model, study=study)


def test_windows_files_are_read(tmp_path: Path) -> None:
    """Line ends of Windows and a byte order mark change no position."""
    path = written(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n").replace(b"10 g", b"10 N"))
    with pytest.raises(InputErrors, match=r"s\.study\.yaml:7:16: bodies\.ball\.mass: got '10 N'"):
        read_study(path)


@pytest.mark.parametrize(
    ("vary", "told"),
    [
        ("a.b=gauss(10 g, 1 g)", "got 'gauss(10 g, 1 g)', expected normal(MEAN, SD) or uniform(FROM, TO)"),
        ("a.b=Normal(10 g, 1 g)", "did you mean 'normal'?"),
        ("a.b=10 g:10 g:3", "vary.a.b: got 3 steps from 0.01 to 0.01, expected different values"),
        (
            "a.b=10 g:20",
            "got 20 without a unit beside a mass, expected a unit with every value, or with none; "
            "values are separated by commas, decimals by a point, as 1.5 kg; write 20 with its unit",
        ),
        ("a.b=10 g,10 g", "vary.a.b: got 10 g twice, expected each value once; remove one of them"),
    ],
)
def test_slips_of_vary(vary: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputErrors) as caught:
        read_campaign(written(tmp_path), [vary])
    assert told in caught.value.errors[0]


def test_values_between_two_others_have_no_digits_of_rounding(tmp_path: Path) -> None:
    """10 g, 20 g, 30 g: in kilograms the middle was 0.019999999999999997."""
    varied = read_campaign(written(tmp_path), ["bodies.ball.mass=10 g:30 g:3", "bodies.damper=null,{}"]).varied
    assert varied[0].texts == ("0.01 kg", "0.02 kg", "0.03 kg")  # type: ignore[union-attr]
    assert varied[1].texts == ("null", "{}")  # type: ignore[union-attr]


def test_what_varies_cannot_be_set_as_well(tmp_path: Path) -> None:
    with pytest.raises(InputErrors, match=r"--set bodies.ball.mass=3 g: got a path that varies, expected another path"):
        read_campaign(written(tmp_path), ["bodies.ball.mass=10 g:30 g:3"], ["bodies.ball.mass=3 g"])


def test_an_empty_vary_and_a_misspelt_one(tmp_path: Path) -> None:
    for key, told in (("vary", "add 'vary: {PATH"), ("Vary", "write 'vary' for 'Vary'")):
        with pytest.raises(InputErrors, match=told):
            read_campaign(written(tmp_path, study=f"{STUDY}{key}: {{}}\n"))


def test_slips_of_a_search(tmp_path: Path) -> None:
    vary = ["bodies.ball.mass=10 g:30 g"]
    with pytest.raises(InputErrors, match=r"^--minimise: got an empty text, expected the name of a number$"):
        read_search(written(tmp_path), "minimise ", vary)
    with pytest.raises(InputErrors, match=r":13:45: optimise.case: got 'Heavy', expected a case; did you mean 'heavy'"):
        study = f"{STUDY}optimise: {{minimise: ball on O force, case: Heavy}}\n"
        read_search(written(tmp_path, study=study), vary=vary)


def test_a_rigid_motion_of_what_is_held_is_refused(tmp_path: Path) -> None:
    """It ended in a traceback where there is no rigid-body mode at all."""
    study = STUDY.replace("time:", "initial: {rigid: {about: O, velocity: [0, 0, 1]}}\ntime:")
    plan = read_study(written(tmp_path, study=study))
    with pytest.raises(Exception, match=r"a motion that its 0 rigid-body modes do not contain \(100 %\)"):
        run_study(plan)


def test_a_line_at_a_resonance_without_damping_is_refused(tmp_path: Path) -> None:
    """The first model of many: an oscillator of 10 Hz and a response every hertz. It ended in a traceback."""
    closed = "structure: {type: oscillator, mass: 1 kg, frequency: 10 Hz}\npoints: {O: {}}\n"
    asked = (
        "model: m.yaml\nmodes: {count: 1}\nfrf: {a: {drive: O.z, response: O.z, kind: receptance, band: [9 Hz, 12 Hz], "
    )
    with pytest.raises(InputError, match="got 10 Hz, a natural frequency without damping, expected a finite response"):
        run_study(read_study(written(tmp_path, closed, f"{asked}step: 1 Hz}}}}\n")))
    beside = run_study(read_study(written(tmp_path, closed, f"{asked}step: 0.75 Hz}}}}\n"))).cases["as given"]
    omega, natural = 2 * np.pi * beside.frf["a"].frequency_hz, 2 * np.pi * 10.0
    assert beside.frf["a"].values == pytest.approx(1.0 / (natural**2 - omega**2), rel=1e-12)  # rounding: 1e-15 / 0.05


def test_a_small_m_is_no_capital_one() -> None:
    """MHz is a thousand million times mHz: it is not proposed for it."""
    with pytest.raises(QuantityError, match=r"unit 'mHz', expected .*; known units of a frequency: Hz, kHz, MHz"):
        quantity("2 mHz", "frequency")
    with pytest.raises(QuantityError, match=r"did you mean 'MPa'\?"):
        quantity("2 Mpa", "pressure")


def test_ranges_far_below_a_steep_line_are_endured_for_ever() -> None:
    """(1 kN / 1 uN)^300 is no number; a warning of numpy was printed."""
    assert np.isinf(SNLine(1e3, slope=300.0).endured(np.array([1e-6]))).all()


def test_check_tries_what_varies(tmp_path: Path) -> None:
    """A path or a unit that no sample can have is told by `check`, at its place; one end of a range may be wrong."""
    for key, value, told in (
        ("mas", "{values: [10 g, 20 g]}", r":13:8: vary bodies.ball.mas, value 10 g: .*did you mean 'mass'"),
        (
            "mass",
            "{from: 1 mm, to: 2 mm, steps: 3}",
            r":13:8: vary bodies.ball.mass, .*which is a length, expected a mass",
        ),
    ):
        path = written(tmp_path, study=f"{STUDY}vary: {{bodies.ball.{key}: {value}}}\n")
        with pytest.raises(InputErrors, match=told):
            campaigns_of(path)
    path = written(tmp_path, study=f"{STUDY}vary: {{bodies.ball.mass: {{from: 0 g, to: 20 g, steps: 3}}}}\n")
    assert campaigns_of(path) == {"femstruct sweep": "varies bodies.ball.mass"}


ALONE = {  # a value where a mapping is expected: file, old, new, what to write
    "damping": ("m", "damping: {ratio: 1 %}", "damping: 2 %", "14:10: damping: got '2 %'", "{loss_factor: 2 %}"),
    "losses": ("m", "damping: {ratio: 1 %}", "damping: materials", "got 'materials'", "{from: materials}"),
    "modes": ("s", "modes: {up_to: 500 Hz}", "modes: 400 Hz", "3:8: modes: got '400 Hz'", "{up_to: 400 Hz}"),
    "so many": ("s", "modes: {up_to: 500 Hz}", "modes: 20", "modes: got 20", "{count: 20} or {up_to: 20 Hz}"),
    "contact": ("s", "contact: {type: linear, stiffness: 10 kN/m}", "contact: hertz", "ball.contact: got 'hertz'",
        "{type: hertz, ...}"),
    "no law": ("s", "contact: {type: linear, stiffness: 10 kN/m}", "contact: herz", "contact: got 'herz'",
        "{type: hertz, ...}"),
    "material": ("m", "steel: {E: 210 GPa, nu: 0.3, rho: 7850}", "steel: steel", "3:10: materials.steel: got 'steel'",
        "{like: steel}"),
    "none": ("m", "steel: {E: 210 GPa, nu: 0.3, rho: 7850}", "steel: S235", "materials.steel: got 'S235'",
        "{E: 210 GPa, nu: 0.3, rho: 7850} or {like: C24}"),
    "room": ("s", "time:", "rooms: {box: {size: [5, 4, 2.5], under: top, losses: 0.5 s}}\ntime:", "losses: got '0.5 s'",
        "{t60: 0.5 s}"),
}  # fmt: skip


@pytest.mark.parametrize("name", ALONE)
def test_a_value_alone_is_answered_with_the_mapping_that_is_meant(name: str, tmp_path: Path) -> None:
    file, old, new, got, do = ALONE[name]
    changed = {"m": {"model": MODEL.replace(old, new)}, "s": {"study": STUDY.replace(old, new)}}[file]
    told = the_mistake(tmp_path, **changed)
    assert got in told and told.endswith(f", expected a mapping; write it like {do}")
