"""Tables of bands as analysers write them, beside the same numbers in the model; and spoilt ones."""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np

from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_BANDS: Final = (500.0, 630.0, 800.0, 1000.0, 1250.0, 1600.0)
_WRITTEN: Final = ("500", "630", "800", "1k", "1k25", "1.6k")


def _forms(times: list[float]) -> dict[str, tuple[str, str]]:
    """Tables by their encoding and a number, and the column that is meant."""
    dots = [f"{one:.4f}" for one in times]
    commas = [one.replace(".", ",") for one in dots]
    milli = [f"{1e3 * one:.1f}" for one in times]
    exact = [f"{1000 * 10 ** (k / 10):.2f}" for k in range(-3, 3)]
    kilo = [f"{one / 1e3:g}" for one in _BANDS]
    hertz = [f"{one:g}" for one in _BANDS]
    milli_commas, kilo_commas = (
        [one.replace(".", ",") for one in milli],
        [one.replace(".", ",") + " kHz" for one in kilo],
    )
    other = [f"{2 * one:.4f}" for one in times]

    def down(*columns: list[str], mark: str) -> list[str]:
        return [mark.join(row) for row in zip(*columns, strict=True)]

    across = [
        "Messung 7",
        f"Band;{';'.join(_WRITTEN)};Summe",
        f"T20 [s];{';'.join(one.replace('.', ',') for one in other)};1,0",
    ]
    across += [f"T30 / ms;{';'.join(one.replace('.', ',') for one in milli)};1,0"]
    tables = {
        "utf-8": (["Frequenz [Hz];T20 [s]", *down(hertz, commas, mark=";"), "", "Summe;0,5"], ""),
        "utf-16": (["# of a µ-analyser", "f [kHz]\tT [ms]", *down(kilo, milli, mark="\t"), "A\t500.0"], ""),
        "utf-8-sig": (["Room 3", "Band,T20 [s],T30 [s]", *down(list(_WRITTEN), other, dots, mark=",")], "T30"),
        "latin-1": (across, "T30"),
        "ascii": (down(exact, dots, mark="  "), ""),
        "cp1252": (["Band;T20", "Hz;ms", *down([f"{one} Hz" for one in hertz], milli_commas, mark=";"), "Lin;3,0"], ""),
        "utf-16-le": (["Band\tT20 [s]", *down(kilo_commas, commas, mark="\t")], ""),
        "utf-8 turned": ([";".join(hertz), ";".join(commas)], ""),
        "cp949": (["측정 3", "주파수 [Hz],잔향시간 [s]", *down(hertz, dots, mark=",")], ""),
        "cp932": (["測定、三回目", "周波数 [Hz],残響時間 [s]", *down(hertz, dots, mark=",")], ""),
        "cp1252 accents": (["Mesuré à l'école", "Fréquence;T", *down(hertz, commas, mark=";")], ""),
        "utf-16-be": (["f [Hz];T20 [s]", *down(hertz, commas, mark=";")], ""),
    }  # fmt: skip
    return {name: ("\n".join([*lines, ""]), column) for name, (lines, column) in tables.items()}


_MISTAKES: Final[dict[str, int]] = {  # a table, and the line at fault
    "f;T\n500;0,5\n630;0,4\n500;0,3": 4,
    "f;T\n500;0,5\n630;\n800;0,3": 3,
    "f;T\n500;0,5\n700;0,4\n800;0,3": 3,
    "f;T\n500;0,5\n630;long\n800;0,3": 3,
    "f;T\n500;0,5\nabove;0,4\n800;0,3": 3,
    "f;T\n500;0,5\n630;0,4;7\n800;0,3": 3,
    "f;T\n500;0,5\n630;0.4\n800;0,3": 3,
    "f;T\n500;1.000,5\n630;0,4\n800;0,3": 2,
    "f;T [Pa]\n500;0,5\n630;0,4": 1,
    "f;T [dB]\n500;0,5\n630;0,4": 1,
    "f;T20;T30\n500;0,5;0,4\n630;0,4;0,3": 2,
    "f;T\n500;0,5\n630;-0,4\n800;0,3": 3,
    "f;T\n500;0,5\n5;0,4\n800;0,3": 3,
    "nothing\nat all": 1,
    "Band;500;630;800\nT;0,5;0,4": 2,
    "Band;500;630;800": 1,
}


@capability("tables: bands as analysers write them", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Structural reverberation times from files of all forms; answers near each band."""
    times = [float(f"{2.2 / band / rng.uniform(0.02, 0.1):.4f}") for band in _BANDS]
    times = [max(one, 0.01) for one in times]
    a, b = rng.uniform([0.3, 0.2], [0.4, 0.28]).round(3).tolist()
    part = {"type": "plate", "material": "m", "origin": [0, 0, 0], "size": [a, b], "thickness": 0.003, "mesh": 0.05}
    draft: Draft = {
        "materials": {"m": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": [0.31 * a, 0.27 * b]}},
        "supports": {"rim": {"on": "p", "edge": "all", "fix": "simple"}},
        "damping": {"from": "materials"},
        "times": times,
    }  # fmt: skip

    def answer(model: Model, door: Door, times: Any, **files: str | bytes) -> Floats:
        inner = {key: one for key, one in model.items() if key != "times"}
        inner["materials"] = {"m": {**model["materials"]["m"], "loss_factor": {"reverberation_times": times}}}
        words = ("--drive", "q.z", "--response", "q.z", "--band", "450 Hz:1650 Hz", "--step", "100 Hz")
        found = door.ask(inner, "frf", *words, "--method", "direct", **files)
        door.told = []
        return np.r_[found["real"], found["imag"]]

    def asked(model: Model, door: Door) -> Floats:
        out = []
        for name, (table, column) in _forms(model["times"]).items():
            said = {"file": "t.csv", **({"column": column} if column else {})}
            out.append(answer(model, door, said, **{"t.csv": table.encode(name.split()[0])}))
        return np.array(out)

    def right(model: Model, door: Door) -> Floats:
        own = {f"{band:g} Hz": f"{time} s" for band, time in zip(_BANDS, model["times"], strict=True)}
        return np.tile(answer(model, door, own), (len(_forms(model["times"])), 1))

    return Case(draft, asked, right, 1e-6, "the same numbers, to four digits of a second, which are drawn so")


@capability("tables: spoilt ones are refused with their line", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    a = float(rng.uniform(0.3, 0.4))

    def asked(model: Model, door: Door) -> Floats:
        found = []
        for mistake in _MISTAKES:
            inner: Draft = {
                "materials": {"m": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}},
                "damping": {"from": "materials"},
            }
            inner["materials"]["m"]["loss_factor"] = {"reverberation_times": {"file": "t.csv"}}
            part = {
                "type": "plate",
                "material": "m",
                "origin": [0, 0, 0],
                "size": [a, a],
                "thickness": 0.003,
                "mesh": 0.1,
            }
            inner["parts"] = {"p": part}
            try:
                door.ask(inner, "modes", "--count", "1", **{"t.csv": mistake + "\n"})
                found.append(0)
            except Refused as told:
                line = re.search(r"t\.csv:(\d+):", str(told))
                found.append(int(line[1]) if line else -1)
        return np.array(found)

    return Case({"side": a}, asked, lambda *_: np.array(list(_MISTAKES.values())), 1e-12, "lines; they are whole")
