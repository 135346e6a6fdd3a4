#!/usr/bin/python3
"""The view of report.html in Chromium, from a file and without a network.

    browser_test.py PROGRAM SOURCE_DIR [UNITTEST ARGUMENTS...]

Exit code 77, which ctest shows as skipped, where Chromium, its driver or Selenium is not installed; `./run test-browser`
installs them. HOTBLADE_BROWSER_ROOF=1 plans the roof too, HOTBLADE_BROWSER_SHOTS=DIR keeps pictures of what was seen.
The interpreter is Debian's, which has Debian's Selenium.
"""
import base64
import gzip
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    webdriver = None

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SAMPLES = ["barrel_vault", "branch", "bump", "corner", "hypar", "petal", "ragged", "s_wall", "saddle", "vase", "wave_wall",
           "window"]
SCRIPT_BYTES, SCENE_BYTES, PAGE_BYTES, ROOF_BYTES, TRIANGLES = 40_000, 1_000_000, 2_200_000, 4_000_000, 200_000


def browser(webgl=True, width=1000, height=900):
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    gl = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] if webgl else ["--disable-3d-apis"]
    for argument in ["--headless=new", "--no-sandbox", f"--window-size={width},{height}", "--hide-scrollbars",
                     "--force-device-scale-factor=1", "--disable-background-networking",
                     "--host-resolver-rules=MAP * ~NOTFOUND", *gl]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


def decoded_png(data):
    """Rows of (r, g, b) bytes of an 8-bit PNG without interlacing."""
    at, packed, width, channels = 8, b"", 0, 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, _, depth, color, *_ = struct.unpack(">IIBBBBB", body)
            channels = {2: 3, 6: 4}[color]
            assert depth == 8
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    raw, stride, rows, last = zlib.decompress(packed), width * channels, [], bytes(width * channels)
    for start in range(0, len(raw), stride + 1):
        how, line = raw[start], bytearray(raw[start + 1:start + 1 + stride])
        for i in range(stride):
            left, up = line[i - channels] if i >= channels else 0, last[i]
            corner = last[i - channels] if i >= channels else 0
            if how == 1:
                add = left
            elif how == 2:
                add = up
            elif how == 3:
                add = (left + up) // 2
            elif how == 4:
                p = left + up - corner
                add = min((left, up, corner), key=lambda x: abs(p - x))
            else:
                add = 0
            line[i] = (line[i] + add) & 255
        rows.append(line)
        last = line
    return lambda x, y: tuple(rows[y][channels * x:channels * x + 3])


def scene_of(page):
    """The scene as pipeline/report/scene_packer.hpp describes it, read by other code than the page's."""
    text = re.search(r'id="view-scene">([^<]*)<', page).group(1)
    data = gzip.decompress(base64.b64decode(text))
    assert data[:4] == b"HBV1"
    size = struct.unpack("<I", data[4:8])[0]
    scene, at = json.loads(data[8:8 + size]), 8 + size
    for array in scene["arrays"]:
        count, width = array["count"], array["bytes"]
        planes = data[at:at + count * width]
        at += count * width
        numbers, last, step, mask = [], 0, 0, (1 << 8 * width) - 1
        for i in range(count):
            n = sum(planes[p * count + i] << 8 * p for p in range(width))
            if array["follows"]:
                change = (n >> 1) ^ -(n & 1)
                step = step + change if array["follows"] == 2 else change
                n = last = (last + step) & mask
            numbers.append(n)
        scene[array["name"]] = numbers
    assert at == len(data)
    return scene


