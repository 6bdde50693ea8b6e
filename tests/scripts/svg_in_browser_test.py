#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""A browser shows the timeline as it was meant: each element is there, has a size, its colour and its place.

Usage: svg_in_browser_test.py MAUVECTL
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import sample_trace  # noqa: E402

# What the browser made of the picture, as a line of JSON in the page.
LOOK = """
<pre id="seen"></pre>
<script>
const boxes = name => [...document.querySelectorAll('svg ' + name)].map(one => {
  const box = one.getBoundingClientRect(), style = getComputedStyle(one);
  return {x: box.x, y: box.y, width: box.width, height: box.height, fill: style.fill, stroke: style.stroke,
          text: one.textContent};
});
const seen = {};
for (const name of ['rect.state', 'rect.preempted', 'path.release', 'path.commit', 'path.applied', 'rect.prepare',
                    'rect.disturbed', 'circle.user', 'text.name', 'text.axis', 'text.title', 'text.tick'])
  seen[name] = boxes(name);
document.getElementById('seen').textContent = JSON.stringify(seen);
</script>
"""
BROWSER = shutil.which("chromium") or shutil.which("google-chrome")


def shown_by_browser(svg, folder):
    page = folder / "page.html"
    page.write_text(f"<!DOCTYPE html><body style='margin:0'>{svg}{LOOK}</body>", encoding="utf-8")
    shown = subprocess.run(
        [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
         f"--user-data-dir={folder / 'profile'}", "--dump-dom", page.as_uri()],
        capture_output=True, text=True, check=True, timeout=500)
    text = re.search(r'<pre id="seen">(.*?)</pre>', shown.stdout, re.DOTALL).group(1)
    return json.loads(text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))


class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        cls.addClassCleanup(scratch.cleanup)
        folder = pathlib.Path(scratch.name)
        sample_trace.write(folder / "drive.mtrace")
        drawn = sample_trace.mauvectl("timeline", folder / "drive.mtrace", "-o", folder / "drive.svg")
        assert drawn.returncode == 0, drawn.stderr
        cls.seen = shown_by_browser((folder / "drive.svg").read_text(encoding="utf-8"), folder)

    def test_tasks_are_rows_by_priority(self):
        names = {one["text"]: one["y"] for one in self.seen["text.name"]}
        self.assertEqual(set(names), {"A", "B", "[control]"})
        self.assertLess(names["B"], names["A"])
        self.assertLess(names["A"], names["[control]"])

    def test_each_release_is_an_arrow(self):
        arrows = [one for one in self.seen["path.release"] if one["height"] > 20]
        self.assertGreaterEqual(len(arrows), 15)
        self.assertTrue(all(one["stroke"] == "rgb(31, 35, 40)" for one in arrows))

    def test_execution_is_boxes_in_a_colour_and_preemption_is_hatched(self):
        boxes = [one for one in self.seen["rect.state"] if one["height"] > 20]
        self.assertTrue(all(one["width"] > 5 for one in boxes))
        self.assertEqual({one["fill"] for one in boxes}, {"rgb(165, 214, 255)"})
        hatched = [one for one in self.seen["rect.preempted"] if one["height"] > 20]
        self.assertEqual(len(hatched), 3, "the first three jobs of A were preempted once")
        self.assertTrue(all("url(" in one["fill"] for one in hatched))

    def test_the_swap_is_a_line_through_all_rows_at_its_instant(self):
        line = max(self.seen["path.commit"], key=lambda one: one["height"])
        self.assertGreater(line["height"], 130)
        at_60_ms = next(one for one in self.seen["text.tick"] if one["text"] == "60")
        self.assertAlmostEqual(line["x"], at_60_ms["x"] + at_60_ms["width"] / 2, delta=1.5)
        self.assertIn("core.swap A", line["text"])
        self.assertTrue(self.seen["path.applied"] and self.seen["rect.prepare"])

    def test_events_disturbance_axis_and_title_are_there(self):
        for name in ("circle.user", "rect.disturbed", "text.axis", "text.title"):
            self.assertTrue(self.seen[name] and self.seen[name][0]["width"] > 0, name)
        self.assertIn("time since T0", self.seen["text.axis"][0]["text"])


if __name__ == "__main__":
    if BROWSER is None:
        sample_trace.skip("there is no Chromium; scripts/setup installs it")
    unittest.main()
