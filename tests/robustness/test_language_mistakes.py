"""Seeded mistakes: each one line, file:line:column, what was got, what was expected, what to do; all in one pass."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file

MODELS = Path(__file__).parents[2] / "models"
MODEL, STUDY = "floor_frame_slab.yaml", "floor_tennis_ball.study.yaml"


def folder(tmp_path: Path, edits: dict[str, tuple[str, str]]) -> Path:
    """The floor's two files in a folder, with a text replaced in one of them."""
    for name in (MODEL, STUDY):
        text = (MODELS / name).read_text(encoding="utf-8")
        if name in edits:
            old, new = edits[name]
            assert old in text, f"the sample does not hold {old!r}"
            text = text.replace(old, new, 1)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def place(path: Path, text: str) -> str:
    """line:column of the first occurrence of a text in a file."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if text in line:
            return f"{number}:{line.index(text) + 1}"
    raise AssertionError(f"no {text!r} in {path}")


# file, text replaced, replacement, text whose position is told, what the line says after the position
MISTAKES = {
    "unknown key": (MODEL, "thickness: 5 mm", "thicknes: 5 mm", "thicknes:",
        r"parts\.floor\.thicknes: got the unknown key 'thicknes'.*did you mean 'thickness'\?"),
    "missing key": (MODEL, ", thickness: 5 mm", "", "floor: {type",
        r"parts\.floor\.thickness: got nothing, expected 'thickness'; add 'thickness: \.\.\.'"),
    "wrong dimension": (MODEL, "E: 5.9 GPa", "E: 5.9 mm", "5.9 mm",
        r"materials\.acrylic\.E: got '5\.9 mm', which is a length, expected a pressure \[Pa\]"),
    "comma decimal": (MODEL, "width: 7.216 mm", "width: '7,216 mm'", "'7,216 mm'",
        r"sections\.bar\.width: got '7,216 mm' with a comma.*write a decimal point: 7\.216 mm"),
    "rad/s for Hz": (MODEL, "near: 19.9 Hz", "near: 125 rad/s", "125 rad/s",
        r"damping\.modes\.4\.near: got '125 rad/s'.*in Hz it is 19\.8944 Hz"),
    "rpm for Hz": (STUDY, "up_to: 3 kHz", "up_to: 3000 rpm", "3000 rpm", r"modes\.up_to: .*in Hz it is 50 Hz"),
    "unknown unit": (STUDY, "mass: 54 g", "mass: 54 gramm", "54 gramm", r"bodies\.ball\.mass: .*unknown unit 'gramm'"),
    "missing material": (MODEL, "material: acrylic", "material: acryl", "acryl,",
        r"parts\.floor\.material: got 'acryl', expected the name of a material; did you mean 'acrylic'\?"),
    "missing part": (MODEL, "O_f: {on: floor", "O_f: {on: flor", "flor,", r"points\.O_f\.on: .*did you mean 'floor'\?"),
    "missing joint part": (MODEL, "connect: [edge, floor]", "connect: [edges, floor]", "edges, ",
        r"joints\.edge on floor\.connect\[0\]: .*did you mean 'edge'\?"),
    "missing point": (STUDY, "above: O_f", "above: O_g", "O_g", r"bodies\.ball\.above: .*the name of a point, body"),
    "missing end": (STUDY, "between: [ball, O_f]", "between: [bal, O_f]", "bal,",
        r"contacts\.ball on floor\.between\[0\]: got 'bal'.*did you mean 'ball'\?"),
    "body without contact": (STUDY, "between: [ball, O_f]", "between: [O_s, O_f]", "{mass: 54 g,",
        r"bodies\.ball: got a body that moves towards 'O_f', without a contact: it would pass through, expected a law "
        r"between it and what it strikes; add 'contact: .*or name it in 'contacts' or 'links'"),
    "missing surface": (STUDY, "under: ceiling", "under: celing", "celing", r"rooms\.box\.under: .*'ceiling'\?"),
    "unknown record": (STUDY, "O_s.z: velocity", "O_t.z: velocity", "O_t.z",
        r"record\.O_t\.z: got 'O_t\.z', expected a direction of a point"),
    "wrong direction": (STUDY, "{drive: O_s.z", "{drive: O_s.w", "O_s.w", r"frf\.slab centre\.drive: got 'O_s\.w'"),
    "duplicate key": (STUDY, "gravity: false", "gravity: false, duration: 1 s", "duration: 1 s",
        r"time\.duration: got 'duration' twice \(first in line \d+\)"),
    "duplicate name": (MODEL, "  B:   {on", "  slab: {on: floor, at: center}\n  B:   {on", "slab: {on: floor",
        r"points\.slab: got 'slab', which names one of the parts already"),
    "name with a dot": (MODEL, "  B:   {on", "  B.1: {on: floor, at: center}\n  B:   {on", "B.1",
        r"points\.B\.1: got the name 'B\.1', expected a name without dots; write B_1"),
    "negative thickness": (MODEL, "thickness: 5 mm", "thickness: -5 mm", "-5 mm",
        r"parts\.floor\.thickness: got '-5 mm', expected a positive value: a length"),
    "negative mass": (STUDY, "mass: 0.45 kg", "mass: -0.45 kg", "-0.45 kg", r"bodies\.damper\.mass: got '-0\.45 kg'"),
    "nan": (MODEL, "rho: 7850", "rho: .nan", ".nan", r"materials\.steel\.rho: got nan, expected .*finite number"),
    "infinity": (STUDY, "duration: 2 s", "duration: .inf", ".inf", r"time\.duration: got inf, .*finite number"),
    "boolean": (STUDY, "mass: 54 g", "mass: true", "true", r"bodies\.ball\.mass: got true, expected a mass"),
    "wrong type": (MODEL, "size: [0.4, 0.32]", "size: 0.4 m", "0.4 m",
        r"parts\.floor\.size: got '0\.4 m', expected a list; write it like \[1, 2\]"),
    "too few coordinates": (MODEL, "[-0.2, -0.16, 0.08], size", "[-0.2, -0.16], size", "[-0.2, -0.16], size",
        r"parts\.floor\.origin: got a list that is too short, expected at least 3 values"),
    "too many coordinates": (MODEL, "size: [0.4, 0.32]", "size: [0.4, 0.32, 1]", "[0.4, 0.32, 1]",
        r"parts\.floor\.size: got 3 values, expected 2"),
    "decimal comma in a list": (MODEL, "size: [0.4, 0.32]", "size: [0,4, 0.32]", "[0,4, 0.32]",
        r"parts\.floor\.size: got 3 values, expected 2; write decimals with a point"),
    "no space after a colon": (MODEL, "thickness: 5 mm", "thickness:5 mm", "thickness:5 mm",
        r"parts\.floor\.thickness:5 mm: got the unknown key 'thickness:5 mm'.*; write a space after the colon"),
    "yes for true": (STUDY, "gravity: false", "gravity: no", "no}", r"time\.gravity: got 'no', expected true or false"),
    "percent forgotten": (MODEL, "ratio: 1.8 %", "ratio: 1.8", "1.8,",
        r"damping\.modes\.7\.ratio: got 1\.8, expected a ratio below 1; .*did you mean 1\.8 %\?"),
    "two laws of damping": (MODEL, "  ratio: 2 %\n", "  ratio: 2 %\n  loss_factor: 4 %\n", "ratio: 2 %",
        r"damping: got both ratio and loss_factor, expected exactly one"),
    "unknown kind": (STUDY, "type: hertz, stiffness: 3.7e5", "type: herz, stiffness: 3.7e5", "herz",
        r"contacts\.ball on floor\.law\.type: got 'herz', expected one of cubic, .*hertz, .*table; "
        r"did you mean 'hertz'\?"),
    "unknown word": (MODEL, "element: hermite12", "element: hermit12", "hermit12",
        r"parts\.floor\.element: .*'hermite12'\?"),
    "stiffness per area on a rim": (MODEL, "normal: 2.21e5 N/m^2", "normal: 2.21e5 N/m^3", "2.21e5 N/m^3",
        r"parts\.foam\.stiffness\.normal: got a stiffness in N/m\^3, expected N/m\^2"),
    "case path": (STUDY, "{bodies.damper.mass: 0.90 kg}", "{bodies.dumper.mass: 0.90 kg}", "bodies.dumper.mass",
        r"cases\.damper 1\.2\.bodies\.dumper\.mass: got the path 'bodies\.dumper\.mass', which does not exist.*"
        r"did you mean 'damper'\?"),
    "case key": (STUDY, "{bodies.damper.mass: 0.90 kg}", "{bodies.damper.mas: 0.90 kg}", "bodies.damper.mas:",
        r"bodies\.damper\.mas: got the unknown key 'mas'.*did you mean 'mass'\?"),
    "case value": (STUDY, "0.90 kg", "0.90 m", "0.90 m", r"bodies\.damper\.mass: got '0\.90 m', which is a length"),
    "case removes nothing": (STUDY, "[bodies.damper]", "[bodies.dampr]", "bodies.dampr", r".*did you mean 'damper'\?"),
    "baseline": (STUDY, "baseline: without damper", "baseline: without", "without}",
        r"compare\.baseline: got 'without'"),
    "contacts that disagree": (STUDY, "0.23 m}", "0.23 m, contact: {type: linear, stiffness: 1}}",
        "contact: {type: linear", r"bodies\.ball\.contact: got a contact that disagrees with"),
    "two places of a body": (STUDY, "above: O_f,", "above: O_f, below: O_s,", "{mass: 54 g",
        r"bodies\.ball: got both above and below, expected exactly one of above, below, before, after"),
    "receiver outside": (STUDY, "mic: [0.29, 0.235, 0.05]", "mic: [0.29, 0.235, 5]", "[0.29, 0.235, 5]",
        r"rooms\.box\.receivers\.mic: got \[0\.29, 0\.235, 5\.0\] m, expected a point of the room"),
    "model that is not there": (STUDY, "model: floor_frame_slab.yaml", "model: floor_frame_slap.yaml",
        "floor_frame_slap.yaml", r"model: got no file .*did you mean 'floor_frame_slab\.yaml'\?"),
    "leak one-way": (STUDY, "coupling: one-way", "leak: {inertance: 22}, coupling: one-way", "leak:",
        r"rooms\.box\.leak: got a leak with one-way coupling, expected coupling: two-way; add it"),
    "leak without a length": (STUDY, "coupling: one-way", "leak: {area: 10 mm^2}, coupling: two-way", "{area",
        r"rooms\.box\.leak: got an area without a length, expected both, or an inertance"),
    "two-way without a cause": (STUDY, "coupling: one-way", "form: source, coupling: two-way", "source,",
        r"rooms\.box\.form: got the source's form with two-way coupling in time, expected causal"),
    "pressure of no receiver": (STUDY, "{drive: O_s.z, response: O_s.z, kind: accelerance",
        "{drive: O_s.z, response: box.mike.pressure, kind: pressure", "box.mike",
        r"frf\.slab centre\.response: got 'box\.mike\.pressure', expected ROOM\.RECEIVER\.pressure; "
        r"did you mean 'box\.mic\.pressure'\?"),
    "pressure of another kind": (STUDY, "{drive: O_s.z, response: O_s.z, kind: accelerance",
        "{drive: O_s.z, response: box.mic.pressure, kind: mobility", "mobility",
        r"frf\.slab centre\.kind: got 'mobility' of a pressure, expected pressure"),
    "t60 of bands in no unit of time": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{t60: {63 Hz: 1 m}}", "{63 Hz",
        r"rooms\.box\.losses\.t60: got '1 m', which is a length, expected a time"),
    "t60 of no band": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{t60: {}}", "{}",
        r"rooms\.box\.losses\.t60: got no band, expected a reverberation time for one band or more"),
    "limit of nothing recorded": (STUDY, "compare:", "limits: {ground force: 600 kN}\ncompare:", "ground force",
        r"limits\.ground force: got 'ground force', expected a recorded channel, TARGET QUANTITY, a rated room, "
        r"ROOM rating, or settled; .*"
        r"add 'ground: force' under 'record:'"),
    "misspelt limit": (STUDY, "compare:", "limits: {setled: 1 s}\ncompare:", "setled",
        r"limits\.setled: got 'setled', .*did you mean 'settled'\?"),
    "limit in another dimension": (STUDY, "compare:", "limits: {O_s.z velocity: 5 mm}\ncompare:", "5 mm}",
        r"limits\.O_s\.z velocity: got a length, expected a speed \[m/s\]; write it like 1\.2 m/s"),
    "limit of time in another dimension": (STUDY, "compare:", "limits: {settled: 5 kN}\ncompare:", "5 kN}",
        r"limits\.settled: got a force, expected a time \[s\]"),
    "limit of a room that is not rated": (STUDY, "compare:", "limits: {box rating: 53 dB}\ncompare:", "box rating",
        r"limits\.box rating: got a limit of the rating of 'box', which is not rated, expected a rated room; "
        r"add 'levels: \[ISO 16283-2, ISO 717-2\]' under 'rooms\.box'"),
    "limit of no room": (STUDY, "compare:", "limits: {bax rating: 53 dB}\ncompare:", "bax rating",
        r"limits\.bax rating: got 'bax rating', expected a recorded channel, TARGET QUANTITY, a rated room"),
    "limit in decibels": (STUDY, "compare:", "limits: {settled: 53 dB}\ncompare:", "53 dB}",
        r"limits\.settled: got a level, expected a time \[s\]"),
    "decibels for a ratio": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{beta: 1.16 dB, at: 293 Hz}", "1.16 dB",
        r"rooms\.box\.losses\.beta: got '1\.16 dB', which is a level, expected a ratio"),
    "negative limit": (STUDY, "compare:", "limits: {settled: -5 s}\ncompare:", "-5 s}",
        r"limits\.settled: got '-5 s', expected a positive value"),
    "joint without stiffness": (MODEL, "{connect: [edge, floor]}", "{connect: [edge, floor], stiffness: {rz: 0}}",
        "0}}",
        r"joints\.edge on floor\.stiffness\.rz: got 0, expected a positive stiffness; leave the direction out"),
    "negative stiffness of a joint": (MODEL, "{connect: [edge, floor]}",
        "{connect: [edge, floor], stiffness: {x: -1 N/m}}", "-1 N/m",
        r"joints\.edge on floor\.stiffness\.x: got '-1 N/m', expected a stiffness of at least 0; remove the sign"),
    "joint with springs per length and by node": (MODEL, "{connect: [edge, floor]}",
        "{connect: [edge, floor], stiffness: {x: 1 N/m^2, z: 1 N/m}}", "1 N/m}}",
        r"joints\.edge on floor\.stiffness\.z: got a stiffness of springs at pairs of nodes beside one per length, "
        r"expected N/m\^2, per length, as the others"),
    "layer without stiffness": (MODEL, "{normal: 2.21e5 N/m^2, shear: 7.3e4 N/m^2}", "{normal: 0 N/m^2}", "{normal: 0",
        r"parts\.foam\.stiffness: got no stiffness at all, expected a positive normal or shear stiffness"),
    "negative stiffness of a layer": (MODEL, "normal: 2.21e5 N/m^2", "normal: -2.21e5 N/m^2", "-2.21e5",
        r"parts\.foam\.stiffness\.normal: got '-2\.21e5 N/m\^2', expected a stiffness per length of at least 0"),
    "density of a million": (MODEL, "rho: 2400}", "rho: 2.4e6}", "2.4e6",
        r"materials\.concrete\.rho: got 2\.4e\+06 kg/m\^3, expected a density; the densest solid has 23000 kg/m\^3; "
        r"plain numbers are kg/m\^3: 2400\?"),
    "thickness in millimetres": (MODEL, "thickness: 30 mm", "thickness: 210", "210",
        r"parts\.slab\.thickness: got 210 m, expected at most the plate's shorter side, 0\.57 m; .*: 210 mm\?"),
    "loss factor in percent": (MODEL, "rho: 7850}", "rho: 7850, loss_factor: 1.99}", "1.99",
        r"materials\.steel\.loss_factor: got 1\.99, expected a ratio of at most 1\.5; .*did you mean 1\.99 %\?"),
    "structural loss factor in percent": (MODEL, "  ratio: 2 %\n", "  loss_factor: 1.99\n", "1.99",
        r"damping\.loss_factor: got 1\.99, expected a ratio of at most 1; 2 % is 0\.02: did you mean 1\.99 %\?"),
    "drop of kilometres": (STUDY, "drop_height: 0.23 m}\n  damper", "drop_height: 2.3 km}\n  damper", "2.3 km",
        r"bodies\.ball\.drop_height: got '2\.3 km', expected a length of at most 100 m; "
        r"a plain number is in metres: did you mean 2300 mm\?"),
    "drop in millimetres": (STUDY, "drop_height: 0.23 m}\n  damper", "drop_height: 230}\n  damper", "230}",
        r"bodies\.ball\.drop_height: got 230, .*did you mean 230 mm\?"),
    "speed in millimetres": (STUDY, "drop_height: 0.23 m}\n  damper", "speed: 2100}\n  damper", "2100}",
        r"bodies\.ball\.speed: got 2100, expected a speed of at most 1000 m/s; .*did you mean 2100 mm/s\?"),
    "t60 in milliseconds": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{t60: 500}", "500}",
        r"rooms\.box\.losses\.t60: got 500, expected a time of at most 120 s; "
        r"a plain number is in seconds: did you mean 500 ms\?"),
    "t60 of a band in milliseconds": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{t60: {63 Hz: 500 s}}", "{63 Hz",
        r"rooms\.box\.losses\.t60: got '500 s', expected a time of at most 120 s"),
    "t60 of a microsecond": (STUDY, "{beta: 1.16 %, at: 293 Hz}", "{t60: 1e-6 s}", "1e-6 s",
        r"rooms\.box\.losses\.t60: got '1e-6 s', expected a time of at least 0\.001 s"),
    "t60 shorter than the room": (STUDY,
        "size: [0.58, 0.47, 0.1], under: ceiling, air: {c: 340, rho: 1.29}, losses: {beta: 1.16 %, at: 293 Hz}",
        "size: [5.8, 4.7, 2.5], under: ceiling, air: {c: 340}, losses: {t60: 2 ms}", "2 ms",
        r"rooms\.box\.losses\.t60: got 2 ms, less than sound takes from wall to wall, 7\.5 ms, expected a "
        r"reverberation time: sound falls by 60 dB in it; did you mean 2 s\?"),
    "speed of sound": (STUDY, "air: {c: 340,", "air: {c: 3400,", "3400",
        r"rooms\.box\.air\.c: got 3400, expected a speed of at most 2000 m/s; air has 343 m/s"),
    "speed of sound in km/s": (STUDY, "air: {c: 340,", "air: {c: 0.34,", "0.34",
        r"rooms\.box\.air\.c: got 0\.34, expected a speed of at least 50 m/s; air has 343 m/s"),
    "air in grams": (STUDY, "rho: 1.29}", "rho: 1290}", "1290}",
        r"rooms\.box\.air\.rho: got 1290 kg/m\^3 beside a speed of sound of 340 m/s, expected a gas below 1000 kg/m"),
    "room in millimetres": (STUDY, "size: [0.58, 0.47, 0.1]", "size: [5800, 0.47, 0.1]", "5800",
        r"rooms\.box\.size\[0\]: got 5800, expected a length of at most 1000 m; .*did you mean 5800 mm\?"),
    "three sides of a patch": (MODEL, "at: [0.3, 0.24]", "at: [0.3, 0.24], patch: [1 cm, 2 cm, 3 cm]", "[1 cm",
        r"points\.B\.patch: got .*, expected a radius, or two sides; write it like 5 mm or \[20 mm, 30 mm\]"),
    "patch without size": (MODEL, "at: [0.3, 0.24]", "at: [0.3, 0.24], patch: 0.00 mm", "0.00 mm",
        r"points\.B\.patch: got '0\.00 mm', expected a positive value: a length"),
    "patch of a frame": (MODEL, "  B:   {on", "  C: {on: posts, at: [0, 0, 0], patch: 7 mm}\n  B:   {on", "7 mm}",
        r"points\.C\.patch: got a patch on a frame, expected a patch on a plate; remove it"),
    "source with a mass": (STUDY, "ball:   {mass: 54 g", "ball:   {source: rubber ball, mass: 54 g", "{source",
        r"bodies\.ball: got 'mass' with a rubber ball, expected only a source: it has its own mass; remove 'mass'"),
    "source with a height": (STUDY, "ball:   {mass: 54 g", "ball:   {source: bang machine", "{source",
        r"bodies\.ball: got 'drop_height' with a bang machine, expected only a source"),
    "unknown source": (STUDY, "ball:   {mass: 54 g", "ball:   {source: ruber ball, mass: 54 g", "ruber ball",
        r"bodies\.ball\.source: got 'ruber ball', expected one of .*; did you mean 'rubber ball'\?"),
    "tapping machine at one place": (STUDY, "mass: 54 g, above: O_f, drop_height: 0.23 m}",
        "source: tapping machine, above: O_s, contact: {type: hertz, stiffness: 1e9}}", "O_s, contact: {type",
        r"bodies\.ball\.above: got 1 place for the 5 hammers of a tapping machine, expected a point of 5 places"),
    "misspelt place of a tapping machine": (STUDY, "mass: 54 g, above: O_f, drop_height: 0.23 m}",
        "source: tapping machine, above: O_ss, contact: {type: hertz, stiffness: 1e9}}", "O_ss, contact: {type",
        r"bodies\.ball\.above: got 'O_ss', expected the name of a point, body or ground; did you mean 'O_s'\?"),
    "misspelt machine": (STUDY, "mass: 54 g, above: O_f, drop_height: 0.23 m}",
        "source: taping machine, above: O_s, blows: {timing: scattered}}", "taping machine, above",
        r"bodies\.ball\.source: got 'taping machine', expected one of .*; did you mean 'tapping machine'\?"),
    "tapping machine without a law": (STUDY, "mass: 54 g, above: O_f, drop_height: 0.23 m}",
        "source: tapping machine, above: O_f}", "{source",
        r"bodies\.ball: got a tapping machine without a contact, expected the law between its hammers"),
    "levels of no standard": (STUDY, "coupling: one-way", "coupling: one-way, levels: [ISO 717-1]", "[ISO 717-1",
        r"rooms\.box\.levels: got 'ISO 717-1', expected one of ISO 16283-2, ISO 717-2, .*; did you mean 'ISO 717-2'\?"),
    "levels of two kinds": (STUDY, "coupling: one-way", "coupling: one-way, levels: [KS F 2863-2, ISO 717-2]", "[KS F",
        r"rooms\.box\.levels: got ISO 717-2, in third octaves, with KS F 2863-2, in octaves, expected standards of the "
        r"same bands; for the other, add a second room"),
    "levels without a time": (STUDY, "losses: {beta: 1.16 %, at: 293 Hz},", "levels: ISO 16283-2,", "ISO 16283-2,",
        r"rooms\.box\.levels: got ISO 16283-2 in a room without losses, expected its reverberation time"),
    "levels for nobody": (STUDY, "receivers: {mic: [0.29, 0.235, 0.05]}", "levels: ISO 717-2", "ISO 717-2, coupl",
        r"rooms\.box\.levels: got levels without receivers, expected at least one receiver"),
    "unknown kind of part": (MODEL, "floor: {type: plate", "floor: {type: membrane", "membrane",
        r"parts\.floor\.type: got 'membrane', expected one of attachments, block, .*, plate, [^;]*$"),
    "layers beside a thickness": (MODEL, "thickness: 5 mm", "thickness: 5 mm, layers: []", "{type: plate",
        r"parts\.floor: got both material and layers, expected exactly one of material, layers, smeared"),
    "on and between": (MODEL, "on: slab, region: {rim", "between: [slab, floor], on: slab, region: {rim",
        "{type: foundation",
        r"parts\.foam: got both on and between, expected exactly one of on, between; remove all but one"),
    "between itself": (MODEL, "on: slab, region: {rim: [0.58, 0.47]}, side: middle",
        "between: [slab, slab], region: {rim: [0.58, 0.47]}", "[slab, slab]",
        r"parts\.foam\.between: got 'slab' twice, expected two different parts"),
    "between a frame": (MODEL, "on: slab, region: {rim: [0.58, 0.47]}, side: middle",
        "between: [slab, posts], region: {rim: [0.58, 0.47]}", "posts], region",
        r"parts\.foam\.between\[1\]: got 'posts', of type frame, expected the name of a plate, slab or block"),
    "block without mass": (MODEL, "foam: {", "lump: {type: block, origin: [0, 0, 1], size: [1, 1, 1]}\n  foam: {",
        "lump: {type", r"parts\.lump\.mass: got nothing, expected 'mass'"),
    "block in grams per": (MODEL, "foam: {",
        "lump: {type: block, mass: 3 kg/m, origin: [0, 0, 1], size: [1, 1, 1]}\n  foam: {", "3 kg/m",
        r"parts\.lump\.mass: got '3 kg/m', which is a mass per length, expected a mass \[kg\]"),
    "inertia of a block": (MODEL, "foam: {",
        "lump: {type: block, mass: 3, inertia: [1, 2, 3 kg], origin: [0, 0, 1], size: [1, 1, 1]}\n  foam: {", "3 kg]",
        r"parts\.lump\.inertia\[2\]: got '3 kg', which is a mass, expected a moment of inertia \[kg\*m\^2\]"),
    "top of a plate": (MODEL, "at: [0.3, 0.24]", "at: top", "top}",
        r"points\.B\.at: got top of a plate, expected center or \[x, y\]; write center"),
    "edge of a frame": (MODEL, "damping: ", "supports: {s: {on: posts, edge: x0, fix: simple}}\ndamping: ",
        "posts, edge",
        r"supports\.s\.on: got 'posts', of type frame, expected the name of a plate"),
    "point off its part": (MODEL, "at: [0.3, 0.24]", "at: [0.3, 0.34]", "[0.3, 0.34]",
        r"points\.B\.at: got \[0\.3, 0\.34\] m, expected a place on the plate, 0\.4 m x 0\.32 m; measure from"),
    "filter above the sampling": (STUDY, "lowpass: none", "lowpass: 30 kHz", "30 kHz",
        r"peaks\.lowpass: got 30000 Hz, expected less than half the sampling, 24000 Hz"),
    "endless samples": (STUDY, "duration: 2 s", "duration: 2e6 s", "{duration: 2e6",
        r"time: got 9\.6e\+10 samples, expected at most 2e\+07; shorten"),
    "number cut at its comma": (MODEL, "thickness: 5 mm", "thickness: 0,005", "005,",
        r"parts\.floor\.005: got the unknown key '005', .*; write decimals with a point: a comma begins the next item"),
    "plate in millimetres": (MODEL, "size: [0.4, 0.32]", "size: [4000, 0.32]", "4000",
        r"parts\.floor\.size\[0\]: got 4000, expected a length of at most 1000 m; .*did you mean 4000 mm\?"),
    "unit of another system": (MODEL, "thickness: 5 mm", "thickness: 0.2 inch", "0.2 inch",
        r"parts\.floor\.thickness: got '0\.2 inch' with an unknown unit 'inch', expected a length \[m\]; "
        r"known units of a length: m, nm, µm, mm, cm, km$"),
    "list in place of a length": (MODEL, "thickness: 5 mm", "thickness: [5 mm, 6 mm]", "[5 mm, 6 mm]",
        r"parts\.floor\.thickness: got a list \[5 mm, 6 mm\], expected a length"),
    "quote that is not closed": (MODEL, "title: Floor", 'title: "Floor', '"Floor',
        r"got broken YAML \(while scanning a quoted scalar .*; close the quote that begins here"),
    "broken YAML": (MODEL, "concrete: {E", "concrete: E", "}\nsections", r"got broken YAML"),
    "bracket that is not closed": (MODEL, "rho: 2400}", "rho: 2400", "sections:",
        r"got broken YAML \(while parsing a flow mapping .*; check brackets, commas and quotes from line \d+ on"),
    "a tag": (STUDY, "mass: 54 g", "mass: !!python/object:os.system 54", "!!python", r".*remove the tag"),
    "a date": (STUDY, "mass: 54 g", "mass: 2026-01-02", "2026-01-02", r"bodies\.ball\.mass: got '2026-01-02'"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_one_mistake_is_one_line_with_its_position(name: str, tmp_path: Path) -> None:
    file, old, new, told_at, message = MISTAKES[name]
    here = folder(tmp_path, {file: (old, new)})
    with pytest.raises(InputErrors) as caught:
        read_study(here / STUDY)
    assert len(caught.value.errors) == 1, caught.value.errors
    line = caught.value.errors[0]
    assert line.isprintable()
    position = "" if name in ("broken YAML", "bracket that is not closed") else place(here / file, told_at)
    if position:
        assert line.startswith(f"{here / file}:{position}: "), line
        assert re.match(message, line.removeprefix(f"{here / file}:{position}: ")), line
    else:
        assert re.match(rf"{re.escape(str(here / file))}:\d+:\d+: {message}", line), line


def test_all_mistakes_of_both_files_and_the_cases_come_in_one_pass(tmp_path: Path) -> None:
    here = folder(tmp_path, {MODEL: ("thickness: 5 mm", "thickness: 5 Pa"), STUDY: ("mass: 54 g", "mas: 54 g")})
    study = here / STUDY
    study.write_text(
        study.read_text().replace("under: ceiling", "under: 5").replace("[bodies.damper]", "[bodies.nobody]")
    )
    with pytest.raises(InputErrors) as caught:
        read_study(study)
    text = "\n".join(caught.value.errors)
    for piece in (
        "parts.floor.thickness",
        "bodies.ball.mas:",
        "under: got 5",
        "nobody",
    ):
        assert piece in text, text
    assert len(caught.value.errors) == 4


FILES = {
    "empty": (b"", r":1:1: got an empty file, expected a mapping"),
    "only a comment": (b"# nothing\n", r":1:1: got an empty file"),
    "binary": (bytes(range(256)), r":1:1: got binary data"),
    "control characters": (b"title: \x00\x01", r":1:1: got characters that are not text"),
    "a list": (b"- 1\n- 2\n", r":1:1: got a list, expected a mapping"),
    "a word": (b"hello\n", r":1:1: got text, expected a mapping"),
    "two documents": (b"title: a\n---\ntitle: b\n", r":2:1: got broken YAML"),
    "tabs": (b"parts:\n\tfloor: 1\n", r":2:1: got broken YAML"),
    "unknown alias": (b"parts: *nothing\n", r":1:8: got broken YAML"),
    "endless nesting": (b"[" * 5000, r":1:1: got endless nesting"),
    "circular alias": (b"parts: &a {b: *a}\n", r"got aliases \(\*name\) or lists that expand endlessly"),
    "a study for a model": (b"model: x.yaml\nbodies: {}\n", r":1:1: model: got a study file, expected a model file"),
    "a list as a key": (b"? [1, 2]\n: 3\n", r":1:3: got a list or mapping as a key"),
    "too large": (b"#" * 600_000, r":1:1: got a file of 600000 bytes, expected at most 500000"),
}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_no_models(name: str, tmp_path: Path) -> None:
    content, message = FILES[name]
    path = tmp_path / "model.yaml"
    path.write_bytes(content)
    with pytest.raises(InputErrors) as caught:
        read_model_file(path)
    assert re.search(rf"^{re.escape(str(path))}(:\d+:\d+)?.*{message}", caught.value.errors[0]), caught.value.errors


def test_a_missing_file_names_the_nearest(tmp_path: Path) -> None:
    (tmp_path / "floor.yaml").write_text("title: x")
    with pytest.raises(InputErrors, match=r"flor\.yaml:1:1: got no file .*did you mean 'floor\.yaml'\?"):
        read_model_file(tmp_path / "flor.yaml")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputErrors, match=r":1:1: got the folder .*expected a YAML file; name a file in it"):
        read_study(tmp_path)


def test_an_alias_bomb_is_refused_quickly(tmp_path: Path) -> None:
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 30)]
    path = tmp_path / "bomb.yaml"
    path.write_text("\n".join(lines))
    start = time.process_time()
    with pytest.raises(InputErrors, match="expand endlessly") as caught:
        read_model_file(path)
    assert len(caught.value.errors) == 1
    assert time.process_time() - start < 5.0  # unfolding 10^29 values would not end


def test_aliases_that_help_are_read(tmp_path: Path) -> None:
    here = folder(tmp_path, {MODEL: ("size: [0.4, 0.32]", "size: &floor_size [0.4, 0.32]")})
    model = here / MODEL
    model.write_text(model.read_text().replace("at: [0.3, 0.24]", "at: *floor_size"))
    assert read_model_file(model).title.startswith("Floor")