class View(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.work.name)
        cls.pages = {}
        cls.live = browser()
        cls.addClassCleanup(cls.live.quit)
        cls.addClassCleanup(cls.work.cleanup)

    @classmethod
    def page(cls, sample, *options):
        """The report of a sample, planned once."""
        key = (sample, *options)
        if key not in cls.pages:
            out = cls.directory / f"{sample}{len(cls.pages)}"
            subprocess.run([PROGRAM, "-q", "plan", SOURCE / f"samples/{sample}.obj", "--config",
                            SOURCE / f"samples/{sample}.toml", "-o", out, *options], capture_output=True, check=False)
            cls.pages[key] = out / "report.html"
        return cls.pages[key]

    def opened(self, page, driver=None):
        """Opens a page and waits until its view is drawn."""
        driver = driver or self.live
        driver.get(page.as_uri())
        for _ in range(200):
            if self.value("ready_ms", driver) or self.value("state", driver) == "still" and self.text(driver):
                break
            time.sleep(0.05)
        driver.execute_script("document.getElementById('view').scrollIntoView()")
        self.settle(driver)
        return driver

    def value(self, name, driver=None):
        return (driver or self.live).execute_script(f"return document.getElementById('view').dataset.{name}")

    def text(self, driver=None):
        return (driver or self.live).execute_script("return document.getElementById('view-text').textContent")

    @staticmethod
    def settle(driver):
        driver.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done))")

    def stage(self):
        return self.live.find_element(By.CSS_SELECTOR, "[data-part=stage]")

    def picture(self, name=""):
        self.settle(self.live)
        shot = self.stage().screenshot_as_png
        if name and "HOTBLADE_BROWSER_SHOTS" in os.environ:
            (pathlib.Path(os.environ["HOTBLADE_BROWSER_SHOTS"]) / f"{name}.png").write_bytes(shot)
        return shot

    def press(self, keys):
        self.live.execute_script("document.querySelector('[data-part=stage]').focus({preventScroll: true})")
        ActionChains(self.live).send_keys(keys).perform()
        self.settle(self.live)

    def test_says_what_is_shown(self):
        self.opened(self.page("bump"))
        self.assertEqual(self.value("state"), "webgl2")
        self.assertEqual(self.value("color"), "deviation")
        self.assertGreater(int(self.value("triangles")), 50_000)
        self.assertLessEqual(int(self.value("triangles")), TRIANGLES)
        for words in ["cut coloured by deviation", "4 strips", "Ringed: largest deviation"]:
            self.assertIn(words, self.text())
        self.assertEqual([e for e in self.live.get_log("browser") if e["level"] == "SEVERE"], [])

    def test_without_webgl_the_picture_stands_in(self):
        with_none = browser(webgl=False)
        self.addCleanup(with_none.quit)
        self.opened(self.page("bump"), with_none)
        self.assertEqual(self.value("state", with_none), "still")
        self.assertIn("WebGL 2", self.text(with_none))
        self.assertTrue(with_none.find_element(By.CSS_SELECTOR, ".still img").is_displayed())
        self.assertFalse(with_none.find_element(By.CSS_SELECTOR, "[data-part=stage]").is_displayed())

    def test_a_lost_context_shows_the_picture(self):
        self.opened(self.page("bump"))
        self.live.execute_script("document.querySelector('[data-part=canvas]').getContext('webgl2')"
                                 ".getExtension('WEBGL_lose_context').loseContext()")
        time.sleep(0.3)
        self.assertEqual(self.value("state"), "still")
        self.assertTrue(self.live.find_element(By.CSS_SELECTOR, ".still img").is_displayed())

    def test_a_broken_scene_shows_the_picture_and_a_line(self):
        page = self.page("bump")
        broken = self.directory / "broken.html"
        broken.write_text(re.sub(r'(id="view-scene">)H4', r"\1AA", page.read_text()))
        self.opened(broken)
        self.assertEqual(self.value("state"), "still")
        self.assertIn("The picture stands in for the view", self.text())

    def test_every_key_draws_another_picture(self):
        self.opened(self.page("bump"))
        last = self.picture("start")
        for key in [Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "t", "f", "s", "i", "2", "3", "4", "5", "1", "d", "c", "d", "c", "r", "b",
                    "g", "n", "x", "X", "0", ",", Keys.HOME, Keys.END, Keys.PAGE_DOWN, Keys.PAGE_DOWN, Keys.ESCAPE]:
            self.press(key)
            now = self.picture("key " + repr(key))
            self.assertNotEqual(now, last, f"key {key!r}")
            last = now

    def test_it_is_drawn_on_change_only(self):
        self.opened(self.page("bump"))
        time.sleep(0.3)
        frames = self.value("frames")
        time.sleep(0.5)
        self.assertEqual(self.value("frames"), frames)

    def test_mouse_and_touch_turn_move_and_zoom(self):
        self.opened(self.page("bump"))
        stage = self.stage()
        first = self.picture()
        ActionChains(self.live).move_to_element_with_offset(stage, 50, 0).click_and_hold().move_by_offset(90, 30).release().perform()
        turned = self.picture("turned")
        self.assertNotEqual(turned, first)
        self.assertEqual(self.value("strip") or "", "", "a drag picks nothing")
        ActionChains(self.live).key_down(Keys.SHIFT).move_to_element(stage).click_and_hold().move_by_offset(60, 0).release().key_up(
            Keys.SHIFT).perform()
        moved = self.picture("moved")
        self.assertNotEqual(moved, turned)
        self.live.execute_script(
            "document.querySelector('[data-part=canvas]').dispatchEvent(new WheelEvent('wheel', {deltaY: -200, bubbles: true, "
            "cancelable: true}))")
        zoomed = self.picture("zoomed")
        self.assertNotEqual(zoomed, moved)
        box = stage.rect
        origin = self.live.execute_script("const r = arguments[0].getBoundingClientRect(); return [r.left, r.top]", stage)
        x, y = origin[0] + box["width"] / 2, origin[1] + box["height"] / 2
        for kind, apart in [("touchStart", 40), ("touchMove", 90), ("touchEnd", 0)]:
            points = [] if kind == "touchEnd" else [{"x": x - apart, "y": y, "id": 1}, {"x": x + apart, "y": y, "id": 2}]
            self.live.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        self.assertNotEqual(self.picture("pinched"), zoomed)

    def test_a_click_shows_the_strips_card_and_row_and_back(self):
        self.opened(self.page("bump"))
        self.press("n")  # a name would be clicked instead
        ActionChains(self.live).move_to_element_with_offset(self.stage(), 40, 10).click().perform()
        strip = self.value("strip")
        self.assertRegex(strip, "^S00[1-4]$")
        card = self.live.find_element(By.CSS_SELECTOR, "[data-part=card]").text
        self.assertIn(strip, card)
        self.assertIn("stability margin", card)
        self.assertIn("a shorter one", card)  # why this blade
        links = self.live.find_elements(By.CSS_SELECTOR, "[data-part=card] a")
        self.assertEqual([link.get_attribute("href").rpartition("#")[2] for link in links],
                         [f"{place}-{strip}" for place in ("strip", "sheet", "why")])
        chosen = self.live.find_elements(By.CSS_SELECTOR, "tr.chosen")
        self.assertEqual({row.get_attribute("data-strip") for row in chosen}, {strip})
        before = self.picture("chosen")
        self.live.find_element(By.CSS_SELECTOR, "#strip-S004 button").click()
        self.assertEqual(self.value("strip"), "S004")
        if strip != "S004":
            self.assertNotEqual(self.picture("row"), before)

    def test_nothing_is_asked_of_a_network(self):
        self.live.get_log("performance")
        self.opened(self.page("bump"))
        self.press("3")
        asked = []
        for entry in self.live.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"].split(",")[0])
        pages = [url for url in asked if not url.startswith("data:")]
        self.assertEqual(set(pages), {self.page("bump").as_uri()})

    def test_the_print_holds_the_picture(self):
        self.opened(self.page("bump"))
        pdf = base64.b64decode(self.live.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})["data"])
        self.assertIn(b"/Width 1280", pdf)

    def test_it_fits_a_phone_a_tablet_and_a_desk_with_and_without_webgl(self):
        pages = {"report": self.page("bump"), "sheets": self.page("bump").with_name("sheets.html")}
        for webgl in (True, False):
            driver = browser(webgl)
            try:
                for width in (390, 820, 1280):
                    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                        "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})
                    for name, page in pages.items():
                        with self.subTest(width=width, webgl=webgl, page=name):
                            driver.get(page.as_uri())
                            if name == "report":
                                self.opened(page, driver)
                                self.assertEqual(self.value("state", driver), "webgl2" if webgl else "still")
                            wide = driver.execute_script("return document.documentElement.scrollWidth")
                            self.assertLessEqual(wide, width)
                            if os.environ.get("HOTBLADE_BROWSER_SHOTS"):
                                shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
                                place = pathlib.Path(os.environ["HOTBLADE_BROWSER_SHOTS"])
                                (place / f"{name}{width}{'' if webgl else 'still'}.png").write_bytes(
                                    base64.b64decode(shot["data"]))
            finally:
                driver.quit()

    def test_german_tables_fit_a_desk_and_the_rings_words_a_phone(self):
        page = self.page("barrel_vault", "--set", "job.language=de")
        for width in (1280, 390):
            self.live.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})
            self.opened(page)
            if width == 1280:
                hidden = self.live.execute_script(
                    "return [...document.querySelectorAll('.scroll')].map((e) => e.scrollWidth - e.clientWidth)")
                self.assertGreaterEqual(len(hidden), 3)
                self.assertEqual(max(hidden), 0, "a table's last column is out of sight")
            else:
                left, words, right = self.live.execute_script(
                    "const s = document.querySelector('[data-part=stage]').getBoundingClientRect(),"
                    " w = document.querySelector('.ring span').getBoundingClientRect(); return [s.left, [w.left, w.right], s.right]")
                self.assertLessEqual(left, words[0])
                self.assertLessEqual(words[1], right)
                self.assertGreater(words[1] - words[0], 50)
        self.live.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def test_every_sheet_is_one_page_of_a4(self):
        for sample in ("wave_wall", "vase"):
            with self.subTest(sample):
                sheets = self.page(sample).with_name("sheets.html")
                self.live.get(sheets.as_uri())
                pdf = base64.b64decode(self.live.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])
                sections = sheets.read_text().count("<section")
                self.assertGreater(sections, 4)
                self.assertEqual(len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf)), sections)
                for left, low, right, high in re.findall(rb"/MediaBox\s*\[(\S+) (\S+) (\S+) (\S+)\]", pdf):
                    self.assertAlmostEqual(float(right) - float(left), 595, delta=1)
                    self.assertAlmostEqual(float(high) - float(low), 842, delta=1)

    def test_without_its_script_the_page_reads_whole(self):
        bare = self.directory / "bare.html"
        bare.write_text(re.sub(r"<script.*?</script>", "", self.page("bump").read_text(), flags=re.S))
        self.live.get(bare.as_uri())
        self.assertTrue(self.live.find_element(By.CSS_SELECTOR, ".still img").is_displayed())
        body = self.live.find_element(By.TAG_NAME, "body").text
        for words in ["Strips", "Deviation", "Error budget", "S004", "Settings"]:
            self.assertIn(words, body)
        self.assertNotIn("other side", body)

    def test_a_refused_job_shows_its_place(self):
        self.opened(self.page("bump", "--set", "design.over_budget=refuse", "--set", "blade.min_margin=1000"))
        self.assertEqual(self.value("state"), "webgl2")
        self.assertIn("Ringed: what stands in the way", self.text())
        self.picture("refused")

    def test_the_colour_of_ten_places_is_their_deviation(self):
        page = self.page("bump")
        scene = scene_of(page.read_text())
        self.opened(page)
        self.press("t")
        for key in "rbgnd":
            self.press(key)
        self.live.execute_script("document.querySelectorAll('.ring').forEach((r) => r.remove())")
        pixel = decoded_png(self.picture("ten"))
        width, height = self.live.execute_script(
            "const c = document.querySelector('[data-part=canvas]'); return [c.clientWidth, c.clientHeight]")
        (low, size) = scene["box"]
        scale = 1.08 * max(size[0] / width, size[1] / height)
        border = 1  # of the stage, pixels
        count, checked = len(scene["cut_x"]), 0
        for vertex in range(count // 40, count, count // 23):
            at = [low[i] + scene["cut_" + "xyz"[i]][vertex] / 65535 * size[i] for i in range(3)]
            right, up = at[0] - low[0] - size[0] / 2, at[1] - low[1] - size[1] / 2
            f = [scene["cut_normal_" + c][vertex] / 127.5 - 1 for c in "uv"]
            normal = [f[0], f[1], 1 - abs(f[0]) - abs(f[1])]
            nz = abs(normal[2]) / sum(n * n for n in normal) ** 0.5
            seen = pixel(round(border + width / 2 + right / scale - 0.5), round(border + height / 2 - up / scale - 0.5))
            code = scene["deviation"][vertex]
            # A pixel is some points of the cut wide, so its colour is one of those about the place, as stored.
            near = [[scene["deviation_colors"][3 * c + k] * (0.66 + 0.38 * nz) for k in range(3)]
                    for c in range(max(0, code - 3), min(255, code + 3) + 1)]
            miss = min(max(abs(a - b) for a, b in zip(colour, seen)) for colour in near)
            if min(abs(right) - size[0] / 2, abs(up) - size[1] / 2) > -4 * scale:
                continue  # on the border's edge
            self.assertLess(miss, 8, f"vertex {vertex} at {at}: seen {seen}, stored {code}")
            checked += 1
        self.assertGreaterEqual(checked, 10)

    def test_every_sample_is_within_budget(self):
        script = (SOURCE / "pipeline/report/viewer.js").stat().st_size
        self.assertLess(script, SCRIPT_BYTES)
        names = SAMPLES + (["roof"] if os.environ.get("HOTBLADE_BROWSER_ROOF") else [])
        for name in names:
            with self.subTest(name):
                page = self.page(name).read_text()
                scene = re.search(r'id="view-scene">([^<]*)<', page).group(1)
                print(f"{name}: page {len(page)}, scene {len(scene)} bytes", file=sys.stderr)
                self.assertLess(len(scene), SCENE_BYTES)
                self.assertLess(len(page), ROOF_BYTES if name == "roof" else PAGE_BYTES)
                # The best of three: others may use the cores.
                ready = []
                for _ in range(3):
                    self.opened(self.page(name))
                    self.assertEqual(self.value("state"), "webgl2")
                    ready.append(int(self.value("ready_ms")))
                self.assertLessEqual(int(self.value("triangles")), TRIANGLES)
                print(f"  ready {min(ready)} ms, {self.value('triangles')} triangles", file=sys.stderr)
                self.assertLess(min(ready), 3000 if name == "roof" else 1500)

    def test_light_is_smaller_and_none_is_none(self):
        light = scene_of(self.page("bump", "--viewer", "light").read_text())
        self.assertLessEqual((len(light["cut_corners"]) + len(light["design_corners"])) // 3, 40_000)
        self.opened(self.page("bump", "--viewer", "light"))
        self.assertIn("One row of the cut in", self.text())
        self.assertNotIn("view-scene", self.page("bump", "--viewer", "none").read_text())
        alone = self.page("bump", "--viewer", "full", "--no-pictures")
        self.opened(alone)
        self.assertEqual(self.value("state"), "webgl2")


if __name__ == "__main__":
    if webdriver is None or not CHROMIUM or not DRIVER:
        print("skipped: chromium, chromium-driver or python3-selenium is not installed (./run test-browser installs them)")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
