"""Write docs/findings.md from the catalogue of findings; `tests/unit/test_findings.py` says when it is out of date."""

from pathlib import Path

from femstruct.findings.explain import page

PAGE = Path(__file__).resolve().parents[1] / "docs" / "findings.md"

if __name__ == "__main__":
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written to {PAGE}")
