"""YAML files as plain trees that remember the line and column of every key and value."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from femstruct.errors import InputError, InputErrors, sentence, some_of
from femstruct.files.inputs.opening import content

Steps = tuple[str | int, ...]  # from the root to a value: keys and list indices

LARGEST_FILE: Final = 500_000  # bytes; a minute of reading at the worst, and far more than any model needs
LARGEST_TREE: Final = 100_000  # values, aliases followed
DEEPEST: Final = 40
_WHOLE: Final = re.compile(r"[-+]?[0-9]{1,18}")
_REAL: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NO_TEXT: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_NOT_NUMBERS: Final = {".nan": "nan", ".inf": "inf", "+.inf": "inf", "-.inf": "-inf"}


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


def dotted(steps: Steps) -> str:
    """A path as people write it.

    >>> dotted(("parts", "slab", "origin", 2))
    'parts.slab.origin[2]'
    """
    text = ""
    for step in steps:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def read_yaml(path: str | Path, asked_at: Position | None = None, asked_path: str = "") -> Tree:
    """A YAML 1.2 file as a tree with positions.

    asked_at, asked_path : where another file names this one, for the message when it cannot be opened.

    Raises InputErrors, one line ``file:line:column: got, expected; do`` a mistake: a missing file (with the nearest
    name), a folder, binary data, an empty file, broken YAML, duplicate keys, tags, too many or circular aliases, a
    file that is too large.
    """
    mistakes = Mistakes()
    text = _read_text(Path(path), asked_at or Position(str(path), 1, 1), asked_path, mistakes)
    tree = parse_yaml(text, str(path), mistakes)
    mistakes.stop_if_any()
    return tree


def parse_yaml(text: str, file: str, mistakes: Mistakes) -> Tree:
    """The tree of a YAML text; what is wrong with it is added to `mistakes`."""
    node = _compose(text, file, mistakes)
    walk = _Walk(file, mistakes)
    value = walk.value(node, ()) if node is not None else {}
    if node is not None and not isinstance(value, dict):
        mistakes.add(
            walk.values[()],
            "",
            got=("a list" if isinstance(value, list) else "text"),
            expected="a mapping",
            do="begin with 'title: ...'",
        )
        value = {}
    return Tree(file, value, walk.keys, walk.values, text)


def parse_value(text: str, file: str, mistakes: Mistakes) -> Tree:
    """The tree of a YAML text that may be any value, such as one from the command line, without lines."""
    node, walk = _compose(text, file, mistakes), _Walk(file, mistakes)
    value = walk.value(node, ()) if node is not None else None
    positions = dict.fromkeys([*walk.keys, *walk.values, ()], Position(file))
    return Tree(file, value, positions, positions, text)


def _read_text(path: Path, at: Position, asked_path: str, mistakes: Mistakes) -> str:
    try:
        return content(path, LARGEST_FILE, "a YAML file").decode("utf-8-sig")
    except UnicodeDecodeError as error:
        got, expected, do = _not_text(error), "text in UTF-8", "save it as UTF-8"
    except InputError as error:
        got, expected, do = error.got, error.expected, error.do
        if got.startswith("no file"):
            do = nearest(path.name, _siblings(path))
        elif got.startswith("a file of"):
            do = "put large tables into CSV files"
    mistakes.add(at, asked_path, got=got, expected=expected, do=do)
    raise InputErrors(tuple(mistakes.lines))


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


def nearest(name: str, known: Iterable[object]) -> str:
    """``did you mean 'x'?`` with the known name nearest to this one; the known names when none is near."""
    near = near_name(name, known)
    if near:
        return f"did you mean '{near}'?"
    names = sorted({str(one) for one in known})
    return f"known here: {some_of(names)}" if names else ""


def near_name(name: str, known: Iterable[object]) -> str:
    """The known name nearest to this one, empty when none is near."""
    folded = {one.lower(): one for one in sorted({str(one) for one in known}, reverse=True)}
    near = difflib.get_close_matches(name[:100].lower(), folded, n=1, cutoff=0.6)
    return folded[near[0]] if near else ""


def _compose(text: str, file: str, mistakes: Mistakes) -> Node | None:
    if _bracket_depth(text) > 10 * DEEPEST:  # the YAML reader's time grows with its square
        mistakes.add(Position(file, 1, 1), "", got="endless nesting", expected=f"at most {DEEPEST} levels")
        return None
    try:
        node = _composed(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        at = Position(file, mark.line + 1, mark.column + 1) if mark else Position(file, 1, 1)
        told = " ".join(str(part) for part in (error.context, error.problem) if part)
        mistakes.add(
            at,
            "",
            got=f"broken YAML ({told})",
            expected="YAML",
            do=(
                "indent with spaces: YAML has no tabs"
                if ("found character '\\t'" in told)
                else "check brackets, quotes and indents"
            ),
        )
        return None
    except YAMLError:
        mistakes.add(Position(file, 1, 1), "", got="characters that are not text", expected="a text file")
        return None
    except RecursionError:
        mistakes.add(Position(file, 1, 1), "", got="endless nesting", expected=f"at most {DEEPEST} levels")
        return None
    except (ValueError, AssertionError, AttributeError, TypeError, LookupError) as error:
        # the YAML reader trips over some broken texts with its own errors
        mistakes.add(Position(file, 1, 1), "", got=f"broken YAML ({error})", expected="YAML")
        return None
    if node is None:
        mistakes.add(Position(file, 1, 1), "", got="an empty file", expected="a mapping", do="begin with 'title: ...'")
    return node


@lru_cache(maxsize=2)
def _composed(text: str) -> Node | None:
    """The nodes of a text, which nobody changes; kept for a model whose study alone is changed and read again."""
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
            if self.is_no_text(key, at, steps):
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
        return found

    def is_no_text(self, text: str, at: Position, steps: Steps) -> bool:
        """Note what no system can print, write or use in a name: NUL and its like, halves of characters."""
        found = _NO_TEXT.search(text)
        if found:
            self.mistakes.add(
                at,
                dotted(steps),
                got=f"a character that is no text (U+{ord(found[0]):04X})",
                expected="text",
                do="remove it",
            )
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
        if text in ("", "~", "null", "Null", "NULL"):
            return None
        if text in ("true", "True", "TRUE", "false", "False", "FALSE"):
            return text.lower() == "true"
        if _WHOLE.fullmatch(text):
            return int(text)
        if _REAL.fullmatch(text):
            return float(text)
        return float(_NOT_NUMBERS[text.lower()]) if text.lower() in _NOT_NUMBERS else text
