"""The programs that tests of the pages start, each of which ends with the test."""
import re
import subprocess
import time


class Service:
    def __init__(self):
        self.running = []

    def __enter__(self):
        return self

    def __exit__(self, *ignored):
        for process in self.running:
            process.kill()
            process.wait()

    def start(self, *words, log):
        with open(log, 'ab') as out:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=out, stderr=out)
        self.running.append(process)
        return process

    def stop(self, process, how='kill'):
        getattr(process, how)()
        process.wait()
        self.running.remove(process)

    def coordinator(self, *words, before=(), log='coordinator.log'):
        open(log, 'w').close()
        process = self.start('cairn', *before, 'coordinator', *words, log=log)
        until(lambda: 'listening on' in open(log).read(), log)
        return process

    def worker(self, *words):
        return self.start('cairn', 'worker', *words, log='worker.log')

    def page(self, *words, log='page.log'):
        open(log, 'w').close()
        self.start('cairn', 'page', *words, log=log)
        return link_in(log)


def until(condition, what, seconds=120):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f'never came: {what}')


def link_in(log):
    """The last link that `cairn page` printed there."""
    return until(lambda: re.findall(r'^open (http\S+)$', open(log).read(), re.M), 'a link')[-1]


def cairn(*words, code=0):
    done = subprocess.run(('cairn', *words), stdin=subprocess.DEVNULL, capture_output=True, text=True)
    assert done.returncode == code, f'{words}: {done.returncode}: {done.stdout}{done.stderr}'
    return done.stdout


def submit(*words):
    """The id of the job."""
    return re.search(r'^submitted (\S+?);', cairn('submit', *words), re.M)[1]
