"""A study's results as one page, for a browser and for paper: what was asked, what came out, what forbids trust; the
rest in folds.
"""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from math import isnan
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from femstruct.errors import list_some
from femstruct.files.tables import findings_by_case
from femstruct.files.writing import replacing
from femstruct.findings.entry import Rank
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping import damped_modes
from femstruct.model.materials import Given
from femstruct.sound.cavity_coupling import WOOL
from femstruct.study.inputs import Difference, Inputs, differences, inputs
from femstruct.study.results import StudyResult
from femstruct.study.study import Case, Plan
from femstruct.view.answer_tables import first_drop
from femstruct.view.case_tables import outcomes, trust
from femstruct.view.console import Grid, finding_lines, fitting
from femstruct.view.terminal import main_tables, notes, other_tables

# ----------------------------------------------------------------------------------------------------------------------
# The pictures of a study by kind: what each shows is told by the first words of its file's name.
# ----------------------------------------------------------------------------------------------------------------------

MODEL: Final = "model"
RATED: Final = "rated"
RESPONSE: Final = "frf"


class Kind(NamedTuple):
    """Pictures of one kind: how their file names begin, the heading over them, what one is called."""

    begins: str
    heading: str
    one: str


KINDS: Final = (
    Kind(MODEL, "Model", "Model"),
    Kind(RATED, "Rated bands", "Rated bands"),
    Kind("level", "Levels over time", "Levels over time"),
    Kind("own_sound", "Sound of the striking bodies", "Sound of the striking bodies"),
    Kind(RESPONSE, "Frequency responses", "Frequency response"),
    Kind("shock_spectrum", "Shock response spectra", "Shock response spectrum"),
    Kind("fatigue", "Ranges of fatigue", "Ranges of fatigue"),
    Kind("vibration", "Answers to excitations", "Answer to an excitation"),
    Kind("mode_shapes", "Mode shapes", "Mode shapes"),
    Kind("stress", "Largest stresses", "Largest stress"),
    Kind("history", "Histories", "History"),
    Kind("contact_forces", "Contact forces", "Contact forces"),
    Kind("bodies", "Motion of the bodies", "Motion of the bodies"),
    Kind("energy", "Energy", "Energy"),
    Kind("spectrum", "Spectra", "Spectrum"),
    Kind("sound_energy", "Sound energy", "Sound energy"),
    Kind("directivity", "Directivity", "Directivity"),
    Kind("sound", "Sound pressure", "Sound pressure"),
    Kind("pressure_map", "Pressure maps", "Pressure map"),
    Kind("pressure_surfaces", "Surfaces of equal pressure", "Surfaces of equal pressure"),
    Kind("animation", "Animations", "Animation"),
)
OTHER: Final = Kind("", "Other pictures", "Picture")


def kind_of(name: str) -> Kind:
    """The kind of a picture by its file name.

    >>> kind_of("sound_energy_air.png").heading, kind_of("sound_box.mic.png").heading, kind_of("a.png").heading
    ('Sound energy', 'Sound pressure', 'Other pictures')
    """
    stem = name.rpartition(".")[0]
    fitting = (kind for kind in KINDS if stem == kind.begins or stem.startswith(f"{kind.begins}_"))
    return max(fitting, key=lambda kind: len(kind.begins), default=OTHER)


def picture_caption(name: str) -> str:
    """What a picture shows, for who cannot see it.

    >>> picture_caption("frf_slab_centre.png"), picture_caption("energy.png")
    ('Frequency response: slab_centre', 'Energy')
    """
    kind = kind_of(name)
    rest = name.rpartition(".")[0].removeprefix(kind.begins).strip("_")
    return f"{kind.one}: {rest}" if rest else kind.one


def by_kind(names: Iterable[str]) -> dict[Kind, list[str]]:
    """Names of pictures by kind, the kinds in their order on the page."""
    kinds: dict[Kind, list[str]] = {kind: [] for kind in (*KINDS, OTHER)}
    for name in names:
        kinds[kind_of(name)].append(name)
    return {kind: found for kind, found in kinds.items() if found}


