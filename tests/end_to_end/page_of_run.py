"""`cairn run --page`: it is shown while it runs, nobody commands it from there, and its end is told."""
import os
import signal
import subprocess
import sys

from browser import Browser
from page_service import link_in, until


def main():
    browser = Browser()
    open('run.log', 'w').close()
    with open('run.log', 'ab') as log, open('summary', 'wb') as out:
        run = subprocess.Popen(['cairn', 'run', 'landmark_map', 'log.h5', '--out', 'shown', '--workers', '1', '--page'],
                               stdin=subprocess.DEVNULL, stdout=out, stderr=log)
    try:
        link = link_in('run.log')
        # It must not be over before it is looked at, however slow the browser is.
        find = ['pgrep', '-P', str(run.pid), '-x', 'cairn-worker']
        until(lambda: subprocess.run(find, stdout=subprocess.DEVNULL).returncode == 0, 'run.log')
        workers = [int(pid) for pid in subprocess.check_output(find).split()]
        for pid in workers:
            os.kill(pid, signal.SIGSTOP)
        browser.open(link)
        browser.until(lambda: browser.has('#parts a[href="/jobs/run"]'), 'the run')
        for action in ('cancel', 'pause', 'delete'):  # nobody ends it who guesses where that would be
            said = browser.run('const x = new XMLHttpRequest(); x.open("POST", "/jobs/run/" + arguments[0], false); '
                               'x.setRequestHeader("X-Cairn", "page"); x.send(); return x.responseText;', action)
            assert 'commands none' in said, said
        for pid in workers:
            os.kill(pid, signal.SIGCONT)
        browser.find('#parts a[href="/jobs/run"]').click()
        browser.until(lambda: browser.has('#stages li'), 'its stages')
        assert not browser.has('[data-action]'), 'a run has buttons that end it'
        browser.until(lambda: 'The run is over' in browser.text('#told'), 'its end')
        assert os.path.abspath('shown') in browser.text('#told'), browser.text('#told')
        errors = browser.errors()
        assert not errors, errors
        browser.close()
        assert run.wait(120) == 0, open('run.log').read()
    finally:
        run.kill()
        run.wait()
    assert 'open ' not in open('summary').read(), 'the link is among the facts'
    print('a run was shown to its end')


if __name__ == '__main__':
    sys.exit(main())
