"""Pictures of pages for the documentation: `make figures`. They need Chromium and its driver."""

from __future__ import annotations

import base64
import sys
import tempfile
from pathlib import Path

import tweezer
from tests.browsing import chromium, resize

FIGURES = Path(__file__).parents[1] / "docs" / "figures"

#: goes to a part of a run
SEEK = """
const [first, last] = tweezer.duration;
tweezer.seek(first + arguments[0] * (last - first));"""
#: scenes, and the part of the run that is over in the picture
SHOWN = {"silica-1um": 0.03}


def main(names: list[str]) -> None:
    """Draw those of `names`, or all."""
    driver = chromium()
    if driver is None:
        raise SystemExit("no chromium and chromedriver on this machine")
    resize(driver, 1280, 800)
    with tempfile.TemporaryDirectory() as folder:
        for name in names or SHOWN:
            page = tweezer.view(name).save(Path(folder) / "page.html")
            driver.get(page.as_uri())
            driver.execute_script(SEEK, SHOWN.get(name, 0.1))
            taken = driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
            (FIGURES / f"view-{name}.png").write_bytes(base64.b64decode(taken["data"]))
    driver.quit()


if __name__ == "__main__":
    main(sys.argv[1:])
