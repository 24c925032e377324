"""The page of a study in a real browser, without a window: pictures load, sounds play, nothing sticks out."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from femstruct.language.cases import read_study
from femstruct.view.page import report
from femstruct.workflow.run import run_study, write_all

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-quic", "--allow-file-access-from-files",
    "--virtual-time-budget=20000", "--dump-dom",
)  # fmt: skip
# Loads the page in a frame as wide as a laptop's screen and writes down what its reader would see.
WATCHER = """<!doctype html><iframe id="page" src="report.html" width="1200" height="800"></iframe><pre id="seen"></pre>
<script>
document.getElementById("page").onload = () => {
  const page = document.getElementById("page").contentDocument;
  const sounds = [...page.querySelectorAll("audio")];
  Promise.all(sounds.map(one => new Promise(done => {
    if (one.readyState > 0 || one.error) done();
    one.onloadedmetadata = one.onerror = done;
  }))).then(() => {
    document.getElementById("seen").textContent = JSON.stringify({
      title: page.title,
      pictures: [...page.images].map(one => [one.alt, one.naturalWidth]),
      sounds: sounds.map(one => one.duration),
      tables: page.querySelectorAll("table").length,
      wide: page.documentElement.scrollWidth,
    });
  });
};
</script>"""
MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0.3], size: [0.4, 0.3], mesh: [8, 6]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {off: {on: plate, at: [0.17, 0.11]}}
surfaces: {below: {on: plate, side: below}}
damping: {ratio: 2 %}
"""
STUDY = """
title: 'A ball & a plate #1'
model: model.yaml
modes: {up_to: 800 Hz}
bodies: {ball: {mass: 10 g, above: off, speed: 1 m/s, contact: {type: hertz, stiffness: 1e8}}}
record: {off.z: velocity}
time: {duration: 0.2 s, sampling: 8 kHz}
rooms:
  box: {size: [0.4, 0.3, 0.2], under: below, losses: {t60: 0.1 s}, receivers: {mic: [0.1, 0.1, 0.1]}}
cases:
  light: {}
  'twice #2': {bodies.ball.mass: 20 g}
"""


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_the_page_in_a_browser(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL)
    (tmp_path / "one.study.yaml").write_text(STUDY)
    folder = tmp_path / "results"
    write_all(run_study(read_study(tmp_path / "one.study.yaml")), folder)
    (tmp_path / "sent").mkdir()
    (folder / "report.html").rename(tmp_path / "sent" / "report.html")  # alone, as by mail
    folder = tmp_path / "sent"
    (folder / "watcher.html").write_text(WATCHER)
    ran = subprocess.run(
        [str(CHROMIUM), *FLAGS, f"--user-data-dir={tmp_path / 'browser'}", (folder / "watcher.html").as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    found = re.search(r'<pre id="seen">(.+?)</pre>', ran.stdout, re.DOTALL)
    assert found is not None, ran.stdout[-2000:]
    seen = json.loads(unescape(found[1]))
    assert seen["title"] == "A ball & a plate #1"
    assert len(seen["pictures"]) >= 5 and min(width for _, width in seen["pictures"]) > 300
    (duration,) = seen["sounds"]
    assert duration == pytest.approx(0.2 + 0.5 + 0.2, abs=1e-3)  # s, samples of the sequence
    assert seen["tables"] >= 4 and seen["wide"] <= 1200


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_the_page_prints_on_a4_with_its_folds_open(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL)
    (tmp_path / "one.study.yaml").write_text(STUDY)
    plan = read_study(tmp_path / "one.study.yaml")
    text = report(run_study(plan), {f"history_{number}.png": square(number) for number in range(12)})
    (tmp_path / "report.html").write_text(text, encoding="utf-8")
    printed = tmp_path / "printed.pdf"
    flags = (*FLAGS[:-1], "--no-pdf-header-footer", f"--print-to-pdf={printed}", f"--user-data-dir={tmp_path / 'b'}")
    page = (tmp_path / "report.html").as_uri()
    subprocess.run([str(CHROMIUM), *flags, page], capture_output=True, timeout=120, check=True)
    pdf = printed.read_bytes()
    sheets = re.findall(rb"/MediaBox ?\[0 0 ([\d.]+) ([\d.]+)\]", pdf)
    assert len(sheets) >= 6  # three pictures a page at most, all of them in a fold
    sides = [(float(width), float(height)) for width, height in sheets]
    assert all(width == pytest.approx(595, abs=1) and height == pytest.approx(842, abs=1) for width, height in sides)
    assert len(re.findall(rb"/Subtype ?/Image", pdf)) >= 12


def square(number: int) -> bytes:
    """A picture of one grey, as PNG, each of another."""
    file = BytesIO()
    Image.new("L", (900, 450), 20 * number).save(file, format="PNG")
    return file.getvalue()
