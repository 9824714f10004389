#!/usr/bin/python3
"""Reports of the tool in Chromium: test_report_page.py SOUND.html OPEN.html FOLDER

SOUND is the report of a sound mesh whose input has a name that tries to be HTML, OPEN that of a
cloud with an opening and outliers. FOLDER gets the pictures.
"""
import json
import pathlib
import sys
import tempfile
import unittest

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select, WebDriverWait

SOUND, OPEN, FOLDER = (pathlib.Path(name).resolve() for name in sys.argv[1:4])
VIEWS = ("mesh", "cloud", "sphere")

# Of each view a hash of its pixels, how many colours it has and the part that is not background.
PICTURES = """
    report_views.draw();
    const canvas = report_views.canvas;
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const all = canvas.getBoundingClientRect();
    return Object.fromEntries(arguments[0].map((name) => {
      const r = document.getElementById('view-' + name).getBoundingClientRect();
      const pixels = new Uint32Array(context.getImageData(
        r.left - all.left, r.top - all.top, r.width, r.height).data.buffer);
      const covered = pixels.filter((pixel) => pixel !== 0).length / pixels.length;
      return [name, { hash: pixels.reduce((hash, x) => (Math.imul(hash, 31) + x) | 0, 7),
                      colors: new Set(pixels).size, covered }];
    }));"""


