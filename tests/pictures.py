"""Pictures of interactive pages: figures of the documentation and thumbnails of the gallery.

`make figures` makes all of them. They require Chromium and its driver.
"""

from __future__ import annotations

import base64
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tweezer
from tests.browsing import chromium, resize

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

FIGURES = Path(__file__).parents[1] / "docs" / "figures"

#: goes to a part of a run
SEEK = """
const [first, last] = tweezer.duration;
tweezer.seek(first + arguments[0] * (last - first));"""
#: shipped scenes on a figure of the whole page, and the part of the run that is over in it
SHOWN = {"silica-1um": 0.03, "flipping-rod": 0.2855}
#: the same for the thumbnails, of all shipped scenes; 0.1 if not listed
THUMBNAILS = {
    "moving-trap": 0.6,
    "two-traps": 0.3,
    "flipping-rod": 0.2855,
    "optical-conveyor": 0.4,
    "three-foci": 0.4,
    "levitated-200nm": 0.2,
    "polymer-solution": 0.02,
    "dna-between-beads": 0.9,
    "dumbbell": 0.15,
}
#: how many times the key I enlarges the view of a thumbnail; 0 if not listed
NEARER = {"flipping-rod": 4}
NEAR = """
for (let i = 0; i < arguments[0]; i++)
  document.body.dispatchEvent(new KeyboardEvent("keydown", {key: "i", bubbles: true}));
tweezer.draw();"""
#: hides what lies over the drawing and returns its box in the window
DRAWING = """
for (const over of document.querySelectorAll(".over, .forces")) over.style.display = "none";
const {x, y, width, height} = document.querySelector(".stage canvas").getBoundingClientRect();
return {x, y: y + (height - 0.75 * width) / 2, width, height: 0.75 * width, scale: 360 / width};"""


def main(names: list[str]) -> None:
    """Make the pictures of the scenes `names`, or of all."""
    driver = chromium()
    if driver is None:
        raise SystemExit("no chromium and chromedriver on this machine")
    resize(driver, 1280, 800)
    with tempfile.TemporaryDirectory() as folder:
        for name in names or tweezer.shipped_scenes():
            page = tweezer.view(name).save(Path(folder) / "page.html")
            if name in SHOWN:
                driver.get(page.as_uri())
                driver.execute_script(SEEK, SHOWN[name])
                _take(driver, FIGURES / f"view-{name}.png", {"format": "png"})
            for scheme in "light", "dark":
                media = [{"name": "prefers-color-scheme", "value": scheme}]
                driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": media})
                driver.get(page.as_uri())
                driver.execute_script(SEEK, THUMBNAILS.get(name, 0.1))
                driver.execute_script(NEAR, NEARER.get(name, 0))
                box = driver.execute_script(DRAWING)
                picture = {"format": "webp", "quality": 80, "clip": box}
                _take(driver, FIGURES / "gallery" / f"{name}-{scheme}.webp", picture)
            driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    driver.quit()


def _take(driver: Chrome, path: Path, picture: dict[str, Any]) -> None:
    """Write a picture of the window to `path`, in the format and clip that `picture` names."""
    taken = driver.execute_cdp_cmd("Page.captureScreenshot", picture)
    path.write_bytes(base64.b64decode(taken["data"]))


if __name__ == "__main__":
    main(sys.argv[1:])
