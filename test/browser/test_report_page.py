#!/usr/bin/python3
"""Tests of the page of -report in a real browser.

test_report_page.py made-up PAGE FOLDER      the page with data that are made up here
test_report_page.py real REPORT.html FOLDER  a file that the tool wrote

FOLDER gets the pictures and the file "results": a line "ok" or "FAILED" and a name for each test.
"""
import json
import pathlib
import signal
import subprocess
import sys
import time
import traceback

import webdriver

VIEWS = ("mesh", "cloud", "sphere")
TESTS = {"made-up": [], "real": []}


def test(*kinds):
    def register(function):
        for kind in kinds:
            TESTS[kind].append(function)
        return function
    return register


class Pages:
    """Files and browsers that the tests share."""

    def __init__(self, driver, kind, page, folder):
        self.driver, self.kind, self.page, self.folder = driver, kind, page, folder
        self.browser = driver.browser(webdriver.SOFTWARE_WEBGL)

    def make(self, name, *options):
        file = self.folder / f"{name}.html"
        subprocess.run([sys.executable, pathlib.Path(__file__).with_name("make_report.py"),
                        self.page, file, "--levels", "4", *options], check=True)
        return file

    def main(self):
        if self.kind == "real":
            return self.page
        file = self.folder / "report.html"
        return file if file.exists() else self.make("report")

    def open(self):
        """The main file, as it looks at first."""
        state = self.browser.open(self.main())
        assert state == "ready", f"{state}: {self.browser.text('body')[:300]}"
        return self.browser

    def save(self, name, png):
        (self.folder / f"report_{self.kind}_{name}.png").write_bytes(png)


def same(a, b, what=""):
    assert a == b, f"{what} {a!r} is not {b!r}"


def pictures(browser):
    """What the canvas shows in each view."""
    hashes = browser.canvas_hashes("#canvas", [f"#view-{view}" for view in VIEWS])
    return {view: hashes[f"#view-{view}"] for view in VIEWS}


def changed(before, after):
    return [view for view in VIEWS if before[view] != after[view]]


def data_of(file):
    text = file.read_text(encoding="utf-8")
    start = text.index('id="report-data">') + len('id="report-data">')
    return json.loads(text[start:text.index("</script>", start)])


def complaints(browser):
    """What the console was told, but for the driver's remark on screenshots of software WebGL."""
    return [entry["message"] for entry in browser.log("browser")
            if "GPU stall due to ReadPixels" not in entry["message"]]


def requests(browser):
    """Of the page: the browser's own first page asks for parts of itself."""
    urls = []
    for entry in browser.log("performance"):
        message = json.loads(entry["message"])["message"]
        about = message["params"]
        if message["method"] == "Network.webSocketCreated":
            urls.append(about["url"])
        elif message["method"] == "Network.requestWillBeSent":
            url = about["request"]["url"]
            if (not about["documentURL"].startswith("chrome://") and
                    not url.startswith(("data:", "blob:"))):
                urls.append(url)
    return urls


@test("made-up", "real")
def the_page_loads_without_a_word_on_the_console_and_asks_for_nothing(pages):
    browser = pages.open()
    same(complaints(browser), [])
    same(requests(browser), ["file://" + str(pages.main())])
    same(browser.text("#problems"), "")
    assert not browser.shown("#loading")


@test("made-up", "real")
def each_view_shows_its_object(pages):
    browser = pages.open()
    for view in VIEWS:
        rows = webdriver.pixels(browser.picture(f"#view-{view}"))
        background = rows[len(rows) - 12][12]
        colors = {pixel for row in rows for pixel in row}
        covered = sum(pixel != background for row in rows for pixel in row)
        share = covered / (len(rows) * len(rows[0]))
        assert len(colors) > 200, f"{view}: {len(colors)} colours"
        assert 0.05 < share < 0.95, f"{view}: {share:.0%} covered"
    pages.save("page", browser.whole_page())