# ----------------------------------------------------------------------------------------------------------------------
# Pieces of the page: tables, lists, folds, pictures and sounds inside it.
# ----------------------------------------------------------------------------------------------------------------------

_KINDS: Final = {".png": "image/png", ".gif": "image/gif", ".wav": "audio/wav"}
WIDEST: Final = 126  # characters of a table that fits on A4; what is wider goes on in another one below
LONGEST: Final = 44  # characters of a cell; a column with a longer one is text, and broken
EXCEEDED: Final = "exceeded"  # begins the cells of limits that are
HEADING: Final = 14  # characters of a heading, which is broken anywhere


def table(grid: Grid) -> str:
    """A table with its title, in pieces that fit on paper, each with the columns that name its rows; "" for none."""
    if not grid.rows:
        return ""
    widest = [max(_width(row[i]) for row in grid.rows) for i in range(len(grid.columns))]
    kinds = ["text" if width > LONGEST else "key" if i < grid.keys else "" for i, width in enumerate(widest)]
    widths = [
        max(min(LONGEST, width), min(HEADING, _width(head))) for width, head in zip(widest, grid.columns, strict=True)
    ]
    pieces = [_piece(grid, kinds, shown) for shown in fitting(widths, min(grid.keys, len(widths)), WIDEST)]
    return f"<h3>{escape(grid.title)}</h3>\n" + "\n".join(pieces)


def _piece(grid: Grid, kinds: Sequence[str], shown: Sequence[int]) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        marks = [f"{kinds[i]} severe".strip() if cells[i].startswith(EXCEEDED) else kinds[i] for i in shown]
        starts = [f'<{tag} class="{mark}">' if mark else f"<{tag}>" for mark in marks]
        return f"<tr>{''.join(f'{a}{escape(cells[i])}</{tag}>' for a, i in zip(starts, shown, strict=True))}</tr>"

    head, rows = row(grid.columns, "th"), "".join(row(cells, "td") for cells in grid.rows)
    return f'<div class="wide"><table><thead>{head}</thead><tbody>{rows}</tbody></table></div>'


def _width(cell: str) -> int:
    return max(map(len, cell.split("\n")))


def fold(title: str, parts: Iterable[str], kind: str = "") -> str:
    """What is read on demand, under a title, which is repeated inside for paper; "" where there is nothing of it."""
    inside = "\n".join(part for part in parts if part)
    start = f'<details class="{kind}">' if kind else "<details>"
    heading = f'<summary>{escape(title)}</summary>\n<h2 class="paper">{escape(title)}</h2>'
    return f"{start}{heading}\n{inside}\n</details>" if inside else ""


def listed(lines: Iterable[str], kind: str = "") -> str:
    """A list of sentences; "" for none."""
    start = f'<li class="{kind}">' if kind else "<li>"
    items = "".join(f"{start}{escape(line)}</li>" for line in lines)
    return f"<ul>{items}</ul>" if items else ""


def picture(name: str, file: bytes) -> str:
    """A picture with what it shows, and the name of its file."""
    image = f'<img src="{_inside(name, file)}" alt="{escape(picture_caption(name))}">'
    return f'<figure class="{kind_of(name).begins or "other"}">{image}<figcaption>{escape(name)}</figcaption></figure>'


def sound(name: str, file: bytes) -> str:
    """A sound to play, with the name of its file."""
    player = f'<audio controls preload="metadata" src="{_inside(name, file)}"></audio>'
    return f"<figure>{player}<figcaption>{escape(name)}</figcaption></figure>"


def _inside(name: str, file: bytes) -> str:
    """A file as its own address."""
    return f"data:{_KINDS[Path(name).suffix]};base64,{b64encode(file).decode('ascii')}"


# ----------------------------------------------------------------------------------------------------------------------
# How the page looks on a screen and on A4.
# ----------------------------------------------------------------------------------------------------------------------

