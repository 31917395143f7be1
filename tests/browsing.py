"""Functions that serve the interactive page of a brake and move its sliders in a real browser.

The browser runs without a screen.
"""

import signal
import subprocess
import sys
from contextlib import contextmanager
from urllib.parse import parse_qsl

import pytest

import drumlin
from conftest import STUDY
from drumlin.brake import read_brake, vary

DRIVER = "/usr/bin/chromedriver"
PROGRAM = [sys.executable, "-c", "from drumlin.cli import main; main()"]


@contextmanager
def served(program=PROGRAM, brake_file=STUDY / "brake.toml", **process):
    """The address of the interactive page of a brake, which a separate process serves."""
    command = [*map(str, program), "explore", str(brake_file), "--port", "0", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, **process) as server:
        try:
            assert server.stdout is not None
            yield server.stdout.readline().rsplit(" ", 1)[1].strip()
        finally:
            server.send_signal(signal.SIGINT)
            try:
                assert server.wait(10) == 0
            finally:
                # Popen would wait for the killed server without end.
                server.kill()


@contextmanager
def browser(folder):
    """A browser without a screen that makes no connections to other machines."""
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for word in (
        "headless",
        "no-sandbox",
        "disable-gpu",
        "disable-quic",
        "no-first-run",
        "disable-background-networking",
        "disable-component-update",
        "disable-sync",
        "window-size=1280,900",
        f"user-data-dir={folder / 'profile'}",
    ):
        options.add_argument(f"--{word}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with webdriver.Chrome(options, Service(DRIVER)) as page:
        yield page


def play(page, address):
    """Move the sliders of the study brake's page and compare each torque with that of solve.

    Returns the link to the state that the page shows at the end.
    """
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import WebDriverWait

    def torque():
        return float(page.find_element(By.ID, "head").text.split("torque ")[1].split(" N m")[0])

    page.get(address)
    wait = WebDriverWait(page, 60)
    wait.until(lambda page: "torque" in page.find_element(By.ID, "head").text)
    brake = read_brake(STUDY / "brake.toml")
    assert torque() == pytest.approx(drumlin.solve(brake).torque, rel=1e-4)
    page.find_element(By.ID, "friction").send_keys(Keys.ARROW_RIGHT * 8)
    assert page.find_element(By.ID, "friction-value").get_attribute("value") == "0.34"
    # The address in the page's link tells when the answer has settled.
    wait.until(lambda page: "friction=0.34" in page.current_url)
    expected = drumlin.solve(vary(brake, {"friction": 0.34}))
    assert torque() == pytest.approx(expected.torque, rel=1e-4)
    # Another thickness of the shoe's body needs bodies that are not in the cache.
    page.find_element(By.ID, "shoe").send_keys(Keys.PAGE_DOWN * 5)
    wait.until(lambda page: "shoe=" in page.current_url)
    E = float(dict(parse_qsl(page.current_url.split("?")[1]))["shoe"]) * 1e9
    expected = drumlin.solve(vary(brake, {"friction": 0.34, "shoe.body.material.E": E}))
    assert torque() == pytest.approx(expected.torque, rel=1e-4)
    # A number that is typed counts to its last digit, and the slider follows.
    field = page.find_element(By.ID, "hinge-value")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys("4.137", Keys.ENTER)
    wait.until(lambda page: "hinge=4.137" in page.current_url)
    slider = page.find_element(By.ID, "hinge").get_attribute("value")
    assert float(slider) == pytest.approx(4.137)
    link = page.find_element(By.ID, "link").get_attribute("href")
    before = torque()
    # A page of its own must show the same state by the link alone.
    page.get(link)
    wait.until(lambda page: "torque" in page.find_element(By.ID, "head").text)
    assert torque() == before
    return link
