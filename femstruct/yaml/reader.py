"""YAML files as plain trees that remember the line and column of every key and value."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import accumulate
from pathlib import Path
from typing import Any, Final, TypeVar
from unicodedata import normalize

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from acoustics.errors import AcousticsError
from femstruct.conventions import DIRECTIONS
from femstruct.errors import FemstructError, InputError, InputErrors, list_some, sentence
from femstruct.files.text_tables import content

# ----------------------------------------------------------------------------------------------------------------------
# A file as plain values that remember the line and column of every key, and the mistakes in it.
# ----------------------------------------------------------------------------------------------------------------------

Steps = tuple[str | int, ...]  # from the root to a value: keys and list indices


@dataclass(frozen=True)
class Position:
    """A place in a file, counted from 1; line 0 for what has no lines, such as the command line."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


@dataclass
class Mistakes:
    """The mistakes found so far, a line each, without repetition."""

    lines: list[str] = field(default_factory=list)

    def add(self, position: Position, path: str, *, got: str = "", expected: str = "", do: str = "") -> None:
        """Note one mistake as ``file:line:column: path: got, expected; do``."""
        self.note(": ".join(part for part in (str(position), sentence(path, got, expected, do)) if part))

    def note(self, line: str) -> None:
        """Note a mistake that is already a sentence."""
        line = " ".join(line.split())
        if line not in self.lines:
            self.lines.append(line)

    def stop_if_any(self) -> None:
        """Raise InputErrors when there are mistakes."""
        if self.lines:
            raise InputErrors(tuple(self.lines))


@dataclass(frozen=True)
class Tree:
    """A YAML file as mappings, lists, texts, numbers, booleans and None, and where each of them stands.

    keys : where the key (or list item) of a path begins. values : where its value begins. text : the file verbatim.
    """

    file: str
    value: Any
    keys: Mapping[Steps, Position]
    values: Mapping[Steps, Position]
    text: str

    def position(self, steps: Steps, of_key: bool = False) -> Position:
        """Where a value (or its key) stands; of a path that is not there, where its nearest ancestor's key does."""
        if not of_key and steps in self.values:
            return self.values[steps]
        while steps and steps not in self.keys:
            steps = steps[:-1]
        return self.keys.get(steps, Position(self.file, 1, 1))


def mapping_in(value: Any, key: str) -> dict[str, Any]:
    """The mapping at a key of a mapping, empty where there is none."""
    found = value.get(key) if isinstance(value, dict) else None
    return found if isinstance(found, dict) else {}


def dotted(steps: Steps) -> str:
    """A path as people write it.

    >>> dotted(("parts", "slab", "origin", 2))
    'parts.slab.origin[2]'
    """
    text = ""
    for step in steps:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def nearest(name: str, known: Iterable[object]) -> str:
    """``did you mean 'x'?`` with the known name nearest to this one; the known names when none is near."""
    if meant := near_one(name, known):
        return meant
    names = sorted({str(one) for one in known})
    return f"known here: {list_some(names)}" if names else ""


def near_one(name: str, known: Iterable[object]) -> str:
    """``did you mean 'x'?`` with the nearest name, empty when none is near: for where the known ones are told already.

    >>> near_one("herz", ("hertz", "cubic")), near_one("q", ("x", "y")), near_one("C30", ("wall C30", "slab C30"))
    ("did you mean 'hertz'?", '', 'did you mean one of slab C30, wall C30?')
    """
    several = _holding(name, known := [str(one) for one in known])
    if len(several) > 1:
        return f"did you mean one of {list_some(several)}?"
    near = near_name(name, known)
    if near and near != name and normalize("NFKC", near).split() == normalize("NFKC", name).split():
        return f"'{near}' looks alike, but has other characters (Unicode): copy it from there"
    return f"did you mean '{near}'?" if near else ""


def near_name(name: str, known: Iterable[object]) -> str:
    """The only known name of which this one is some words, or the one nearest to it; empty when none is near.

    >>> near_name("C30/37", ("C30", "concrete C30/37")), near_name("C31", ("C30", "concrete C30/37"))
    ('concrete C30/37', 'C30')
    """
    folded = {_folded(one): one for one in sorted({str(one) for one in known}, reverse=True)}
    holding = _holding(name, folded.values())
    near = difflib.get_close_matches(_folded(name[:100]), folded, n=1, cutoff=0.6)
    return holding[0] if len(holding) == 1 else folded[near[0]] if near else ""


