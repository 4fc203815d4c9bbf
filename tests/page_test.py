#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens pages of `isoshade page` in headless Chromium and uses them: page_test.py COMMAND GRAPHS [--screenshots FOLDER]

Needs the packages chromium and chromium-driver; exits with 77, which ctest counts as skipped, where they are missing.
"""
import argparse
import base64
import json
import os
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

SKIPPED = 77
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the key of an element's id in the WebDriver protocol
ARROW_RIGHT = "\ue014"


class Browser:
    """Chromium, driven by chromedriver (the WebDriver protocol)."""

    def __init__(self, folder):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        self.session = ""
        for _ in range(600):
            try:
                self.call("GET", "/status")
                break
            except OSError:
                time.sleep(0.1)
        options = {"binary": shutil.which("chromium"),
                   "args": ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
                            "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--window-size=1280,900",
                            f"--user-data-dir={folder}"]}
        made = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
            "timeouts": {"script": 300000, "pageLoad": 300000},  # milliseconds; the machine may be busy
            "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.session = "/session/" + made["sessionId"]

    def call(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", method=method, data=data,
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            sys.exit(f"chromedriver: {error.read().decode()[:1000]}")

    def do(self, method, path, body=None):
        return self.call(method, self.session + path, body)

    def run(self, script, *arguments):
        return self.do("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def find(self, selector):
        return self.do("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]

    def press(self, selector, keys):
        self.do("POST", f"/element/{self.find(selector)}/value", {"text": keys})

    def click(self, selector):
        self.do("POST", f"/element/{self.find(selector)}/click", {})

    def drag(self, selector, dx, dy):
        origin = {ELEMENT: self.find(selector)}
        self.do("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "duration": 0, "origin": origin, "x": 0, "y": 0},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerMove", "duration": 100, "origin": origin, "x": dx, "y": dy},
            {"type": "pointerUp", "button": 0}]}]})

    def picture(self):
        """The canvas as a PNG, once the page has drawn what was asked of it."""
        self.do("POST", "/execute/async",
                {"script": "requestAnimationFrame(() => requestAnimationFrame(arguments[0]));", "args": []})
        return base64.b64decode(self.do("GET", f"/element/{self.find('#picture')}/screenshot"))

    def messages(self):
        return [entry["message"] for entry in self.do("POST", "/se/log", {"type": "browser"})]

    def close(self):
        if self.session:
            self.do("DELETE", "")
        self.driver.terminate()
        self.driver.wait()


class Failures:
    def __init__(self):
        self.count = 0

    def expect(self, holds, text):
        if not holds:
            self.count += 1
            print("FAILED: " + text)


def make_page(command, scene, page):
    made = subprocess.run([command, "page", scene, "-o", page], capture_output=True, text=True)
    if made.returncode != 0:
        sys.exit(f"isoshade page {scene}:\n{made.stdout}{made.stderr}")


def open_page(browser, page, failures, name):
    """Loads a page and waits for its first picture."""
    browser.do("POST", "/url", {"url": "file://" + page})
    for _ in range(600):
        state = browser.run("return [document.getElementById('picture').dataset.frames, "
                            "document.getElementById('error').textContent]")
        if state[0] or state[1]:
            break
        time.sleep(0.1)
    failures.expect(state[0] is not None and state[1] == "", f"{name} draws: {state[1]}")
    return state[1] == ""


def check_scene(browser, command, graphs, folder, screenshots, failures, name, setting, most):
    """`most`: the percentage of pixels that may differ by more than 1/255."""
    scene = os.path.join(graphs, "scenes", name + ".json")
    page = os.path.join(folder, name + ".html")
    make_page(command, scene, page)
    if not open_page(browser, page, failures, name):
        return
    measured = browser.run("return {...document.getElementById('measured').dataset}")
    failures.expect("pixels" in measured, f"{name} compares its picture with that of the CPU")
    numbers = {key: int(value) for key, value in measured.items()}
    print(f"{name}: {os.path.getsize(page) / 1e6:.1f} MB; {browser.run('return measured.textContent')}")
    # What differs are pixels on edges of triangles, which WebGL2 places by its own rules, and whatever depends on
    # derivatives, which it takes over blocks of 2 x 2 pixels.
    failures.expect(numbers.get("encoded", 0) <= most / 100 * numbers["pixels"],
                    f"{name}: at most {most} % of the pixels differ by more than 1/255")
    failures.expect(numbers["pixels"] == 256 * browser.run("return readData().reference.height"),
                    f"{name} compares every pixel")
    largest = browser.run("""
        const {camera, reference, layouts} = readData(), own = viewOf(camera, reference.width, reference.height);
        return Math.max(...Object.entries(unpack(reference.view, 0, layouts.view)).flatMap(([part, words]) =>
            words.map((word, i) => Math.abs(word - own[part][i]) / Math.max(1, Math.abs(word)))));""")
    failures.expect(largest < 1e-5, f"{name}: the view is isoshade's, but for rounding: {largest}")

    first = browser.picture()
    failures.expect(browser.picture() == first, f"{name}: the picture rests while nothing changes")
    row = f'[data-setting="{setting}"]'
    browser.run("document.querySelector(arguments[0]).closest('details').open = true", row)
    browser.press(row + " input[type=range]", ARROW_RIGHT * 12)
    moved = browser.picture()
    failures.expect(moved != first, f"{name}: the slider of {setting} changes the picture")
    settings = browser.run("return document.getElementById('settings').value")
    failures.expect(f"--set {setting}=" in settings, f"{name}: the settings name {setting}: {settings}")
    browser.drag("#picture", 80, 30)
    failures.expect(browser.picture() != moved, f"{name}: the mouse turns the scene")
    settings = browser.run("return document.getElementById('settings').value").replace("\\\n", " ")
    failures.expect("--set camera.position=" in settings, f"{name}: the settings name the camera: {settings}")
    picture = os.path.join(folder, name + ".png")
    rendered = subprocess.run([command, "render", scene, "-o", picture, "--size", "32x18", "-q"] + shlex.split(settings),
                              capture_output=True, text=True)
    failures.expect(rendered.returncode == 0, f"{name}: render accepts the settings: {rendered.stderr}")
    if screenshots:
        save(browser, os.path.join(screenshots, name + "_changed.png"))
    browser.click("#reset")
    failures.expect(browser.picture() == first, f"{name}: Reset all brings back the first picture")
    if screenshots:
        save(browser, os.path.join(screenshots, name + ".png"))
    failures.expect(browser.messages() == [], f"{name}: the console stays empty")


def save(browser, path):
    browser.run("scrollTo(0, 0)")
    with open(path, "wb") as file:
        file.write(base64.b64decode(browser.do("GET", "/screenshot")))


HOSTILE = """</script><script>document.title = "taken"</script><img src=x onerror="document.title='taken'">&amp; ' " ` ${1} \\u2028 <!-- ]]>"""