STYLE: Final = """
body { font: 15px/1.45 system-ui, "Noto Sans", sans-serif; margin: 2em auto; max-width: 64em; padding: 0 1em;
  color: #222; }
h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin: 1.6em 0 .3em; border-bottom: 2px solid #222; }
h3 { font-size: 1em; margin: 1em 0 .2em; font-weight: 600; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .92em; }
th, td { padding: .15em .7em; text-align: right; vertical-align: top; border-bottom: 1px solid #ddd; }
th { white-space: pre-line; vertical-align: bottom; } td { white-space: pre; } /* a number is not broken */
.key, .text { text-align: left; } th:first-child, td:first-child { padding-left: 0; }
td.text { white-space: pre-line; min-width: 14em; }
.wide { overflow-x: auto; } figure { margin: 1em 0; } img { max-width: 100%; }
.model img { max-height: 30em; } .paper { display: none; }
figcaption { color: #666; font-size: .9em; }
.severe { color: #b00020; } div.severe, p.severe { border-left: 4px solid #b00020; padding: .1em .8em; }
summary { font-size: 1.1em; font-weight: 600; cursor: pointer; padding: .4em 0; border-top: 1px solid #bbb; }
footer { color: #666; font-size: .85em; margin-top: 2em; }
@page { size: A4; margin: 16mm 14mm 18mm;
  @bottom-right { content: counter(page) " / " counter(pages); font: 8pt sans-serif; } }
@media print {
  body { font-size: 9.5pt; margin: 0; max-width: none; padding: 0; }
  details::details-content { content-visibility: visible; block-size: auto; } /* folds print open */
  summary { display: none; } .paper { display: block; } h2, h3 { break-after: avoid; }
  .wide { overflow: visible; } table { font-size: 8pt; } th, td { padding: .1em .45em; } td.text { min-width: 0; }
  thead { display: table-header-group; } tr { break-inside: avoid; }
  figure { display: inline-block; width: 100%; margin: .5em 0; } img { max-height: 225mm; }
  .model img { max-height: 110mm; }
  .sounds { display: none; }
}
"""


# ----------------------------------------------------------------------------------------------------------------------
# Inputs in words: numbers in the units people use, places, rows of numbers.
# ----------------------------------------------------------------------------------------------------------------------

_PREFIXES: Final = {  # unit: (size, shown unit), the largest first
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")),
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")),
    "kg": ((1.0, "kg"), (1e-3, "g")),
    "N": ((1e6, "MN"), (1e3, "kN"), (1.0, "N")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")),
    "N m": ((1e6, "MN m"), (1e3, "kN m"), (1.0, "N m")),
    "N/m": ((1e9, "GN/m"), (1e6, "MN/m"), (1e3, "kN/m"), (1.0, "N/m")),
    "N/m^2": ((1e9, "GN/m^2"), (1e6, "MN/m^2"), (1e3, "kN/m^2"), (1.0, "N/m^2")),
    "N/m^3": ((1e9, "GN/m^3"), (1e6, "MN/m^3"), (1e3, "kN/m^3"), (1.0, "N/m^3")),
    "Pa s/m^2": ((1e3, "kPa s/m^2"), (1.0, "Pa s/m^2")),
    "N s/m": ((1e3, "kN s/m"), (1.0, "N s/m")),
    "Hz": ((1e4, ""), (1.0, "Hz")),
    "m^2": ((1.0, "m^2"), (1e-6, "mm^2")),
    "m^4": ((1.0, "m^4"), (1e-12, "mm^4")),
}
MODE: Final = "mode "  # begins the names of damping ratios of single modes
_PERCENT: Final = (
    "ratio",
    "damping ratio",
    "loss factor",
    MODE,
)  # begin the names of shares that are told in percent
_EACH: Final = ("E", "G", "D", "S", "A")  # moduli and rigidities along axes, whose sizes differ: each in its own unit
LARGE: Final = 1e7  # from there on whole numbers have an exponent
ROUNDING: Final = 1e-9  # of a drop height that was made a speed
_LONG: Final = 6  # more values, or places, are counted


def spoken(one: Given) -> str:
    """An input with its name.

    >>> spoken(Given("thickness", 0.18, "m")), spoken(Given("size", (5.0, 4.0), "m"))
    ('thickness 180 mm', 'size 5 x 4 m')
    >>> spoken(Given("band", (1.0, 500.0), "Hz")), spoken(Given("loss factor", 0.02))
    ('band 1 to 500 Hz', 'loss factor 2 %')
    >>> spoken(Given("mode 4", 0.06))
    'mode 4: 6 %'
    """
    if one.what == "lines":
        return f"{len(one.value)} line{'s' if len(one.value) > 1 else ''}"
    numbered = ":" if one.what.startswith(MODE) else ""  # "mode 4 6 %" would be of mode 46
    return f"{one.what}{numbered} {amount(one)}"


def amount(one: Given) -> str:
    """Its value and unit.

    >>> amount(Given("E", 30e9, "Pa")), amount(Given("A", 4.62e-5, "m^2")), amount(Given("side", "below"))
    ('30 GPa', '46.2 mm²', 'below')
    >>> amount(Given("at", ((1.0, 0.5), (2.0, 0.5)), "m"))
    '(1, 0.5) m, (2, 0.5) m'
    >>> amount(Given("reverberation time", {"63 Hz": 0.55, "125 Hz": 0.5}, "s"))
    '63 Hz 550 ms, 125 Hz 500 ms'
    >>> amount(Given("E", (11e9, 370e6), "Pa"))
    '11 GPa, 370 MPa'
    """
    value, unit = one.value, one.unit
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, float | int):
        return _percent(value) if not unit and one.what.startswith(_PERCENT) else _number([value], unit)
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {amount(Given(one.what, each, unit))}" for name, each in value.items())
    if isinstance(value, tuple):
        return _several(one.what, value, unit)
    return getattr(value, "__name__", str(value))