def _holding(name: str, known: Iterable[str]) -> list[str]:
    """The known names of which a name is some words, but none where one of them is the name in other letters."""
    folded, text = {one: _folded(one) for one in sorted({*known})}, _folded(name[:100])
    return [] if text in folded.values() else [one for one in folded if f" {text} " in f" {folded[one]} "]


def _folded(name: str) -> str:
    return normalize("NFC", name).lower()


# ----------------------------------------------------------------------------------------------------------------------
# Where something stands in a file: what is wrong with it is noted there, and so is what its noun refuses.
# ----------------------------------------------------------------------------------------------------------------------

T = TypeVar("T")
POINT_DIRECTIONS = (*DIRECTIONS, "n")
GROUPS = {
    "material": "materials",
    "section": "sections",
    "surface": "surfaces",
    "point": "points",
    "case": "cases",
    "body": "bodies",
}  # of a file; what else has a name is a part
FORCES = ("force", "force_x", "force_y", "force_z")


def members(name: str, count: int) -> list[str]:
    """The names of the places of a point, or of the bodies of an array.

    >>> members("foot", 1), members("foot", 2)
    (['foot'], ['foot.1', 'foot.2'])
    """
    return [name] if count == 1 else [f"{name}.{number}" for number in range(1, count + 1)]


