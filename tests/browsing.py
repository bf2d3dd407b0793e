"""A Chromium without a window, of Debian's packages chromium and chromium-driver."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from tweezer.viewing.movie import options_of_browser

if TYPE_CHECKING:
    from selenium.webdriver import Chrome


def chromium() -> Chrome | None:
    """It draws in 3-D by its own program, without a graphics card. None where there is none."""
    from selenium import webdriver

    browser, driver = (shutil.which(name) for name in ("chromium", "chromedriver"))
    if browser is None or driver is None:
        return None
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for argument in options_of_browser():
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options, webdriver.ChromeService(driver))


def resize(driver: Chrome, width: int, height: int) -> None:
    """Give it a screen of that size, a phone's if it is narrow."""
    screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