@test("made-up", "real")
def turning_and_zooming_one_view_turns_and_zooms_all(pages):
    browser = pages.open()
    start = pictures(browser)
    for view in VIEWS:
        before = pictures(browser)
        browser.act(browser.pointer(f"#view-{view}", (-40, 0), "down", (30, 25), "up"))
        same(changed(before, pictures(browser)), list(VIEWS), f"dragged {view}:")
        before = pictures(browser)
        browser.wheel(f"#view-{view}", -200)
        same(changed(before, pictures(browser)), list(VIEWS), f"zoomed {view}:")
    browser.key("#view-cloud", "\ue012")
    before = pictures(browser)
    browser.key("#view-cloud", "\ue014")
    same(changed(before, pictures(browser)), list(VIEWS), "arrow key:")
    browser.key("#view-sphere", "r")
    browser.key("#view-mesh", "\ue00c")  # no mark where the pointer was
    same(changed(start, pictures(browser)), [], "after R:")


@test("made-up")
def fingers_turn_and_pinch(pages):
    browser = pages.open()
    before = pictures(browser)
    browser.act(browser.pointer("#view-mesh", (-40, 0), "down", (40, 10), "up", kind="touch"))
    same(changed(before, pictures(browser)), list(VIEWS), "one finger:")
    zoom = browser.run("return __reportViews.zoom")
    browser.act(
        browser.pointer("#view-sphere", (-20, 0), "down", (-80, 0), "up", kind="touch", name="a"),
        browser.pointer("#view-sphere", (20, 0), "down", (80, 0), "up", kind="touch", name="b"))
    assert browser.run("return __reportViews.zoom") > 2 * zoom, "pinched"


@test("made-up", "real")
def each_button_changes_the_picture_and_back(pages):
    browser = pages.open()
    for button, affected in (("wireframe", ["mesh", "sphere"]), ("normals", ["mesh", "cloud"]),
                             ("flat", ["mesh", "sphere"])):
        before = pictures(browser)
        same(browser.attribute(f"#{button}", "aria-pressed"), "false")
        browser.click(f"#{button}")
        same(browser.attribute(f"#{button}", "aria-pressed"), "true")
        now = pictures(browser)
        same(changed(before, now), affected, button)
        pages.save(button, browser.picture("#views"))
        browser.click(f"#{button}")
        same(browser.attribute(f"#{button}", "aria-pressed"), "false")
        same(changed(before, pictures(browser)), [], f"{button} off")
    browser.wheel("#view-mesh", -200)
    zoomed = pictures(browser)
    browser.click("#reset")
    same(changed(zoomed, pictures(browser)), list(VIEWS), "reset")
    same(complaints(browser), [])


def factor(words):
    return float(words.strip().lstrip("×").replace(",", ""))


@test("made-up", "real")
def each_colouring_has_its_picture_and_its_legend(pages):
    browser = pages.open()
    arrays = data_of(pages.main())["arrays"]
    keys = browser.run("return [...document.querySelectorAll('#color option')].map(o => o.value)")
    wanted = {"area_distortion": "area", "angle_distortion": "angle", "residual": "residual",
              "suspicious": "suspicious", "colors": "input"}
    same(sorted(keys), sorted(["place", "plain"] + [k for a, k in wanted.items() if a in arrays]))
    seen = {}
    for key in keys:
        browser.choose("#color", key)
        same(browser.attribute("#legend", "data-mode"), key)
        seen[key] = pictures(browser)["mesh"]
        pages.save(f"color_{key}", browser.picture(".card"))
    same(len(set(seen.values())), len(keys), "different pictures")

    for name, key in wanted.items():
        if name not in arrays or key not in ("area", "angle", "residual"):
            continue
        browser.choose("#color", key)
        low, high = arrays[name]["min"][0], arrays[name]["max"][0]
        same(float(browser.attribute("#legend .scale", "data-min")), low, name)
        same(float(browser.attribute("#legend .scale", "data-max")), high, name)
        ticks = browser.run(
            "return [...document.querySelectorAll('#legend .ticks span')].map(s => s.textContent)")
        first, last = factor(ticks[0]), factor(ticks[-1])
        if key == "area":
            low, high = 2 ** low, 2 ** high
            same(factor(ticks[2]), 1, "the middle")
        elif key == "residual":
            low, high = 10 ** low, 10 ** high
        # As many digits as are shown.
        assert abs(first / low - 1) < 0.06 and abs(last / high - 1) < 0.06, (name, ticks, low, high)