@dataclass(frozen=True)
class Names:
    """What names stand for. points : how many places each has. places : single ones, of several NAME.1, NAME.2, ...
    forces : what has a force. known : all names of a kind, by the words for it that messages use."""

    points: Mapping[str, int] = field(default_factory=dict)
    places: Collection[str] = ()
    forces: Collection[str] = ()
    known: Mapping[str, Collection[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Here:
    """A place in a file, and the names that what stands there may use."""

    tree: Tree
    mistakes: Mistakes
    names: Names = Names()
    steps: Steps = ()

    def at(self, *steps: str | int) -> Here:
        """A place inside of this one."""
        return Here(self.tree, self.mistakes, self.names, (*self.steps, *steps))

    def outside(self, count: int) -> Here:
        """The place that this one is in, so many steps up."""
        return Here(self.tree, self.mistakes, self.names, self.steps[:-count])

    @property
    def path(self) -> str:
        return dotted(self.steps)

    @property
    def position(self) -> Position:
        return self.tree.position(self.steps)

    def wrong(self, got: str, expected: str, do: str = "", of_key: bool = False) -> None:
        """Note a mistake, at the value that stands here or at its key."""
        self.mistakes.add(self.tree.position(self.steps, of_key), self.path, got=got, expected=expected, do=do)

    def need(self, ok: object, got: str, expected: str, do: str = "", of_key: bool = False) -> bool:
        """Whether all is well; notes a mistake where it is not."""
        if not ok:
            self.wrong(got, expected, do, of_key)
        return bool(ok)

    def make(self, maker: Callable[[], T]) -> T | None:
        """What `maker` makes; None with its refusal noted here, or at the key of this mapping that it is about."""
        try:
            return maker()
        except InputErrors as errors:  # lines with their own places
            for line in errors.errors:
                self.mistakes.note(line)
            return None
        except (FemstructError, AcousticsError) as error:
            inner = error.where.removeprefix(f"{self.path}.")
            (self.at(inner) if inner != error.where and (*self.steps, inner) in self.tree.keys else self).wrong(
                error.got or str(error), error.expected, error.do
            )
            return None

    def each(self, group: str, specs: Mapping[str, Any], maker: Callable[[Here, str, Any], T | None]) -> dict[str, T]:
        """One noun for every name of a group; those refused are left out."""
        there = {name: self.at(group, name) for name in specs}
        made = {name: there[name].make(partial(maker, there[name], name, spec)) for name, spec in specs.items()}
        return {name: noun for name, noun in made.items() if noun is not None}

    def known(self, name: str, kind: str, also: Collection[str] = ()) -> bool:
        """Whether something of a kind has this name, or it is one of the others; noted where not."""
        names = [*self.names.known.get(kind, ()), *also]
        if name not in names:
            part = mapping_in(mapping_in(self.tree.value, "parts"), name).get("type")
            group = next((key for key in self.tree.value if name in mapping_in(self.tree.value, key)), "")
            is_what = f", of type {part}" if part else f", one of the {group}" if group else ""
            self.wrong(
                f"'{name}'{is_what}",
                f"the name of a {kind}{' with nodes' if part and kind == 'part' else ''}",
                nearest(name, names) if names else f"there are none: add one to '{GROUPS.get(kind, 'parts')}:'",
            )
        return name in names

    def place(self, name: str, also: Collection[str] = ()) -> None:
        """Note what is neither a single place nor one of the other names."""
        known, several = [*self.names.places, *also], self.names.points.get(name)
        if name in known:
            return
        if several:
            self.wrong(f"'{name}', which has {several} places", "one place", f"write {name}.1 to {name}.{several}")
            return
        words = "point" if not also else "point, body or ground" if "ground" in also else "point or body"
        near = near_one(name, [*known, *self.names.points]) or nearest(name, known)
        self.wrong(f"'{name}'", f"the name of a {words}", near or "there are no points: add 'points:'")

    def spot(self, text: str, forces: bool = False, of_key: bool = False) -> None:
        """Note what is no address: POINT.direction, or NAME.force where forces are allowed."""
        name, _, what = text.rpartition(".")
        points, places, got = self.names.points, self.names.places, f"'{text}'"
        if forces and what in FORCES:
            if name not in self.names.forces:
                self.wrong(got, "a force of the structure", nearest(name, self.names.forces), of_key)
        elif not name or what not in POINT_DIRECTIONS:
            self.wrong(
                got,
                f"POINT.{'|'.join(POINT_DIRECTIONS)}" + (" or NAME.force" if forces else ""),
                f"write it like {name or text}.z" if (name or text) in points else "write it like O_f.z",
                of_key,
            )
        elif name in points and name not in places:
            self.wrong(
                f"{got}, which has several places",
                "one place",
                f"write {name}.1.{what} to {name}.{points[name]}.{what}",
                of_key,
            )
        elif name not in places:
            self.wrong(got, "a direction of a point", nearest(name, sorted(places)) or "there are no points", of_key)


# ----------------------------------------------------------------------------------------------------------------------
# YAML files as plain trees that remember the line and column of every key and value.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST_FILE: Final = 500_000  # bytes; a minute of reading at the worst, and far more than any model needs
LARGEST_TREE: Final = 100_000  # values, aliases followed
DEEPEST: Final = 40
_WHOLE: Final = re.compile(r"[-+]?[0-9]{1,18}")
_REAL: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NO_TEXT: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_NO_SPACE: Final = re.compile("[\u00a0\u2000-\u200a\u202f\u205f\u3000]")
_UNSEEN: Final = re.compile("[\u00ad\u200b\u200e\u200f\u202a-\u202e\u2060\u2066-\u2069\ufeff]")
_NOT_NUMBERS: Final = {".nan": "nan", ".inf": "inf", "+.inf": "inf", "-.inf": "-inf"}
_WORDS: Final = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def read_yaml(path: str | Path, asked_at: Position | None = None, asked_path: str = "") -> Tree:
    """A YAML 1.2 file as a tree with positions.

    Parameters
    ----------
    asked_at, asked_path : Position | None, str
        Where another file names this one, for the message when it cannot be opened.

    Raises
    ------
    InputErrors
        One line ``file:line:column: got, expected; do`` a mistake: a missing file (with the nearest name), a folder,
        binary data, an empty file, broken YAML, duplicate keys, tags, too many or circular aliases, a file that is too
        large.
    """
    mistakes, file = Mistakes(), str(path)
    text = _read_text(Path(path), asked_at or Position(file, 1, 1), asked_path)
    node, walk = _compose(text, file), _Walk(file, mistakes)
    value = walk.value(node, ())
    if not isinstance(value, dict):  # of whose file, nobody knows: it is not quoted
        got = "a list" if isinstance(value, list) else "text"
        mistakes.add(walk.values[()], "", got=got, expected="a mapping", do="begin with 'title: ...'")
    mistakes.stop_if_any()
    return Tree(file, value, walk.keys, walk.values, text)


def parse_value(text: str, file: str, mistakes: Mistakes) -> Tree:
    """The tree of a YAML text that may be any value, such as one from the command line, without lines."""
    walk, value = _Walk(file, mistakes), None
    try:
        value = walk.value(_compose(text, file), ())
    except InputErrors as errors:
        mistakes.note(errors.errors[0])
    positions = dict.fromkeys([*walk.keys, *walk.values, ()], Position(file))
    return Tree(file, value, positions, positions, text)


def lines_of_keys(text: str, file: str) -> dict[str, range]:
    """The lines, from 1, of every key of a YAML mapping and its value. Raises InputErrors for what is no YAML.

    >>> lines_of_keys("a: 1\\nb:\\n  c: 2\\n\\n# more\\nd: 3\\n", "x.yaml")
    {'a': range(1, 2), 'b': range(2, 4), 'd': range(6, 7)}
    """
    node, rows = _compose(text, file), text.splitlines()
    found: dict[str, range] = {}
    for key, value in node.value if isinstance(node, MappingNode) else ():
        end = value.end_mark.line + (value.end_mark.column > 0)
        while end > key.start_mark.line + 1 and rows[end - 1].strip().partition("#")[0] == "":
            end -= 1
        found[str(key.value)] = range(key.start_mark.line + 1, end + 1)
    return found


def _refused(at: Position, got: str, expected: str, do: str = "", path: str = "") -> InputErrors:
    mistakes = Mistakes()
    mistakes.add(at, path, got=got, expected=expected, do=do)
    return InputErrors(tuple(mistakes.lines))


def _read_text(path: Path, at: Position, asked_path: str) -> str:
    try:
        return content(path, LARGEST_FILE, "a YAML file").decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _refused(at, _not_text(error), "text in UTF-8", "save it as UTF-8", asked_path) from None
    except InputError as error:
        do = "put large tables into CSV files" if error.got.startswith("a file of") else error.do
        do = nearest(path.name, _siblings(path)) if error.got.startswith("no file") else do
        raise _refused(at, error.got, error.expected, do, asked_path) from None


def _not_text(error: UnicodeDecodeError) -> str:
    before = error.object[: error.start]
    if b"\0" in error.object:
        return f"binary data (byte {error.start})"
    return f"a character in another encoding (line {before.count(10) + 1}, byte 0x{error.object[error.start]:02x})"


def _siblings(path: Path) -> list[str]:
    try:
        return [entry.name for entry in path.parent.iterdir() if entry.suffix in (".yaml", ".yml")]
    except (OSError, ValueError):
        return []


def _compose(text: str, file: str) -> Node:
    """The nodes of a text; raises InputErrors for what is no YAML."""
    at, mistake = Position(file, 1, 1), ("an empty file", "a mapping", "begin with 'title: ...'")
    try:
        if _bracket_depth(text) > 10 * DEEPEST:  # the YAML reader's time grows with its square
            raise RecursionError
        node = _composed(text)
        if node is not None:
            return node
    except MarkedYAMLError as error:
        quoted = error.context is not None and "quoted scalar" in error.context
        mark = (error.context_mark if quoted else None) or error.problem_mark or error.context_mark
        at = Position(file, mark.line + 1, mark.column + 1) if mark else at
        words = " ".join(str(part) for part in (error.context, error.problem) if part)
        tabs = "indent with spaces: YAML has no tabs" if "found character '\\t'" in words else ""
        mistake = (f"broken YAML ({words})", "YAML", tabs or _to_mend(error, quoted, text))
    except YAMLError:
        mistake = ("characters that are not text", "a text file", "")
    except RecursionError:
        mistake = ("endless nesting", f"at most {DEEPEST} levels", "")
    except (ValueError, AssertionError, AttributeError, TypeError, LookupError) as error:
        # the YAML reader trips over some broken texts with its own errors
        mistake = (f"broken YAML ({error})", "YAML", "")
    raise _refused(at, *mistake)


def _to_mend(error: MarkedYAMLError, quoted: bool, text: str) -> str:
    """What to do about broken YAML.

    Parameters
    ----------
    quoted : bool
        Whether a quote is not closed.
    """
    if quoted:
        return "close the quote that begins here"
    if error.context_mark is not None and "flow" in str(error.context):
        return f"check brackets, commas and quotes from line {error.context_mark.line + 1} on, where the bracket opens"
    if "mapping values are not allowed" in str(error.problem):
        above = list(enumerate(text.splitlines()[: error.problem_mark.line], start=1)) if error.problem_mark else []
        number, line = next(((n, row.strip()) for n, row in reversed(above) if row.strip()), (0, ""))
        if line and not (": " in line or line.endswith(":") or line.startswith(("#", "-"))):
            return f"line {number} is no 'key: value': write a colon and a space after its key"
        return "put quotes around text that contains ': ', and check indents"
    return "check brackets, quotes and indents"


@lru_cache(maxsize=16)
def _composed(text: str) -> Node | None:
    """The nodes of a text, which nobody changes; kept for files that are read again and again with other overrides."""
    node: Node | None = YAML(typ="safe", pure=True).compose(text)
    return node


def _bracket_depth(text: str) -> int:
    steps = (1 if match[0] in "[{" else -1 for match in re.finditer(r"[\[\]{}]", text))
    return max(accumulate(steps), default=0)


class _Walk:
    """From nodes to plain values, once through the tree."""

    def __init__(self, file: str, mistakes: Mistakes) -> None:
        self.file, self.mistakes = file, mistakes
        self.keys: dict[Steps, Position] = {}
        self.values: dict[Steps, Position] = {}
        self.overflowed = False

    def at(self, node: Node) -> Position:
        return Position(self.file, node.start_mark.line + 1, node.start_mark.column + 1)

    def value(self, node: Node, steps: Steps) -> Any:
        self.values[steps] = self.at(node)
        if self.overflowed:
            return None
        if len(self.values) > LARGEST_TREE or len(steps) > DEEPEST:
            self.overflowed = True
            self.mistakes.add(
                self.at(node),
                "",
                got="aliases (*name) or lists that expand endlessly",
                expected=f"at most {LARGEST_TREE} values, {DEEPEST} deep",
                do="write the values instead of the aliases",
            )
            return None
        if isinstance(node, MappingNode):
            return self.mapping(node, steps)
        if isinstance(node, SequenceNode):
            items = []
            for number, item in enumerate(node.value):
                self.keys[*steps, number] = self.at(item)
                items.append(self.value(item, (*steps, number)))
            return items
        return self.scalar(node, steps) if isinstance(node, ScalarNode) else None

    def mapping(self, node: MappingNode, steps: Steps) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key_node, value_node in node.value:
            at = self.at(key_node)
            if not isinstance(key_node, ScalarNode):
                self.mistakes.add(at, dotted(steps), got="a list or mapping as a key", expected="a name")
                continue
            key = str(key_node.value)
            if (blank := _NO_SPACE.search(key)) is not None:
                got = f"a blank that is no space (U+{ord(blank[0]):04X}) in a key"
                self.mistakes.add(at, dotted(steps), got=got, expected="a name", do="type a space, or nothing")
            if blank is not None or self.is_no_text(key, at, steps):
                continue
            if key in found:
                first = self.keys[*steps, key]
                self.mistakes.add(
                    at,
                    dotted((*steps, key)),
                    got=f"'{key}' twice (first in line {first.line})",
                    expected="each key once",
                    do="remove or rename one",
                )
                continue
            self.keys[*steps, key] = at
            found[key] = self.value(value_node, (*steps, key))
            if isinstance(value_node, ScalarNode) and not (value_node.value or value_node.style):
                self.values[*steps, key] = at  # nothing stands there: it would be the next line
        return found

    def is_no_text(self, text: str, at: Position, steps: Steps) -> bool:
        """Note what no system can print, write or use in a name: NUL and its like, halves of characters; and what
        nobody sees."""
        found = _NO_TEXT.search(text) or _UNSEEN.search(text)
        if found:
            kind = "cannot be seen" if _UNSEEN.fullmatch(found[0]) else "is no text"
            got = f"a character that {kind} (U+{ord(found[0]):04X})"
            self.mistakes.add(at, dotted(steps), got=got, expected="text", do="remove it")
        return found is not None

    def scalar(self, node: ScalarNode, steps: Steps) -> Any:
        text = str(node.value)
        tag = str(node.tag or "")
        if not tag.startswith("tag:yaml.org,2002:") or "python" in tag:
            self.mistakes.add(
                self.at(node), dotted(steps), got=f"the tag {tag}", expected="a plain value", do="remove the tag"
            )
            return None
        if self.is_no_text(text, self.at(node), steps):
            return None
        if node.style:  # quoted or block: always a text
            return text
        if text in _WORDS:
            return _WORDS[text]
        if _WHOLE.fullmatch(text):
            return int(text)
        if _REAL.fullmatch(text):
            return float(text)
        return float(_NOT_NUMBERS[text.lower()]) if text.lower() in _NOT_NUMBERS else text