def _several(what: str, values: tuple[Any, ...], unit: str) -> str:
    if all(isinstance(value, float | int) for value in values):
        if len(values) > _LONG:
            return f"{len(values)} values, {_number([min(values), max(values)], unit, ' to ')}"
        if what in _EACH:
            return ", ".join(_number([value], unit) for value in values)
        if what in ("size", "mesh", "patch"):
            return _number(values, unit, " x ")
        return _number(values, unit, " to ") if what == "band" else _number(values, unit, ", ", "({})")
    if what == "between":
        return " and ".join(values)
    if len(values) > _LONG and not all(isinstance(value, str) for value in values):
        return f"{len(values)} places"
    return ", ".join(value if isinstance(value, str) else amount(Given(what, value, unit)) for value in values)


def _percent(value: float) -> str:
    return f"{100.0 * value:.5g} %"


def _number(values: Iterable[float], unit: str, between: str = "", frame: str = "{}") -> str:
    """Numbers in one unit that fits the largest; those in a frame are places, whose unit stays."""
    numbers = list(values)
    largest = max(map(abs, numbers), default=0.0)
    scales = _PREFIXES.get(unit, ()) if frame == "{}" and largest else ()
    size, shown = next((scale for scale in scales if scale[1] and largest >= scale[0] * (1.0 - ROUNDING)), (1.0, unit))
    number_text = frame.format(between.join(_digits(value / size) for value in numbers))
    return f"{number_text} {superscript(shown)}".strip()


def _digits(value: float) -> str:
    """Whole numbers in full, others with five digits.

    >>> _digits(20000.0), _digits(1171.875), _digits(-0.2)
    ('20000', '1171.9', '-0.2')
    """
    whole = value == round(value) and abs(value) < LARGE
    return f"{value:.0f}" if whole else f"{value:.5g}"


def superscript(unit: str) -> str:
    """A unit as it is printed.

    >>> superscript("kg/m^3"), superscript("N/m^1.5")
    ('kg/m³', 'N/m^1.5')
    """
    return re.sub(r"\^([234])(?![.\d])", lambda found: "²³⁴"[int(found[1]) - 2], unit)


