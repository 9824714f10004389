#!/usr/bin/python3
"""Reports of the tool in Chromium: test_report_page.py SOUND OPEN CAMERA HANDLES PAIR FOLDER

SOUND is the report of a sound mesh whose input has a name that tries to be HTML, OPEN that of a cloud with an opening
and outliers, CAMERA that of the open mesh of what a depth camera saw of a ball, HANDLES that of a torus, PAIR that of
two surfaces. FOLDER gets the pictures.
"""

import base64
import json
import math
import pathlib
import re
import sys
import unittest
import zlib

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select, WebDriverWait

SOUND, OPEN, CAMERA, HANDLES, PAIR, FOLDER = (pathlib.Path(name).resolve() for name in sys.argv[1:7])
VIEWS = ("mesh", "cloud", "sphere")

# Of an image a hash of its pixels, how many colours it has and the part that is not background.
PICTURE = """
    const picture = ({data}) => {
      const pixels = new Uint32Array(data.buffer);
      return { hash: pixels.reduce((hash, x) => (Math.imul(hash, 31) + x) | 0, 7), colors: new Set(pixels).size,
               covered: pixels.filter((pixel) => pixel !== 0).length / pixels.length };
    };"""

# The same of each view.
PICTURES = PICTURE + """
    report_views.draw();
    const canvas = report_views.canvas;
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const all = canvas.getBoundingClientRect();
    return Object.fromEntries(arguments[0].map((name) => {
      const r = document.getElementById('view-' + name).getBoundingClientRect();
      return [name, picture(context.getImageData(r.left - all.left, r.top - all.top, r.width, r.height))];
    }));"""

# The view of the mesh after a change of its points and of where the input's origin is, and the area of its triangles
# that faces the camera there less that of which the back does. The change is a rotation by rows; `flip` turns the
# triangles inside out.
FIRST_VIEW = """
    const [rows, flip, closed] = arguments;
    const turn = new THREE.Matrix3().set(...rows);
    const {positions, triangles, origin} = report_views;
    const at = (i) => new THREE.Vector3().fromArray(positions, 3 * i).applyMatrix3(turn);
    const points = Float32Array.from(positions, (x, i) => at(Math.floor(i / 3)).toArray()[i % 3]);
    const corners = flip ? triangles.slice().reverse() : triangles;
    const eye = origin.clone().applyMatrix3(turn);
    const view = firstView(points, corners, new Uint8Array(triangles.length / 3), eye, closed);
    let facing = 0;
    for (let t = 0; t < corners.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => at(corners[t + k]));
      facing += b.sub(a).cross(c.sub(a)).dot(view.toward);
    }
    return [view.up.toArray(), facing];"""


def seen_from(page, place):
    """A copy of a page with the place of a sensor."""
    before, data, after = re.split('(?<=id="data">)([^<]*)', page.read_text())
    data = {**json.loads(zlib.decompress(base64.b64decode(data))), "view": place}
    copy = FOLDER / "seen.html"
    copy.write_text(before + base64.b64encode(zlib.compress(json.dumps(data).encode())).decode() + after)
    return copy