@test("made-up")
def suspicious_triangles_are_counted_and_shown_one_place_after_the_other(pages):
    browser = pages.open()
    flags = browser.run("""
        const select = document.querySelector('#color');
        select.value = 'suspicious';
        select.dispatchEvent(new Event('change'));
        return [...document.querySelectorAll('.flag')].map(
          b => [Number(b.dataset.bit), Number(b.dataset.count), b.disabled])""")
    browser.settle()
    # As make_report.py marks them, four levels of subdivision deep.
    same([bit for bit, _, _ in flags], [1, 2, 4, 8, 16])
    counts = {bit: count for bit, count, _ in flags}
    same(counts[16], len(range(0, 20 * 4 ** 4, 1999)))
    same(counts[8], 0)
    assert counts[2] > 10 and counts[4] > 5, counts
    for bit, count, disabled in flags:
        same(disabled, count == 0)
    marked = []
    for _ in range(2):
        before = pictures(browser)
        browser.click(".flag[data-bit='16']")
        same(changed(before, pictures(browser)), list(VIEWS), "went to a place:")
        assert browser.run("return __reportViews.zoom") > 1
        marked.append(browser.attribute("#readout", "data-vertex"))
        # The marked vertex is in the middle of its view, and belongs to a triangle of that flag.
        vertex = int(marked[-1])
        assert browser.run("""
            const triangles = __reportViews.triangles;
            for (let t = 0; t < triangles.length / 3; t += 1999) {
              if (triangles.subarray(3 * t, 3 * t + 3).includes(arguments[0])) return true;
            }
            return false;""", vertex), vertex
    assert marked[0] != marked[1], marked
    browser.click(".flag[data-bit='2']")
    pages.save("place", browser.picture(".card"))


PROJECT = """
    const views = __reportViews;
    views.place();
    const view = views.views[arguments[0]];
    const rows = arguments[0] === 'sphere' ? views.sphere : views.positions;
    const v = 3 * arguments[1];
    const p = view.camera.position.clone().set(rows[v], rows[v + 1], rows[v + 2]);
    view.turned.localToWorld(p);
    p.project(view.camera);
    const r = view.panel.getBoundingClientRect();
    return [p.x * r.width / 2, -p.y * r.height / 2];"""


@test("made-up", "real")
def a_point_is_marked_in_all_views(pages):
    browser = pages.open()
    clear = pictures(browser)
    browser.act(browser.pointer("#view-mesh", (-3, -2), (0, 0), 0.2))
    vertex = browser.attribute("#readout", "data-vertex")
    assert vertex, browser.text("#readout")
    same(changed(clear, pictures(browser)), list(VIEWS), "hover:")
    # Brought to the front of the sphere, the same vertex is found there.
    browser.act(browser.pointer("#view-mesh", (0, 0), "down", "up"))
    browser.run("__reportViews.lookAt({...__reportViews.marked, normal: "
                "Array.from(__reportViews.normals.subarray(3 * arguments[0], 3 * arguments[0] + 3))"
                "}, 6)", int(vertex))
    browser.settle()
    kept = browser.attribute("#readout", "data-vertex")
    for view in ("sphere", "mesh"):
        x, y = browser.run(PROJECT, view, int(kept))
        browser.act(browser.pointer(f"#view-{view}", (x, y), "down", "up"))
        same(browser.attribute("#readout", "data-vertex"), kept, view)
    pages.save("marked", browser.picture(".card"))
    browser.act(browser.pointer("h1", (0, 0)))
    same(browser.attribute("#readout", "data-vertex"), kept, "kept after a click")
    browser.key("#view-mesh", "\ue00c")
    same(browser.attribute("#readout", "data-vertex"), "", "after Esc")


