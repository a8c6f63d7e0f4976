"""What the pages cost: first paint with many jobs, from a round's end to its pixel, processor time of many viewers.

    deploy/build.sh release cairn cairn-page cairn-worker many_jobs
    PATH=$PWD/build/release/bin:$PWD/build/release/tests/bench:$PATH python3 tests/bench/page_rates.py [JOBS] [VIEWERS]

In a folder of its own; needs chromium and chromedriver. JOBS: 10000, VIEWERS: 50.
"""
import datetime
import http.client
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'end_to_end'))
from browser import Browser  # noqa: E402
from page_service import Service, cairn, submit, until  # noqa: E402


def processor_s(pid):
    """Of the process, and of what it has started and waited for."""
    with open(f'/proc/{pid}/stat') as stat:
        fields = stat.read().rsplit(')', 1)[1].split()
    return sum(int(fields[i]) for i in (11, 12, 13, 14)) / os.sysconf('SC_CLK_TCK')


def first_paint(browser, origin, count=7):
    times = []
    for _ in range(count):
        browser.open(origin + '/')
        times.append(browser.until(lambda: browser.run(
            'const p = performance.getEntriesByName("first-contentful-paint")[0]; return p && p.startTime'), 'a paint'))
        rows = browser.run('return document.querySelectorAll("#jobs tbody tr").length')
        assert rows == 50, rows
    return sorted(times)


def view(port, cookie, path, stop, counts):
    """Reads a page's events as a browser does, until `stop`."""
    connection = http.client.HTTPConnection('127.0.0.1', port, timeout=120)
    connection.request('GET', path, headers={'Cookie': cookie})
    answer = connection.getresponse()
    assert answer.status == 200, answer.status
    while not stop.is_set():
        counts.append(len(answer.readline()))
    connection.close()


def viewers_cost(coordinator, page, port, cookie, path, viewers, seconds=10):
    stop, counts = threading.Event(), []
    threads = [threading.Thread(target=view, args=(port, cookie, path, stop, counts), daemon=True)
               for _ in range(viewers)]
    for thread in threads:
        thread.start()
    time.sleep(3)
    before, received = [processor_s(p) for p in (coordinator, page)], sum(counts)
    time.sleep(seconds)
    after = [processor_s(p) for p in (coordinator, page)]
    stop.set()
    cost = [100 * (b - a) / seconds for a, b in zip(before, after)]
    print(f'{viewers:3} viewers of {path}: coordinator {cost[0]:.1f}%, page {cost[1]:.1f}% of a core, '
          f'{(sum(counts) - received) / seconds / 1e3:.0f} kB/s')


class Runner:
    """A job of some minutes that runs, and the next one where that is over."""
    def __init__(self):
        self.seed, self.job = 4, None

    def running(self):
        if self.job is None or json.loads(cairn('status', self.job, '--json'))['state'] not in ('running', 'queued'):
            self.seed += 1
            self.job = submit('landmark_map', 'log.h5', '--seed', str(self.seed), '--set', 'cell_m=0.35')
            until(lambda: 'round 2:' in cairn('logs', self.job), 'rounds')
        return self.job


def round_to_pixel(browser, origin, runner, log, least=20):
    """How much later than in the coordinator's log the line of a round is in the page, in seconds, sorted."""
    late = []
    while len(late) < least:
        job = runner.running()
        browser.open(origin + '/jobs/' + job)
        browser.until(lambda: 'round 2:' in browser.text('.log'), 'rounds')
        browser.run('''window.seen = []; const known = new Set([...document.querySelectorAll(".log li")].map((e) => e.dataset.key));
          new MutationObserver(() => { for (const li of document.querySelectorAll(".log li")) {
            if (known.has(li.dataset.key)) continue;
            known.add(li.dataset.key);
            requestAnimationFrame(() => seen.push([Date.now() / 1000, li.querySelector("span").textContent])); } })
          .observe(document.getElementById("parts"), {childList: true, subtree: true});''')
        until(lambda: len(browser.run('return seen')) >= least or
              json.loads(cairn('status', job, '--json'))['state'] != 'running', 'rounds that end', 600)
        shown = browser.run('return seen')
        with open(log) as file:
            lines = [json.loads(line) for line in file if line.startswith('{')]
        written = {line['message'].split(': ', 1)[-1]: datetime.datetime.strptime(line['time'], '%Y-%m-%dT%H:%M:%S.%f%z')
                   for line in lines if line['message'].startswith(job) and ', round ' in line['message']}
        late += [at - written[text].timestamp() for at, text in shown if text in written]
    return sorted(late)


def main():
    jobs = int(sys.argv[1]) if len(sys.argv) > 1 else 10000
    viewers = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    print(f'load of this machine: {os.getloadavg()[0]:.0f}')
    folder = tempfile.TemporaryDirectory(prefix='cairn-page-rates-', ignore_cleanup_errors=True)
    os.chdir(folder.name)
    os.environ.update(HOME=folder.name, CAIRN_HOME=folder.name + '/home')
    os.environ.pop('CAIRN_COORDINATOR', None)
    cairn('simulate', 'loop', '--difficulty', 'base', '--robots', '4', '--seed', '1', 'log.h5')
    with Service() as service:
        coordinator = service.coordinator('--checkpoint-interval', '60', before=('--log-format', 'json'))
        begin = time.monotonic()
        if jobs:
            subprocess.run(['many_jobs', f'ipc://{folder.name}/home/coordinator.ipc', str(jobs)], check=True)
            print(f'{jobs} jobs were submitted in {time.monotonic() - begin:.0f} s')
        open('page.log', 'w').close()
        page = service.start('cairn', 'page', log='page.log')
        link = until(lambda: re.findall(r'^open (http\S+)$', open('page.log').read(), re.M), 'a link')[-1]
        browser = Browser()
        browser.open(link)
        browser.until(lambda: browser.has('#jobs'), 'jobs')
        origin = browser.run('return location.origin')
        if jobs:
            paints = first_paint(browser, origin)
            print('first contentful paint: median %.0f ms, of %s' % (paints[len(paints) // 2], [round(p) for p in paints]))
        port = int(origin.rsplit(':', 1)[1])
        cookie = [c for c in browser.ask('GET', '/cookie')][0]
        cookie = cookie['name'] + '=' + cookie['value']
        browser.open('about:blank')
        for count in (1, viewers):
            viewers_cost(coordinator.pid, page.pid, port, cookie, '/events?for=/', count)
        # A job of minutes that runs.
        if jobs:
            cairn('cancel', '--name', 'tour-*', '--state', 'queued')
        service.worker()
        runner = Runner()
        for count in (1, viewers):
            viewers_cost(coordinator.pid, page.pid, port, cookie, '/events?for=/jobs/' + runner.running(), count)
        late = round_to_pixel(browser, origin, runner, 'coordinator.log')
        print('from a round\'s end to its pixel: median %.2f s, longest %.2f s of %d' %
              (late[len(late) // 2], late[-1], len(late)))
        browser.close()
    folder.cleanup()


if __name__ == '__main__':
    main()
