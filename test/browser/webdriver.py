"""Drives Debian's chromium through chromedriver's HTTP interface (W3C WebDriver): nothing but the
standard library is needed."""
import base64
import json
import re
import shutil
import struct
import subprocess
import tempfile
import threading
import time
import urllib.error
import urllib.request
import zlib

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
CHROMIUM_FLAGS = [
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
    "--no-first-run", "--no-default-browser-check", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-quic", "--disable-extensions",
    "--force-device-scale-factor=1",
]
SOFTWARE_WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


class Driver:
    """A running chromedriver; ends with all of its browsers."""

    def __enter__(self):
        self.sessions = []
        # It takes a free port itself and tells which: one that is looked for here might be taken
        # by another program meanwhile.
        self.process = subprocess.Popen(
            [shutil.which("chromedriver") or "chromedriver", "--port=0"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            self.url = f"http://127.0.0.1:{self.port()}"
            # What else it prints must not fill the pipe.
            threading.Thread(target=self.process.stdout.read, daemon=True).start()
            for _ in range(300):
                try:
                    if self.call("GET", "/status")["ready"]:
                        return self
                except OSError:
                    pass
                time.sleep(0.1)
            raise RuntimeError("chromedriver does not answer")
        except BaseException:
            self.end()
            raise

    def port(self):
        for line in self.process.stdout:
            found = re.search(r"on port ([1-9][0-9]*)", line)
            if found:
                return int(found[1])
        raise RuntimeError("chromedriver does not start")

    def end(self):
        self.process.terminate()
        self.process.wait()

    def __exit__(self, *_):
        for session in self.sessions:
            session.close()
        self.end()

    def call(self, method, path, body=None):
        data = None if method == "GET" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.url + path, data=data, method=method,
                                         headers={"Content-Type": "application/json"})
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def browser(self, flags, size=(960, 900)):
        session = Browser(self, flags, size)
        self.sessions.append(session)
        return session


class Browser:
    def __init__(self, driver, flags, size):
        self.driver = driver
        self.profile = tempfile.mkdtemp(prefix="report-browser-")
        arguments = CHROMIUM_FLAGS + flags + [f"--user-data-dir={self.profile}",
                                              f"--window-size={size[0]},{size[1]}"]
        try:
            answer = driver.call("POST", "/session", {"capabilities": {"alwaysMatch": {
                "browserName": "chrome",
                "goog:chromeOptions": {"binary": shutil.which("chromium"), "args": arguments},
                "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
            }}})
        except BaseException:
            shutil.rmtree(self.profile, ignore_errors=True)
            raise
        self.path = "/session/" + answer["sessionId"]
        self.version = answer["capabilities"]["browserVersion"]
        # What was drawn last can be read at any time: see canvas_hashes().
        self.cdp("Page.addScriptToEvaluateOnNewDocument", source="""
            const get = HTMLCanvasElement.prototype.getContext;
            HTMLCanvasElement.prototype.getContext = function (kind, options) {
              const more = kind === 'webgl2' ? {...options, preserveDrawingBuffer: true} : options;
              return get.call(this, kind, more);
            };""")

    def close(self):
        try:
            self.call("DELETE", "")
        except (RuntimeError, OSError):
            pass
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, path, body=None):
        return self.driver.call(method, self.path + path, body)

    def open(self, file):
        self.log("browser")
        self.log("performance")
        self.call("POST", "/url", {"url": "file://" + str(file)})
        for _ in range(600):
            state = self.run("return document.documentElement.dataset.report || ''")
            if state:
                self.settle()
                return state
            time.sleep(0.05)
        raise RuntimeError("the page does not become ready")

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def settle(self):
        """Waits until what was asked for is drawn and shown."""
        self.call("POST", "/execute/async", {"args": [], "script": """
            const done = arguments[0];
            let quiet = 0;
            const look = () => {
              quiet = window.__reportViews?.requested ? 0 : quiet + 1;
              if (quiet > 2) done(); else requestAnimationFrame(look);
            };
            look();"""})

    def cdp(self, command, **parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def log(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def element(self, selector):
        return self.call("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0]).innerText", selector)

    def attribute(self, selector, name):
        return self.run("return document.querySelector(arguments[0]).getAttribute(arguments[1])",
                        selector, name)

    def shown(self, selector):
        return self.run("return document.querySelector(arguments[0])?.checkVisibility() ?? false",
                        selector)

    def click(self, selector, settle=True):
        self.call("POST", f"/element/{self.element(selector)}/click")
        if settle:
            self.settle()

    def key(self, selector, key):
        self.call("POST", f"/element/{self.element(selector)}/value", {"text": key})
        self.settle()

    def choose(self, selector, value):
        self.run("const s = document.querySelector(arguments[0]); s.value = arguments[1];"
                 "s.dispatchEvent(new Event(s.type === 'range' ? 'input' : 'change'));",
                 selector, value)
        self.settle()

    def act(self, *sources):
        self.call("POST", "/actions", {"actions": list(sources)})
        self.call("DELETE", "/actions")
        self.settle()

    def pointer(self, selector, *steps, kind="mouse", name="pointer"):
        """Steps: (x, y) from the element's middle, "down", "up" or a pause in seconds."""
        origin = {ELEMENT: self.element(selector)}
        actions = []
        for step in steps:
            if step in ("down", "up"):
                actions.append({"type": "pointer" + step.capitalize(), "button": 0})
            elif isinstance(step, (int, float)):
                actions.append({"type": "pause", "duration": int(1000 * step)})
            else:
                actions.append({"type": "pointerMove", "duration": 30, "origin": origin,
                                "x": round(step[0]), "y": round(step[1])})
        return {"type": "pointer", "id": name, "parameters": {"pointerType": kind},
                "actions": actions}

    def wheel(self, selector, amount):
        origin = {ELEMENT: self.element(selector)}
        self.act({"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "x": 0, "y": 0, "deltaX": 0, "deltaY": amount, "origin": origin}]})

    def picture(self, selector=None):
        path = f"/element/{self.element(selector)}/screenshot" if selector else "/screenshot"
        return base64.b64decode(self.call("GET", path))

    def canvas_hashes(self, canvas, parts):
        """A number for what the canvas shows in the area of each part, by the part's selector."""
        return self.run("""
            const source = document.querySelector(arguments[0]);
            const whole = source.getBoundingClientRect();
            const scale = source.width / whole.width;
            const copy = document.createElement('canvas');
            const hashes = {};
            for (const part of arguments[1]) {
              const rect = document.querySelector(part).getBoundingClientRect();
              copy.width = Math.round(rect.width * scale);
              copy.height = Math.round(rect.height * scale);
              const context = copy.getContext('2d', {willReadFrequently: true});
              context.drawImage(source, Math.round((whole.left - rect.left) * scale),
                                Math.round((whole.top - rect.top) * scale));
              const bytes = context.getImageData(0, 0, copy.width, copy.height).data;
              let hash = 0;
              for (const word of new Uint32Array(bytes.buffer)) {
                hash = Math.imul(hash ^ word, 16777619) >>> 0;
              }
              hashes[part] = hash;
            }
            return hashes;""", canvas, parts)

    def whole_page(self):
        size = self.cdp("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.cdp("Page.captureScreenshot", captureBeyondViewport=True, clip={
            "x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1})
        return base64.b64decode(shot["data"])


def pixels(png):
    """Rows of (r, g, b) of a PNG with 8 bits per channel, as browsers write them."""
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        chunk = png[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", chunk[:10])
        elif kind == b"IDAT":
            data += chunk
        at += 12 + size
    step = {2: 3, 6: 4}[color]
    raw = zlib.decompress(data)
    before = bytearray(width * step)
    rows = []
    for y in range(height):
        start = y * (width * step + 1)
        method = raw[start]
        row = bytearray(raw[start + 1:start + 1 + width * step])
        for i in range(len(row) if method else 0):
            left = row[i - step] if i >= step else 0
            up = before[i]
            corner = before[i - step] if i >= step else 0
            if method == 1:
                guess = left
            elif method == 2:
                guess = up
            elif method == 3:
                guess = (left + up) // 2
            else:
                p = left + up - corner
                far = (abs(p - left), abs(p - up), abs(p - corner))
                guess = (left, up, corner)[far.index(min(far))]
            row[i] = (row[i] + guess) & 255
        rows.append([tuple(row[i:i + 3]) for i in range(0, len(row), step)])
        before = row
    return rows
