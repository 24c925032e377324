"""Write the table of the modules whose nouns have tags, `femstruct/files/tagged_modules.py`, anew.

After a module or a noun with a tag was added, moved or renamed: `python scripts/stored_tags.py`. A test compares.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLE = Path("femstruct", "files", "tagged_modules.py")
HEAD = '''"""Where the nouns with tags are, for whoever reads a results file: written by `scripts/stored_tags.py`.

Only modules whose nouns a file has are imported.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

MODULES: Final[Mapping[str, str]] = MappingProxyType(
    {
'''


def tags_of(path: Path) -> Iterator[str]:
    """The tags that stand in a module, in the order of its lines."""
    text = path.read_text(encoding="utf-8")
    for node in ast.parse(text).body if "@stored_as(" in text else ():
        for one in getattr(node, "decorator_list", ()):
            if isinstance(one, ast.Call) and isinstance(one.func, ast.Name) and one.func.id == "stored_as":
                yield ast.literal_eval(one.args[0])


def table(root: Path) -> str:
    """The table as it should be, of the packages in a folder."""
    lines = []
    for package in ("acoustics", "femstruct"):
        for path in sorted((root / package).rglob("*.py")):
            module = ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
            lines += [f'        "{tag}": "{module}",\n' for tag in tags_of(path)]
    return f"{HEAD}{''.join(lines)}    }}\n)\n"


if __name__ == "__main__":
    (ROOT / TABLE).write_text(table(ROOT), encoding="utf-8")
    print(f"written to {ROOT / TABLE}")