def check_hostile_texts(browser, command, graphs, folder, failures):
    """No text of a document becomes code or markup."""
    # Names are letters, digits and "_", but may be those that every object of JavaScript has.
    effect = {"isoshade": 1, "effect": "flat", "doc": HOSTILE,
              "parameters": {"constructor": {"type": "color3", "value": [0.2, 0.4, 0.8], "doc": HOSTILE},
                             "__proto__": {"type": "float", "value": 1, "min": 0, "max": 2, "doc": HOSTILE},
                             "time": {"type": "integer", "value": 1, "enum": ["false", "true"]},
                             "toString": {"type": "filename", "value": "<b>.png", "doc": HOSTILE}},
              "nodes": {"picture": {"type": "image", "file": {"link": "toString"}},
                        "bright": {"type": "multiply", "in1": "constructor", "in2": "__proto__", "doc": HOSTILE},
                        "lit": {"type": "add", "in1": "bright", "in2": "picture.rgb"}},
              "passes": [{"name": "base", "color": "lit"}]}
    scene = {"isoshade": 1, "scene": "hostile", "doc": HOSTILE, "size": [64, 48],
             "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
             "objects": {"prototype": {"mesh": "sphere", "effect": "flat.json"}}}
    for name, document in (("flat.json", effect), ("hostile.json", scene)):
        with open(os.path.join(folder, name), "w") as file:
            json.dump(document, file)
    shutil.copy(os.path.join(graphs, "textures", "leaf.png"), os.path.join(folder, "<b>.png"))
    page = os.path.join(folder, "hostile.html")
    make_page(command, os.path.join(folder, "hostile.json"), page)
    if not open_page(browser, page, failures, "hostile"):
        return
    failures.expect(browser.run("return document.title") == "hostile \u2013 isoshade", "no text is run as code")
    failures.expect(browser.run("return document.images.length") == 0, "no text becomes an element")
    failures.expect(browser.run("return document.getElementById('doc').textContent") == HOSTILE, "texts are shown as they are")
    failures.expect(browser.run("return document.querySelector('[data-setting=\"prototype.__proto__\"]').title") == HOSTILE,
                    "the docs of parameters are shown as they are")
    failures.expect(browser.messages() == [], "hostile: the console stays empty")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("graphs")
    parser.add_argument("--screenshots")
    arguments = parser.parse_args()
    missing = [program for program in ("chromium", "chromedriver") if shutil.which(program) is None]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; install the packages chromium and chromium-driver")
        return SKIPPED
    failures = Failures()
    graphs = os.path.abspath(arguments.graphs)
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(os.path.join(folder, "profile"))
        try:
            for name, setting, most in (("material_balls", "balls.roughness", 2), ("cartoon_tub", "tub.outline", 6),
                                        ("fog_balls", "fog.fog_density", 1)):
                check_scene(browser, arguments.command, graphs, folder, arguments.screenshots, failures, name, setting,
                            most)
            check_hostile_texts(browser, arguments.command, graphs, folder, failures)
        finally:
            browser.close()
    print("passed" if failures.count == 0 else f"{failures.count} failed")
    return 1 if failures.count else 0


if __name__ == "__main__":
    sys.exit(main())