# ----------------------------------------------------------------------------------------------------------------------
# What was asked, as tables: the inputs of the baseline, and what every case gives otherwise.
# ----------------------------------------------------------------------------------------------------------------------

FRONT: Final[Mapping[str, tuple[str, ...]]] = {  # tables of groups; of the others there is one more
    "structure": ("structure", "parts", "supports"),
    "what acts on it": ("bodies", "contacts", "links", "loads"),
    "rooms": ("rooms",),
    "analysis": ("analysis",),
}
LOSS: Final = "loss factor"  # of a material: used only where the damping is
OF_MATERIALS: Final = Given(LOSS, "of the materials")
FURTHER: Final = "further inputs"


def baseline_inputs(plan: Plan) -> Inputs:
    """The inputs of a study's baseline."""
    return inputs(next(case.study for case in plan.cases if case.name == plan.baseline))


def input_tables(inputs: Inputs) -> tuple[Grid, ...]:
    """The inputs that a reader asks for first: materials, structure, what acts on it, rooms, analysis."""
    grids = [_materials(inputs), *(_items(title, inputs, groups) for title, groups in FRONT.items())]
    return tuple(grid for grid in grids if grid.rows)


def further_inputs(inputs: Inputs) -> Grid:
    """All other inputs: sections, joints, points, surfaces, frequency responses."""
    shown = {"materials", *(group for groups in FRONT.values() for group in groups)}
    return _items(FURTHER, inputs, [group for group in inputs.groups if group not in shown])


def _materials(inputs: Inputs) -> Grid:
    items = inputs.groups.get("materials", ())
    columns = list(dict.fromkeys(one.what for item in items for one in item.given))
    damping = [one for item in inputs.groups.get("analysis", ()) if item.name == "damping" for one in item.given]
    unused = bool(damping) and not any(one == OF_MATERIALS for one in damping)
    shown = [f"{column}\n(not used)" if unused and column == LOSS else column for column in columns]
    grid = Grid("materials", ("", *shown))
    for item in items:
        amounts = {one.what: amount(one) for one in item.given}
        grid.add(item.name, *(amounts.get(column, "") for column in columns))
    return grid


def _items(title: str, inputs: Inputs, groups: Sequence[str]) -> Grid:
    grid = Grid(title, ("", "kind" if groups != ("analysis",) else "", "given"), keys=3)
    for group in groups:
        for item in inputs.groups.get(group, ()):
            grid.add(item.name, item.kind, ", ".join(map(spoken, item.given)))
    return grid


def cases_table(plan: Plan, finished: Sequence[str]) -> Grid:
    """A row for everything that a case gives otherwise than the baseline.

    What a case changes in words that are no input, as a mesh file of its room, is told in the words of its file.

    Parameters
    ----------
    finished : Sequence[str]
        Names of the cases that were run.
    """
    grid = Grid(f"cases (baseline: {plan.baseline})", ("case", "input", "baseline", "case has"), keys=4)
    of_baseline = baseline_inputs(plan)
    for case in plan.cases if len(plan.cases) > 1 else ():
        mark = "" if case.name in finished else ", not run"
        if case.name == plan.baseline:
            grid.add(case.name, f"the baseline{mark}", "", "")
            continue
        rows = [row for one in differences(of_baseline, inputs(case.study)) for row in _rows(one)] or _as_written(case)
        for number, row in enumerate(rows):
            grid.add("" if number else f"{case.name}{mark}", *row)
    return grid


def _rows(found: Difference) -> Iterator[tuple[str, str, str]]:
    if not (found.before and found.after):
        before, after = (", ".join(map(_given_text, side)) or "-" for side in (found.before, found.after))
        yield f"{found.group}: {found.name}", before, after
        return
    first, second = ({one.what: amount(one) for one in side} for side in (found.before, found.after))
    for what in dict.fromkeys((*first, *second)):
        yield f"{found.name}: {what}", first.get(what, "-"), second.get(what, "-")


def _given_text(one: Given) -> str:
    return amount(one) if one.what == "kind" else spoken(one)


