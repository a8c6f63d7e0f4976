"""Frames a second of a report's map viewer while one pans in it, in Chromium without a graphics card.

    deploy/build.sh release cairn cairn-worker large_map
    PATH=$PWD/build/release/bin:$PWD/build/release/tests/bench:$PATH python3 tests/bench/viewer_rate.py [MILLIONS [POSES]]

MILLIONS of cells: 5, POSES: 100000. At each scale a step of 60 pixels is asked for every frame, for 5 s.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'end_to_end'))
from browser import Browser  # noqa: E402

# Frames that the page drew, and the longest pause between two.
PAN = '''
const canvas = document.querySelector('.viewer canvas'), seconds = arguments[0];
const press = (key) => canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
return new Promise((done) => {
  const times = [];
  const step = (now) => {
    times.push(now);
    if (now - times[0] > 1000 * seconds) {
      const gaps = times.slice(1).map((t, i) => t - times[i]);
      return done([1000 * gaps.length / (times.at(-1) - times[0]), Math.max(...gaps)]);
    }
    press(Math.floor((now - times[0]) / 700) % 2 ? 'ArrowRight' : 'ArrowLeft');
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
});'''


def main():
    millions, poses = (sys.argv[1:] + ['5', '100000'][len(sys.argv) - 1:])[:2]
    with tempfile.TemporaryDirectory(prefix='cairn-viewer-') as folder:
        os.chdir(folder)
        subprocess.run(['large_map', millions, poses, 'map.h5'], check=True)
        begin = time.monotonic()
        subprocess.run(['cairn', 'report', 'map.h5', '--out', 'report.html'], check=True, stdout=subprocess.DEVNULL)
        size = os.path.getsize('report.html')
        print(f'{millions} million cells, {poses} poses: the report took {time.monotonic() - begin:.1f} s, {size / 1e6:.1f} MB')
        browser = Browser(width=1280, height=900)
        browser.open(pathlib.Path('report.html').resolve().as_uri())
        browser.until(lambda: browser.run('const c = document.querySelector(".viewer canvas"); return c && c.width > 300'), 'a map')
        points = browser.run('return [...document.querySelectorAll(".wide polyline[data-time]")].map((e) => '
                             'e.getAttribute("data-time").trim().split(/[\\s,]+/).length)')
        assert points, 'no path is in the picture'
        canvas = browser.run('const c = document.querySelector(".viewer canvas"); return [c.width, c.height]')
        print(f'canvas {canvas[0]} x {canvas[1]}, points of its paths: {points}')
        browser.run(PAN, 1)
        for name, keys in (('all of it', []), ('4 times closer', ['+'] * 6), ('20 times closer', ['+'] * 7), ('200 times closer', ['+'] * 10)):
            for key in keys:
                browser.run('document.querySelector(".viewer canvas").dispatchEvent(new KeyboardEvent("keydown", '
                            '{key: arguments[0], bubbles: true}))', key)
            rate, longest = browser.run(PAN, 5)
            print(f'{name:17} {rate:5.1f} frames a second, the longest took {longest:.0f} ms')
        browser.close()


if __name__ == '__main__':
    main()