class Browser(webdriver.Chrome):
    """Chromium without a window, and with a profile of its own."""

    def __init__(self, *options):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        settings = webdriver.ChromeOptions()
        settings.binary_location = "/usr/bin/chromium"
        for option in ("--headless", "--no-sandbox", "--disable-dev-shm-usage", "--disable-quic",
                       "--no-first-run", "--disable-background-networking",
                       "--disable-component-update", "--disable-sync", "--window-size=1300,1300",
                       f"--user-data-dir={self.profile.name}", *options):
            settings.add_argument(option)
        settings.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        service = webdriver.chrome.service.Service("/usr/bin/chromedriver")
        super().__init__(service=service, options=settings)

    def open(self, page):
        """Opens a page. Returns the state that it comes to."""
        self.get(page.as_uri())
        return WebDriverWait(self, 120).until(
            lambda _: self.execute_script("return document.documentElement.dataset.report"))

    def quit(self):
        super().quit()
        self.profile.cleanup()


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
        cls.addClassCleanup(cls.browser.quit)

    def open(self, page):
        self.assertEqual(self.browser.open(page), "ready", self.text("problems"))

    def element(self, name):
        return self.browser.find_element(By.ID, name)

    def text(self, name):
        return self.element(name).text

    def run_script(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def pictures(self):
        return self.run_script(PICTURES, VIEWS)

    def changed(self, before):
        now = self.pictures()
        return tuple(view for view in VIEWS if now[view]["hash"] != before[view]["hash"])

    def move_slider(self, value):
        self.run_script("const frame = document.getElementById('frame');"
                        "frame.value = arguments[0]; frame.dispatchEvent(new Event('input'));",
                        value)

    def save(self, name):
        self.browser.save_screenshot(str(FOLDER / f"{name}.png"))

    def test_loads_in_silence_and_asks_the_network_for_nothing(self):
        for kind in ("browser", "performance"):
            self.browser.get_log(kind)  # of other tests
        for page in (SOUND, OPEN):
            self.open(page)
            self.assertEqual([entry for entry in self.browser.get_log("browser")
                              if entry["source"] != "rendering"], [])  # remarks on its speed
        urls = [message["params"]["request"]["url"] for message in
                (json.loads(entry["message"])["message"]
                 for entry in self.browser.get_log("performance"))
                if message["method"] == "Network.requestWillBeSent"
                and not message["params"]["documentURL"].startswith("chrome")]
        self.assertEqual({url for url in urls if not url.startswith(("data:", "blob:"))},
                         {SOUND.as_uri(), OPEN.as_uri()})

    def test_names_stay_text(self):
        self.open(SOUND)
        self.assertIn("<img src=x onerror=", self.text("title"))
        self.assertIn("<img src=x onerror=", self.text("command"))
        self.assertEqual(self.browser.find_elements(By.TAG_NAME, "img"), [])
        # An injected script would not run.
        self.run_script("const script = document.createElement('script');"
                        "script.textContent = 'window.ran = true'; document.body.append(script);")
        self.assertIsNone(self.run_script("return window.ran"))
        self.browser.get_log("browser")

    def test_says_the_verdict_its_reasons_and_the_numbers_of_the_report(self):
        self.open(SOUND)
        self.assertEqual(self.text("verdict-words"), "A sound mesh")
        for finding in ("Closed", "Manifold", "Oriented", "Genus 0", "No self-intersections"):
            self.assertIn(f"✓ {finding}", self.text("findings"))
        for part in ("stages", "numbers", "options", "levels"):
            self.assertGreater(len(self.text(part).splitlines()), 2, part)
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "#residual svg")), 1)
        report = json.loads(self.run_script(
            "const json = document.getElementById('json'); json.open = true;"
            "json.dispatchEvent(new Event('toggle')); return json.lastChild.textContent;"))
        for row in ("Vertices", "Triangles", "Volume", "Area", "Mean edge length", "Residual"):
            self.assertIn(row, self.text("numbers"))
        self.open(OPEN)
        self.assertEqual(self.text("verdict-words"), "A sound mesh, with doubts about the input")
        self.assertIn("opening", self.text("warnings"))
        self.assertIn("outlier", self.text("cloud-note"))

    def test_each_view_shows_its_object(self):
        for page, name in ((SOUND, "sound"), (OPEN, "open")):
            self.open(page)
            for view, picture in self.pictures().items():
                self.assertGreater(picture["colors"], 200, view)
                self.assertGreater(picture["covered"], 0.05, view)
                self.assertLess(picture["covered"], 0.95, view)
            self.save(name)

    def test_turning_or_zooming_one_view_does_so_in_all(self):
        self.open(SOUND)
        start = self.pictures()
        for view in VIEWS:
            before = self.pictures()
            ActionChains(self.browser).drag_and_drop_by_offset(
                self.element(f"view-{view}"), 40, 25).perform()
            self.assertEqual(self.changed(before), VIEWS, f"dragged {view}")
            before = self.pictures()
            self.run_script("document.getElementById(arguments[0]).dispatchEvent("
                            "new WheelEvent('wheel', {deltaY: -200}))", f"view-{view}")
            self.assertEqual(self.changed(before), VIEWS, f"zoomed {view}")
        self.element("reset").click()
        self.assertEqual(self.changed(start), ())

    def test_a_click_marks_the_same_vertex_in_all_views(self):
        self.open(SOUND)
        before = self.pictures()
        vertices = []
        for view in VIEWS:
            self.element(f"view-{view}").click()
            vertices.append(self.run_script("return report_views.marked"))
            self.assertIsNotNone(vertices[-1], view)
            self.assertEqual(self.changed(before), VIEWS, view)
            self.assertIn("area distortion ×", self.text("readout"))
        self.assertEqual(vertices[0], vertices[1], "mesh and cloud have the same places")

    def test_each_colouring_and_the_wireframe_have_their_pictures(self):
        self.open(SOUND)
        select = Select(self.element("color"))
        hashes = set()
        for option in [option.get_attribute("value") for option in select.options]:
            select.select_by_value(option)
            hashes.add(self.pictures()["mesh"]["hash"])
            self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, ".ramp")),
                             int(option in ("area", "angle", "residual")), option)
            self.save(f"color_{option}")
        # Without suspicious triangles that colouring is one colour, of another grey.
        self.assertEqual(len(hashes), len(select.options))
        before = self.pictures()
        self.element("wireframe").click()
        self.assertEqual(self.changed(before), ("mesh", "sphere"))
        self.element("wireframe").click()
        self.assertEqual(self.changed(before), ())

    def test_suspicious_triangles_are_counted_and_looked_at(self):
        self.open(SOUND)
        self.assertEqual(self.text("flags"), "No suspicious triangles.")
        self.open(OPEN)
        before = self.pictures()
        button = self.browser.find_element(By.CSS_SELECTOR, "#flags [data-bit='2']")
        self.assertRegex(button.text, r"Filled hole: [1-9]\d* triangles in 1 place")
        button.click()
        self.assertEqual(Select(self.element("color")).first_selected_option.text,
                         "suspicious triangles")
        self.assertEqual(self.changed(before), VIEWS)
        # The marked vertex is at the hole, which is the top of the bowl, in the middle of the view.
        self.assertEqual(*self.run_script(
            "return [report_views.target.toArray(),"
            "report_views.vector(report_views.marked).toArray()]"))
        self.save("suspicious")

    def test_the_unfolding_changes_the_sphere_and_ends_at_the_result(self):
        self.open(SOUND)
        result = self.pictures()
        count = int(self.element("frame").get_attribute("max"))
        self.assertEqual(self.text("caption"), "Result")
        seen = {result["sphere"]["hash"]}
        for frame in (0, count // 3, 2 * count // 3):
            self.move_slider(frame)
            seen.add(self.pictures()["sphere"]["hash"])
            self.assertIn(f"Frame {frame + 1} of {count}", self.text("caption"))
            self.save(f"frame_{frame}")
        self.assertEqual(len(seen), 4)
        self.move_slider(count)
        self.assertEqual(self.changed(result), ())
        self.element("play").click()
        WebDriverWait(self.browser, 60).until(
            lambda _: 0 < int(self.element("frame").get_property("value")) < count)
        self.element("play").click()
        self.assertEqual(self.text("play"), "Play")

    def test_browsers_that_cannot_draw_or_inflate_say_so(self):
        for options, script, state, place, words in (
                (("--disable-gpu", "--disable-3d-apis"), "", "text", "note", "need WebGL"),
                ((), "delete window.DecompressionStream", "failed", "problems", "too old for this page")):
            browser = Browser(*options)
            self.addCleanup(browser.quit)
            browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})
            self.assertEqual(browser.open(SOUND), state)
            self.assertIn(words, browser.find_element(By.ID, place).text)
            if state == "text":  # all else is shown
                self.assertEqual(browser.find_element(By.ID, "verdict-words").text, "A sound mesh")


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1], verbosity=2)