def _as_written(case: Case) -> list[tuple[str, str, str]]:
    return [(path, "", text) for path, text in case.changes.items()] or [("nothing differs", "", "")]


# ----------------------------------------------------------------------------------------------------------------------
# The table of natural frequencies and damping ratios, structure beside structure.
# ----------------------------------------------------------------------------------------------------------------------

MOST: Final = 20  # modes of a structure; all are in results.h5


def natural_frequencies(result: StudyResult) -> Grid:
    """The first modes of every structure: frequency [Hz] and damping ratio, a column for the cases that share it.

    Of structures over wool those of the damped modes, as `femstruct modes` lists them: a ratio of one mode without
    losses says nothing there.
    """
    alike: dict[tuple[str, bytes], list[str]] = {}
    for name, case in result.cases.items():
        alike.setdefault((case.basis_key, case.basis.damping_ratio.tobytes()), []).append(name)
    columns = {", ".join(names): _modes(result.cases[names[0]].basis) for names in alike.values()}
    longest = max(map(len, columns.values()), default=0)
    more = f" (the first {MOST} of at most {longest} modes)" if longest > MOST else ""
    grid = Grid(f"natural frequencies [Hz], damping ratios{more}", ("mode", *columns))
    for mode in range(min(MOST, longest)):
        grid.add(str(mode + 1), *(column[mode] if mode < len(column) else "-" for column in columns.values()))
    return grid


def _modes(basis: ModalBasis) -> list[str]:
    if WOOL in basis.holders and (damped := damped_modes(basis)) is not None:
        pairs = zip(damped.frequency_hz.tolist(), damped.damping_ratio.tolist(), strict=True)
        return ["0.00"] * basis.n_rigid + [f"{f:.2f}, {100.0 * ratio:.3g} %" for f, ratio in pairs]
    true = basis.modes
    found = []
    for f, ratio, kind in zip(basis.frequency_hz[true], basis.damping_ratio[true], basis.kind[true], strict=True):
        found.append(f"{f:.2f}" + ("" if kind == "rigid" or isnan(ratio) else f", {100.0 * ratio:.3g} %"))
    return found


# ----------------------------------------------------------------------------------------------------------------------
# A study's results as one page, for a browser and for paper.
# ----------------------------------------------------------------------------------------------------------------------

_NO_FILES: Final[Mapping[str, bytes]] = MappingProxyType({})


def write_report(
    result: StudyResult,
    path: str | Path,
    pictures: Mapping[str, bytes] = _NO_FILES,
    sounds: Mapping[str, bytes] = _NO_FILES,
) -> Path:
    """Write the page to a path, in one step: what the terminal shows, and the files of pictures and sounds by name.

    All is inside the page: it asks nothing of a network or of its folder, and can be sent as one file.
    """
    path = Path(path)
    with replacing(path) as temporary:
        temporary.write_text(report(result, pictures, sounds), encoding="utf-8")
    return path


def report(
    result: StudyResult, pictures: Mapping[str, bytes] = _NO_FILES, sounds: Mapping[str, bytes] = _NO_FILES
) -> str:
    """The page as HTML, with the files of pictures (png, gif) and sounds (wav) by name."""
    title = escape(result.plan.title)
    screen = '<meta name="viewport" content="width=device-width, initial-scale=1">'  # a telephone's own width
    head = f'<meta charset="utf-8">{screen}<title>{title}</title><style>{STYLE}</style>'
    ranks = _ranked(result)
    parts = [
        f"<h1>{title}</h1>",
        _warning(result, ranks[Rank.FORBIDS]),
        *_input_pieces(result, pictures),
        *_found(result, pictures),
        *_trust(result, ranks),
        *_folds(result, pictures, sounds),
    ]
    versions = ", ".join(f"{name} {value}" for name, value in result.provenance.items() if value)
    body = "\n".join(part for part in parts if part)
    return (
        f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n'
        f"<footer>{escape(versions)}</footer>\n</body></html>\n"
    )