class Browser(webdriver.Chrome):
    """Chromium without a window; chromedriver gives it a profile of its own."""

    def __init__(self, *options):
        settings = webdriver.ChromeOptions()
        settings.binary_location = "/usr/bin/chromium"
        for option in ("--headless", "--no-sandbox", "--disable-dev-shm-usage", "--disable-component-update",
                       "--window-size=1300,1300", *options):  # fmt: skip
            settings.add_argument(option)
        settings.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        super().__init__(service=webdriver.chrome.service.Service("/usr/bin/chromedriver"), options=settings)

    def open(self, page):
        """Opens a page. Returns the state that it comes to."""
        self.get(page.as_uri())
        state = "return document.documentElement.dataset.report"
        return WebDriverWait(self, 120).until(lambda _: self.execute_script(state))


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

    def elements(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def run_script(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def pictures(self, views=VIEWS):
        return self.run_script(PICTURES, views)

    def check_pictures(self, pictures):
        for view, picture in pictures.items():
            self.assertGreater(picture["colors"], 100, view)
            self.assertTrue(0.05 < picture["covered"] < 0.95, (view, picture))

    def changed(self, before):
        now = self.pictures()
        return tuple(view for view in VIEWS if now[view]["hash"] != before[view]["hash"])

    def save(self, name):
        self.browser.save_screenshot(str(FOLDER / f"{name}.png"))

    def test_loads_in_silence_and_asks_the_network_for_nothing(self):
        for kind in ("browser", "performance"):
            self.browser.get_log(kind)  # of other tests
        pages = (SOUND, OPEN, CAMERA, HANDLES)
        for page in pages:
            self.open(page)
            said = [entry for entry in self.browser.get_log("browser") if entry["source"] != "rendering"]  # speed
            self.assertEqual(said, [])
        messages = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        urls = {message["params"]["request"]["url"] for message in messages
                if message["method"] == "Network.requestWillBeSent"
                and not message["params"]["documentURL"].startswith("chrome")}  # fmt: skip
        self.assertEqual({url for url in urls if not url.startswith(("data:", "blob:"))},
                         {page.as_uri() for page in pages})

    def test_names_stay_text(self):
        self.open(SOUND)
        self.assertIn("<img src=x onerror=", self.text("title"))
        self.assertIn("<img src=x onerror=", self.text("command"))
        self.assertEqual(self.elements("img"), [])
        # An injected script would not run.
        self.run_script("const script = document.createElement('script');"
                        "script.textContent = 'window.ran = true'; document.body.append(script);")
        self.assertIsNone(self.run_script("return window.ran"))
        self.browser.get_log("browser")

    def test_says_the_verdict_its_reasons_and_the_numbers_of_the_report(self):
        self.open(SOUND)
        self.assertEqual(self.text("verdict-words"), "A sound mesh.")
        for finding in ("Closed", "Manifold", "Oriented", "Genus 0", "No self-intersections"):
            self.assertIn(f"✓ {finding}", self.text("findings"))
        for part in ("stages", "numbers", "options", "levels"):
            self.assertGreater(len(self.text(part).splitlines()), 2, part)
        report = json.loads(self.run_script(
            "const json = document.getElementById('json'); json.open = true;"
            "json.dispatchEvent(new Event('toggle')); return json.lastChild.textContent;"))
        self.assertEqual(self.text("verdict-words"), report["verdict"])
        self.open(OPEN)
        self.assertEqual(self.text("verdict-words"), "A sound mesh, but it fills 1 opening; 2 stray points left out.")
        self.assertIn("opening", self.text("warnings"))
        self.assertIn("2 points left out", self.text("cloud-note"))

    def test_each_view_shows_its_object(self):
        for page, name in ((SOUND, "sound"), (OPEN, "open"), (CAMERA, "camera"),
                           (seen_from(CAMERA, [0, 0, 0]), "seen")):  # fmt: skip
            self.open(page)
            pictures = self.pictures()
            self.check_pictures(pictures)
            # Points are as large as their spacing: they just cover the object.
            self.assertAlmostEqual(pictures["cloud"]["covered"] / pictures["mesh"]["covered"], 1, delta=0.2)
            self.save(name)

    def camera(self):
        return self.run_script("const {up, position} = report_views.camera;"
                               "return [up.toArray(), position.clone().normalize().toArray()]")

    def test_opens_upright_at_the_side_that_shows_most_or_as_the_sensor_sees_it(self):
        for name, page, place, up, toward in (
                ("sound", SOUND, None, [0, 0, 1], None),
                ("camera", CAMERA, None, [0, -1, 0], (0, 0, -1)),
                ("ahead", CAMERA, [0, 0, 0], [0, -1, 0], (0, 0, -1)),
                ("level", SOUND, [100, 0, 0], [0, 0, 1], (1, 0, 0))):  # fmt: skip
            self.open(seen_from(page, place) if place else page)
            start = self.camera()
            self.assertEqual(start[0], up, name)
            if toward:
                self.assertLess(math.dist(start[1], toward), 0.02)
            else:
                # The hand is flat, and its fingers are next to each other along x.
                self.assertLess(start[1][1], -0.8)
                self.assertGreater(start[1][2], 0)
            self.run_script("report_views.lookAt(0)")
            self.element("reset").click()
            self.assertEqual(self.camera(), start, name)
            self.save(f"seen_{name}")

    def test_an_open_mesh_is_looked_at_from_its_front_and_one_with_y_up_upright(self):
        self.open(CAMERA)
        for flip in (False, True):
            for rows in ([1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, -1, 1, 0, 0, 0, -1, 0], [1, 0, 0, 0, 0, -1, 0, 1, 0]):
                self.assertGreater(self.run_script(FIRST_VIEW, rows, flip, False)[1], 0, (rows, flip))
        self.open(SOUND)
        self.assertEqual(self.run_script(FIRST_VIEW, [1, 0, 0, 0, 0, 1, 0, -1, 0], False, True)[0], [0, 1, 0])

    def test_several_surfaces_are_shown_together(self):
        self.open(PAIR)
        self.assertIn("2 surfaces:", self.text("tool"))
        self.assertEqual(self.text("size"), "3,000 vertices, 5,992 triangles")
        self.assertIn("2 surfaces together", self.text("shown"))
        self.assertIn("Triangles 5,992", self.text("numbers"))
        self.assertFalse(self.element("view-sphere").is_displayed())
        self.check_pictures(self.pictures(VIEWS[:2]))
        self.save("pair")

    def test_opens_with_the_faults_if_there_are_any(self):
        for page, mode in ((SOUND, "place"), (OPEN, "suspicious")):
            self.open(page)
            self.assertEqual(self.element("color").get_property("value"), mode)

    def test_turning_or_zooming_one_view_does_so_in_all(self):
        self.open(SOUND)
        start = self.pictures()
        for view in VIEWS:
            before = self.pictures()
            ActionChains(self.browser).drag_and_drop_by_offset(self.element(f"view-{view}"), 40, 25).perform()
            self.assertEqual(self.changed(before), VIEWS, f"dragged {view}")
            before = self.pictures()
            self.run_script("arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -200}))",
                            self.element(f"view-{view}"))  # fmt: skip
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
            self.assertEqual(len(self.elements(".ramp")), int(option in ("area", "angle", "residual")), option)
            self.save(f"color_{option}")
        # Without suspicious triangles that colouring is one colour, of another grey.
        self.assertEqual(len(hashes), len(select.options))
        before = self.pictures()
        self.element("wireframe").click()
        self.assertEqual(self.changed(before), ("mesh", "sphere"))
        self.element("wireframe").click()
        self.assertEqual(self.changed(before), ())

    def test_a_mesh_with_handles_has_no_sphere(self):
        self.open(HANDLES)
        self.assertEqual(self.text("verdict-words"), "A sound mesh with 1 handle.")
        self.assertIn("✓ Genus 1", self.text("findings"))
        self.assertFalse(self.element("view-sphere").is_displayed())
        values = [option.get_attribute("value") for option in Select(self.element("color")).options]
        self.assertEqual(values, ["suspicious", "plain"])
        self.assertEqual(self.element("color").get_property("value"), "plain")
        self.check_pictures(self.pictures(VIEWS[:2]))
        self.save("handles")

    def test_suspicious_triangles_are_counted_and_looked_at(self):
        self.open(SOUND)
        self.assertEqual(self.text("flags"), "No suspicious triangles.")
        self.open(OPEN)
        before = self.pictures()
        [button] = self.elements("#flags [data-bit='2']")
        self.assertRegex(button.text, r"Filled hole: [1-9]\d* triangles in 1 place")
        button.click()
        self.assertEqual(Select(self.element("color")).first_selected_option.text, "suspicious triangles")
        self.assertEqual(self.changed(before), VIEWS)
        # The marked vertex is at the hole, which is the top of the bowl, in the middle of the view.
        self.assertEqual(*self.run_script("const {target, marked} = report_views;"
                                          "return [target.toArray(), report_views.vector(marked).toArray()]"))
        self.save("suspicious")

    def test_browsers_that_cannot_draw_or_inflate_say_so(self):
        for options, script, state, place, words in (
                (("--disable-gpu", "--disable-3d-apis"), "", "still", "still", "no WebGL, so this is a still picture"),
                ((), "delete window.DecompressionStream", "failed", "problems", "too old for this page")):
            browser = Browser(*options)
            self.addCleanup(browser.quit)
            browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})
            self.assertEqual(browser.open(SOUND), state)
            self.assertIn(words, browser.find_element(By.ID, place).text)
            if state == "still":  # all else is shown
                self.assertEqual(browser.find_element(By.ID, "verdict-words").text, "A sound mesh.")
                self.assertFalse(browser.find_element(By.ID, "show").is_displayed())
                browser.save_screenshot(str(FOLDER / "still.png"))
                self.check_pictures({"still": browser.execute_script(PICTURE + '''
                    const canvas = document.querySelector('#still canvas');
                    return picture(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height));''')})


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1], verbosity=2)