@test("made-up")
def an_outlier_is_marked_with_the_vertex_next_to_it(pages):
    browser = pages.open()
    spot, nearest = browser.run("""
        const views = __reportViews;
        views.place();
        const view = views.views.cloud;
        const r = view.panel.getBoundingClientRect();
        // The one next to the eye: no other point is in front of it.
        let best = null;
        views.removed.forEach((flag, i) => {
          if (!flag) return;
          const at = view.camera.position.clone().fromArray(views.cloud, 3 * i);
          const seen = view.turned.localToWorld(at.clone());
          if (!best || seen.z > best.seen.z) best = {at, seen};
        });
        const p = best.seen.project(view.camera);
        const spot = views.pick('cloud', (p.x + 1) * r.width / 2, (1 - p.y) * r.height / 2);
        const rows = views.positions;
        let nearest = [Infinity];
        for (let v = 0; v < rows.length / 3; ++v) {
          const d = best.at.distanceTo(best.at.clone().fromArray(rows, 3 * v));
          if (d < nearest[0]) nearest = [d, v];
        }
        return [spot.vertex, nearest[1]];""")
    assert nearest > 0
    same(spot, nearest)


@test("made-up")
def many_outliers_far_off_do_not_stop_the_page(pages):
    # As many as the tool writes at most. To look for their vertices takes minutes.
    browser = pages.browser
    same(browser.open(pages.make("far", "--levels", "5", "--far", "75000")), "ready")
    same(complaints(browser), [])