def _warning(result: StudyResult, forbids: list[str]) -> str:
    """Before anything is read: that the results must not be trusted."""
    if not forbids:
        return ""
    codes = list_some(dict.fromkeys(line.partition(":")[0] for line in forbids))
    return f'<p class="severe">Do not trust these results: {escape(codes)}. The reasons are under “Trust”.</p>'


def _input_pieces(result: StudyResult, pictures: Mapping[str, bytes]) -> list[str]:
    """The model, the inputs of the baseline, and the cases."""
    models = [picture(name, file) for name, file in pictures.items() if kind_of(name).begins == MODEL]
    cases = table(cases_table(result.plan, list(result.cases)))
    inputs = [table(grid) for grid in input_tables(baseline_inputs(result.plan))]
    changed = listed(result.comparison.inputs)
    between = ["<h2>What differs in the input files</h2>", changed] if changed else []
    return ["<h2>Model and inputs</h2>", *models, *inputs, *(["<h2>Cases</h2>", cases] if cases else []), *between]


def _found(result: StudyResult, pictures: Mapping[str, bytes]) -> list[str]:
    """The results that were asked for: ratings, limits, levels, peaks, and how the cases ended; where none is asked
    for, natural frequencies and frequency responses."""
    about = [first_drop(result)] if first_drop(result) else []
    tables = [table(grid) for grid in main_tables(result)]
    if not any(tables):
        tables = [table(natural_frequencies(result))]
    shown = [picture(name, file) for name, file in pictures.items() if kind_of(name).begins in _front(result)]
    return ["<h2>Results</h2>", listed([*outcomes(result), *about, *notes(result)]), *tables, *shown]


def _front(result: StudyResult) -> tuple[str, ...]:
    """Kinds of pictures among the results."""
    return (RATED,) if any(grid.rows for grid in main_tables(result)) else (RATED, RESPONSE)


def _ranked(result: StudyResult) -> dict[Rank, list[str]]:
    """All findings as lines by rank, each with the cases it holds for."""
    findings = [
        (finding, f" ({', '.join(cases)})" if 0 < len(cases) < len(result.cases) else "")
        for finding, cases in findings_by_case(result)
    ]
    lines = finding_lines(findings, verbose=True)
    return {rank: [line.removeprefix(f"{rank.value}, ") for own, line in lines if own is rank] for rank in Rank}


def _trust(result: StudyResult, ranks: Mapping[Rank, list[str]]) -> list[str]:
    """What forbids trust; how far the numbers may be off; what limits trust and what is remarked, in folds."""
    forbids = listed(ranks[Rank.FORBIDS], "severe") or "<p>No finding forbids trust.</p>"
    limits, remarks = ranks[Rank.LIMITS], ranks[Rank.REMARK]
    return [
        "<h2>Trust</h2>",
        forbids,
        listed(trust(result)),
        fold(f"Findings that limit trust ({len(limits)})", [listed(limits)]),
        fold(f"Remarks ({len(remarks)})", [listed(remarks)]),
    ]


def _folds(result: StudyResult, pictures: Mapping[str, bytes], sounds: Mapping[str, bytes]) -> list[str]:
    """All else: further inputs, other tables, sounds, pictures by kind."""
    kinds = {kind: names for kind, names in by_kind(pictures).items() if kind.begins not in (MODEL, *_front(result))}
    with_rooms = [(name, case) for name, case in result.cases.items() if case.rooms]
    order = ", ".join(f"{name}, {name} with the bodies' own sound" if c.heard.total else name for name, c in with_rooms)
    listen = [f"<p>All cases in turn, at one scale: {escape(order)}</p>"] if sounds else []
    grids = (natural_frequencies(result), *other_tables(result))
    return [
        fold("Further inputs", [table(further_inputs(baseline_inputs(result.plan)))]),
        fold("More tables", [table(grid) for grid in grids]),
        fold("Sounds", [*listen, *(sound(name, file) for name, file in sounds.items())], kind="sounds"),
        *(fold(kind.heading, [picture(name, pictures[name]) for name in names]) for kind, names in kinds.items()),
    ]
