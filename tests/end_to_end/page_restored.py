"""The page of a coordinator whose store is restored from a backup: two jobs of one number."""
import http.client
import shutil
import signal
import subprocess
import urllib.parse

from page_service import Service, cairn, submit, until


class Page:
    def __init__(self, link):
        parts = urllib.parse.urlsplit(link)
        self.server = http.client.HTTPConnection(parts.hostname, parts.port, timeout=120)
        self.server.request('GET', parts.path + '?' + parts.query)
        answer = self.server.getresponse()
        answer.read()
        self.headers = {'Cookie': answer.getheader('Set-Cookie').split(';')[0]}

    def get(self, path):
        self.server.request('GET', path, headers=self.headers)
        answer = self.server.getresponse()
        body = answer.read()
        assert answer.status == 200, f'{path}: {answer.status}'
        return body


def tour(log):
    return submit('--name', 'tour', '--set', 'iterations=1', '--set', 'waves=0', 'landmark_map', log)


def restored(service, coordinator):
    service.stop(coordinator)
    shutil.rmtree('home/store')
    cairn('restore', 'copy')
    return service.coordinator()


def of_job(service, page, log, name):
    """Runs a job of the log, and leaves what the page has of it in shown_NAME.h5: its id, rounds and picture."""
    job = tour(log)
    worker = service.worker()
    cairn('watch', job)
    service.stop(worker)
    page.get(f'/jobs/{job}')
    with open(f'shown_{name}.h5', 'wb') as file:
        file.write(page.get(f'/jobs/{job}/files/landmark_map.h5'))
    return job, page.get(f'/jobs/{job}/rounds.csv'), page.get(f'/jobs/{job}/picture')


def main():
    with Service() as service:
        coordinator = service.coordinator()
        page = Page(service.page())
        cairn('backup', 'copy')
        one = of_job(service, page, 'one.h5', 'one')
        coordinator = restored(service, coordinator)
        other = of_job(service, page, 'other.h5', 'other')
        assert one[0] == other[0], 'the number was to be given again'
        cairn('results', other[0], '--out', 'true')
        cairn('diff', 'shown_other.h5', 'true/landmark_map.h5')
        assert subprocess.run(['cairn', 'diff', 'shown_one.h5', 'shown_other.h5'], capture_output=True).returncode == 1
        assert one[1] != other[1], 'the rounds are those of the job before'
        assert one[2] != other[2], 'the picture is that of the job before'
        print('the page showed each of the two jobs of one number')

        coordinator = restored(service, coordinator)
        job = tour('one.h5')
        with open('watch.log', 'wb') as log:
            watch = subprocess.Popen(['cairn', 'watch', job], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        try:
            until(lambda: 'no worker' in open('watch.log').read(), 'what it waits for')
            watch.send_signal(signal.SIGSTOP)  # else it may ask while there is none
            restored(service, coordinator)
            assert tour('other.h5') == job
            watch.send_signal(signal.SIGCONT)
            assert watch.wait(120) == 2 and 'is another than before' in open('watch.log').read(), open('watch.log').read()
        finally:
            watch.kill()
            watch.wait()
    print('a job was not watched on as another')


main()
