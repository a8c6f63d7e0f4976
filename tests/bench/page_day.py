"""Memory of both sides of a page that is left open for a day of events, which go by as fast as Chromium takes them.

    deploy/build.sh release page_day
    PATH=$PWD/build/release/tests/bench:$PATH python3 tests/bench/page_day.py [HOURS [SECONDS_BETWEEN_EVENTS]]
"""
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'end_to_end'))
from browser import Browser  # noqa: E402


def heap(browser):
    """Bytes of scripts and nodes of documents, after all that is not needed is gone."""
    browser.command('HeapProfiler.collectGarbage')
    metrics = {m['name']: m['value'] for m in browser.command('Performance.getMetrics')['metrics']}
    return metrics['JSHeapUsedSize'], metrics['Nodes'], metrics['JSEventListeners']


def main():
    hours, step = (sys.argv[1:] + ['24', '1'][len(sys.argv) - 1:])[:2]
    day = subprocess.Popen(['page_day', hours, step], stdout=subprocess.PIPE, text=True)
    link = re.match(r'open (\S+)', day.stdout.readline())[1]
    browser = Browser()
    browser.command('Performance.enable')
    browser.open(link)
    browser.until(lambda: browser.has('#parts'), 'the pages')
    browser.run('location.href = "/jobs/1-day"')
    browser.until(lambda: browser.text('#live') == 'live', 'a live page')
    browser.run('window.heard = 0; events.addEventListener("parts", () => ++heard);')
    def resident_mb():
        with open(f'/proc/{day.pid}/status') as status:
            return int(re.search(r'VmRSS:\s+(\d+) kB', status.read())[1]) / 1e3

    for line in day.stdout:
        if not re.match(r'\d+ \d+$', line):
            continue  # another link
        hour, bytes_used = map(int, line.split())
        if hour in (1, 2, 4, 8, 16, int(float(hours))):
            script, nodes, listeners = heap(browser)
            print(f'hour {hour:2}: page program {bytes_used / 1e6:.2f} MB in use, {resident_mb():.1f} MB resident; browser {script / 1e6:.2f} MB of script, '
                  f'{nodes:.0f} nodes, {listeners:.0f} listeners, {browser.run("return heard")} events heard', flush=True)
        if hour == int(float(hours)):
            break
    errors = browser.errors()
    assert not errors, errors
    browser.close()
    day.kill()
    day.wait()


if __name__ == '__main__':
    main()
