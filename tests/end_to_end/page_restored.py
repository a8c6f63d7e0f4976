"""The page of a coordinator whose store is restored from a backup: two jobs of one number."""
import http.client
import shutil
import subprocess
import urllib.parse

from page_service import Service, cairn, submit


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


def of_job(service, page, log, name):
    """Runs a job of the log, and leaves what the page has of it in NAME.h5: its id, rounds and picture."""
    job = submit('--name', 'tour', '--set', 'iterations=1', '--set', 'waves=0', 'landmark_map', log)
    worker = service.worker()
    cairn('watch', job)
    service.stop(worker)
    page.get(f'/jobs/{job}')
    with open(f'{name}.h5', 'wb') as file:
        file.write(page.get(f'/jobs/{job}/files/landmark_map.h5'))
    return job, page.get(f'/jobs/{job}/rounds.csv'), page.get(f'/jobs/{job}/picture')


def main():
    with Service() as service:
        coordinator = service.coordinator()
        page = Page(service.page())
        cairn('backup', 'copy')
        one = of_job(service, page, 'one.h5', 'one')
        service.stop(coordinator)
        shutil.rmtree('home/store')
        cairn('restore', 'copy')
        service.coordinator()
        other = of_job(service, page, 'other.h5', 'other')
        assert one[0] == other[0], 'the number was to be given again'
        cairn('results', other[0], '--out', 'true')
        cairn('diff', 'other.h5', 'true/landmark_map.h5')
        assert subprocess.run(['cairn', 'diff', 'one.h5', 'other.h5'], capture_output=True).returncode == 1
        assert one[1] != other[1], 'the rounds are those of the job before'
        assert one[2] != other[2], 'the picture is that of the job before'
    print('the page showed each of the two jobs of one number')


main()