@test("made-up", "real")
def the_unfolding_is_played_on_the_sphere(pages):
    browser = pages.open()
    history = data_of(pages.main())["history"]
    if pages.kind == "real" and history is None:
        assert not browser.shown("#unfolding")
        return
    frames = history["frames"]
    count = len(frames)
    same(browser.text("#caption"), "Result")
    result = pictures(browser)["sphere"]
    seen = set()
    for at in (0, count // 3, 2 * count // 3):
        browser.choose("#frame", at)
        seen.add(pictures(browser)["sphere"])
        caption = browser.text("#caption")
        assert f"Frame {at + 1} of {count}" in caption, caption
        assert f"{frames[at]['nodes']:,} nodes" in caption, caption
        same(browser.attribute("#legend", "data-mode"), "object")
        pages.save(f"frame_{at}", browser.picture(".card"))
    same(len(seen | {result}), 4, "pictures")
    browser.click("#result")
    same(pictures(browser)["sphere"], result, "result")
    browser.click("#play", settle=False)
    same(browser.text("#play"), "❚❚ Pause")
    shown = set()
    for _ in range(600):  # as long as a slow machine takes
        shown.add(browser.run("return document.querySelector('#frame').value"))
        if len(shown) > 2:
            break
        time.sleep(0.05)
    assert len(shown) > 2, "playing stands still"
    browser.click("#play")
    paused = browser.run("return document.querySelector('#frame').value")
    same(browser.text("#play"), "▶ Play")
    time.sleep(0.6)
    same(browser.run("return document.querySelector('#frame').value"), paused, "paused")
    same(complaints(browser), [])


@test("made-up")
def a_click_into_the_curve_goes_to_that_frame(pages):
    browser = pages.open()
    browser.run("document.querySelector('#residuals svg').scrollIntoView({block: 'center'})")
    browser.act(browser.pointer("#residuals svg", (0, 0), "down", "up"))
    at = int(browser.run("return document.querySelector('#frame').value"))
    assert 9 <= at <= 15, at
    same(browser.attribute("#residuals .cursor", "visibility"), "visible")


@test("made-up")
def a_long_run_of_the_solver_has_its_curve(pages):
    browser = pages.browser
    same(browser.open(pages.make("long", "--residuals", "200000")), "ready")
    same(complaints(browser), [])
    same(browser.run("return document.querySelectorAll('#residuals svg').length"), 2)
    assert "175,000" in browser.text("#residuals"), browser.text("#residuals")


@test("made-up", "real")
def the_copy_button_copies_the_command(pages):
    browser = pages.open()
    browser.cdp("Browser.grantPermissions", permissions=["clipboardReadWrite"])
    browser.click("#copy")
    for _ in range(600):  # as long as a slow machine takes
        told = browser.text("#copied")
        if told:
            break
        time.sleep(0.05)
    same(told, "Copied")
    text = browser.call("POST", "/execute/async", {
        "args": [], "script": "navigator.clipboard.readText().then(arguments[0], "
                              "e => arguments[0](String(e)))"})
    same(text, data_of(pages.main())["command"])


@test("made-up", "real")
def numbers_verdict_and_times_are_those_of_the_report(pages):
    browser = pages.open()
    report = data_of(pages.main())["report"]
    numbers = browser.text("#numbers")
    for value in (report["vertices"], report["triangles"]):
        assert f"{value:,}" in numbers, (value, numbers)
    same(browser.text("#summary"), report["diagnosis"]["summary"])
    names = browser.run(
        "return [...document.querySelectorAll('.bar-name')].map(e => e.textContent)")
    same(names, [stage["name"].replace("_", " ") for stage in report["stages"]])
    options = browser.text("#options")
    for name in report["options"]:
        assert name in options, name
    for warning in report["warnings"]:
        assert warning in browser.text("#warnings"), warning
    kind = browser.attribute("#verdict", "data-kind")
    sound = report["self_intersections"] == 0 and report["genus"] == 0
    same(kind == "bad", not sound, f"verdict {kind}:")


@test("made-up")
def a_report_without_history_cloud_and_faults_is_shown_as_well(pages):
    browser = pages.browser
    same(browser.open(pages.make("sound", "--sound")), "ready")
    same(complaints(browser), [])
    same(browser.attribute("#verdict", "data-kind"), "good")
    assert not browser.shown("#unfolding") and not browser.shown("#warnings")
    assert not browser.shown("#decimated")
    pages.save("sound", browser.whole_page())


@test("made-up")
def text_of_the_data_is_never_markup(pages):
    browser = pages.open()
    assert "</script>" in browser.text("#command")
    same(browser.run("return document.title"), "Report on script> & scan.ply")
    policy = browser.attribute("meta[http-equiv]", "content")
    assert "default-src 'none'" in policy and "unsafe-eval" not in policy, policy
    refused = browser.run("""
        const script = document.createElement('script');
        script.textContent = 'window.foreign = 1';
        document.body.append(script);
        return window.foreign === undefined;""")
    assert refused, "a script of others was run"
    browser.log("browser")


@test("made-up", "real")
def nothing_is_drawn_while_nothing_changes(pages):
    browser = pages.open()
    drawn = browser.run("return __reportViews.drawn")
    time.sleep(0.7)
    same(browser.run("return __reportViews.drawn"), drawn)


@test("made-up")
def a_simplified_copy_is_told(pages):
    browser = pages.browser
    same(browser.open(pages.make("decimated", "--decimated")), "ready")
    note = browser.text("#decimated")
    for number in ("5,120 of 128,000 triangles", "2,562 of 64,050 vertices"):
        assert number in note, note
    pages.save("decimated", browser.whole_page())


@test("made-up")
def a_damaged_array_is_told_and_the_rest_shown(pages):
    browser = pages.browser
    for name, options in (("residual", ["--corrupt", "residual"]),
                          ("cloud", ["--drop", "cloud"]),
                          ("history_frames", ["--corrupt", "history_frames"])):
        same(browser.open(pages.make("damaged", *options)), "ready", name)
        assert f'"{name}" is damaged' in browser.text("#problems"), browser.text("#problems")
        same(complaints(browser), [], name)
    for name, options in (("triangles", ["--corrupt", "triangles"]),
                          ("positions", ["--drop", "positions"])):
        same(browser.open(pages.make("damaged", *options)), "text", name)
        assert f'"{name}" is damaged' in browser.text("#problems"), browser.text("#problems")
        assert browser.shown("#views-note") and not browser.shown("#views")
        assert "5,120" in browser.text("#numbers")
        same(complaints(browser), [], name)
    pages.save("damaged", browser.whole_page())


@test("made-up")
def a_file_without_data_says_so(pages):
    browser = pages.browser
    same(browser.open(pages.page), "failed")
    assert "-report" in browser.text("#problems")
    same(complaints(browser), [])
    whole = pages.main().read_text(encoding="utf-8")
    cut = pages.folder / "cut.html"
    at = whole.index('id="report-data"') + 500
    bundle = whole.index('<script type="text/plain" id="bundle">')
    cut.write_text(whole[:at] + "</script>" + whole[bundle:], encoding="utf-8")
    same(browser.open(cut), "failed")
    assert "damaged" in browser.text("#problems")
    same(complaints(browser), [])


@test("made-up")
def without_webgl_all_text_is_there(pages):
    browser = pages.driver.browser(webdriver.NO_WEBGL)
    same(browser.open(pages.main()), "text")
    assert "WebGL" in browser.text("#views-note")
    assert browser.shown("#verdict") and browser.shown("#numbers") and browser.shown("#residuals")
    assert not browser.shown("#views") and not browser.shown("#toolbar")
    same(complaints(browser), [])
    pages.save("no_webgl", browser.whole_page())
    browser.close()


@test("made-up", "real")
def the_page_fits_a_phone_and_a_dark_room(pages):
    browser = pages.open()
    light = browser.run("return getComputedStyle(document.body).backgroundColor")
    browser.cdp("Emulation.setEmulatedMedia",
                features=[{"name": "prefers-color-scheme", "value": "dark"}])
    browser.settle()
    assert browser.run("return getComputedStyle(document.body).backgroundColor") != light
    pages.save("dark", browser.whole_page())
    browser.cdp("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=2,
                mobile=True)
    browser.open(pages.main())
    same(browser.run("return document.documentElement.scrollWidth"), 390)
    pages.save("phone", browser.whole_page())
    browser.cdp("Emulation.clearDeviceMetricsOverride")
    browser.cdp("Emulation.setEmulatedMedia", features=[])


@test("made-up")
def the_licence_of_three_is_in_the_page(pages):
    browser = pages.open()
    browser.click("summary")
    text = browser.text("footer")
    for words in ("three.js authors", "Permission is hereby granted", "WITHOUT WARRANTY"):
        assert words in text, words


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in TESTS:
        sys.exit(__doc__)
    kind, page, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.html").unlink(missing_ok=True)
    good = True
    # Ended from outside: the browsers end, too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    with webdriver.Driver() as driver, open(folder / "results", "w", encoding="utf-8") as results:
        pages = Pages(driver, kind, page.resolve(), folder)
        print("chromium", pages.browser.version)
        for function in TESTS[kind]:
            start = time.monotonic()
            try:
                function(pages)
                word = "ok"
            except Exception:  # a test fails by whatever it raises
                traceback.print_exc()
                word, good = "FAILED", False
            print(f"{word:6} {time.monotonic() - start:5.1f}s {function.__name__}", flush=True)
            results.write(f"{word} {function.__name__}\n")
    sys.exit(not good)


if __name__ == "__main__":
    main()
