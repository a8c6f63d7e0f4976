"""`cairn run --page`: it is shown while it runs, nobody commands it from there, and its end is told."""
import http.client
import os
import signal
import subprocess
import sys
import time
import urllib.parse

from browser import Browser
from page_service import cairn, link_in, until

STOPPED = 130  # its exit code after Ctrl-C


def told_late():
    """A page that was sent as the run ended, and begins to listen only then, hears of it too."""
    open('late.log', 'w').close()
    with open('late.log', 'ab') as log:
        run = subprocess.Popen(['cairn', 'run', 'landmark_map', 'log.h5', '--out', 'late', '--workers', '1', '--page'],
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log)
    try:
        link = urllib.parse.urlsplit(link_in('late.log'))
        browser = http.client.HTTPConnection(link.hostname, link.port, timeout=60)
        browser.request('GET', link.path + '?' + link.query)
        answer = browser.getresponse()
        answer.read()
        mine = {'Cookie': answer.getheader('Set-Cookie').split(';')[0]}
        # Once the run has its report it ends its page, and waits for that: of which this is to hear though it is late.
        until(lambda: (browser.request('GET', '/jobs/run', headers=mine), browser.getresponse().read()) and
              os.path.exists('late/report.html'), 'late.log')
        time.sleep(1)
        assert run.poll() is None, 'it did not wait for who looks on'
        browser.request('GET', '/events?for=/jobs/run', headers=mine)
        said = browser.getresponse().read().decode()
        assert 'event: over' in said and 'The run is over' in said, said
        assert run.wait(120) == 0, open('late.log').read()
    finally:
        run.kill()
        run.wait()
    print('a page that listens late was told')


def main():
    browser = Browser()
    # Of minutes, so that it is not over before it is looked at, however slow the browser is.
    cairn('simulate', 'loop', '--difficulty', 'base', '--robots', '4', '--seed', '1', 'long.h5')
    open('run.log', 'w').close()
    with open('run.log', 'ab') as log, open('summary', 'wb') as out:
        run = subprocess.Popen(['cairn', 'run', 'landmark_map', 'long.h5', '--set', 'cell_m=0.15', '--out', 'shown',
                                '--workers', '1', '--page'],
                               stdin=subprocess.DEVNULL, stdout=out, stderr=log)
    try:
        link = link_in('run.log')
        browser.open(link)
        browser.until(lambda: browser.has('#parts a[href="/jobs/run"]'), 'the run')
        for action in ('cancel', 'pause', 'delete'):  # nobody ends it who guesses where that would be
            said = browser.run('const x = new XMLHttpRequest(); x.open("POST", "/jobs/run/" + arguments[0], false); '
                               'x.setRequestHeader("X-Cairn", "page"); x.send(); return x.responseText;', action)
            assert 'commands none' in said, said
        browser.find('#parts a[href="/jobs/run"]').click()
        browser.until(lambda: browser.has('#stages li'), 'its stages')
        assert not browser.has('[data-action]'), 'a run has buttons that end it'
        browser.until(lambda: browser.has('#sofar iframe'), 'its map')
        run.send_signal(signal.SIGINT)
        browser.until(lambda: 'The run was stopped' in browser.text('#told'), 'its end')
        assert os.path.abspath('shown') in browser.text('#told'), browser.text('#told')
        errors = browser.errors()
        assert not errors, errors
        browser.close()
        assert run.wait(120) == STOPPED, open('run.log').read()
    finally:
        run.kill()
        run.wait()
    told_late()
    assert 'open ' not in open('summary').read(), 'the link is among the facts'
    print('a run was shown to its end')


if __name__ == '__main__':
    sys.exit(main())
