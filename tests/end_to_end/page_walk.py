"""Walks through the pages of a live service, as page_test.sh says."""
import os
import re
import shutil
import socket
import subprocess
import sys
import time

from browser import Browser
from page_service import Service, cairn, link_in, submit, until

EVIL = "<script>document.title='evil'</script><img src=x onerror=\"document.title='evil'\">"
PICTURES = os.environ.get('CAIRN_PAGE_PICTURES')

# Text whose colour does not stand out from what is behind it (WCAG 2, AA), and what is wider than the window.
UNREADABLE = '''
const luminance = (c) => {
  const part = (v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  return 0.2126 * part(c[0]) + 0.7152 * part(c[1]) + 0.0722 * part(c[2]);
};
const parse = (text) => (text.match(/[0-9.]+/g) || []).map(Number);
const behind = (e) => {
  for (; e; e = e.parentElement) {
    const c = parse(getComputedStyle(e).backgroundColor);
    if (c.length === 3 || c[3] > 0.99) return c;
  }
  return [255, 255, 255];
};
const wrong = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
let seen = 0;
while (walker.nextNode()) {
  const e = walker.currentNode.parentElement;
  if (!walker.currentNode.nodeValue.trim() || !e.checkVisibility() || e.closest('[aria-disabled], title, option')) continue;
  ++seen;
  const style = getComputedStyle(e);
  const a = luminance(parse(e instanceof SVGElement && e.closest('.tick') ? style.fill : style.color)), b = luminance(behind(e));
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (ratio < 4.5) wrong.push(ratio.toFixed(2) + ' ' + walker.currentNode.nodeValue.trim().slice(0, 40));
}
if (seen < 10) wrong.push('it looks at nothing');
const wide = document.documentElement.scrollWidth - innerWidth;
if (wide > 0) wrong.push(wide + ' px wider than the window');
return wrong;
'''


class Walk:
    def __init__(self, service, browser=None):
        self.service, self.browser, self.origin = service, browser or Browser(), ''

    def sign_in(self, link):
        self.browser.open(link)
        self.browser.until(lambda: self.browser.has('#parts'), 'the pages')
        self.origin = self.browser.run('return location.origin')

    def go(self, path):
        self.browser.open(self.origin + path)
        self.browser.until(lambda: self.browser.text('#live') == 'live', 'a live page')

    def until_says(self, text, where='body'):
        self.browser.until(lambda: text in self.browser.text(where), text)

    def press(self, action, sure=False):
        self.browser.until(lambda: self.browser.has(f'button[data-action={action}]'), action)
        self.browser.find(f'button[data-action={action}]').click()
        if sure:
            self.browser.accept()

    def check(self, name):
        """The page as it is now: to be read at all widths, light and dark, and no error in the console."""
        for width in (380, 1280, 2560):
            for dark in (False, True):
                self.browser.size(width, 900, dark)
                wrong = self.browser.run(UNREADABLE)
                assert not wrong, f'{name}, {width} px, {"dark" if dark else "light"}: {wrong}'
                if PICTURES:
                    time.sleep(0.5)  # frames are painted by and by
                    os.makedirs(PICTURES, exist_ok=True)
                    self.browser.picture(f'{PICTURES}/{name}-{width}-{"dark" if dark else "light"}.png')
        self.browser.size(1280, 900, False)
        self.no_errors(name)

    def no_errors(self, name):
        errors = self.browser.errors()
        assert not errors, f'{name}: the console says {errors}'


def strangers(walk, link):
    browser = walk.browser
    browser.open(link.split('?')[0])
    walk.until_says('Not let in')
    browser.errors()  # the browser itself calls an answer of 401 one
    walk.sign_in(link)
    assert browser.address() == walk.origin + '/', 'the link stays in the address'
    again = Browser()
    again.open(link)
    again.until(lambda: 'was used already' in again.text(), 'a link that works once')
    again.close()
    assert link_in('page.log') != link, 'there is no other link'


def jobs_without_workers(walk):
    walk.go('/')
    walk.until_says('There are no jobs yet')
    job = submit('landmark_map', 'log.h5', '--seed', '7')
    walk.browser.until(lambda: walk.browser.has(f'tr[data-key="{job}"]'), 'the job')
    walk.browser.find(f'tr[data-key="{job}"] a').click()
    walk.until_says('No worker is connected')
    walk.check('waits')
    return job


def run_pause_resume(walk, job):
    browser = walk.browser
    walk.press('pause')
    walk.until_says('paused by its owner')
    walk.until_says(f'{job} is paused.', '#told')
    walk.service.worker('--name', EVIL)
    browser.run('''const s = document.querySelector("select[data-action=priority]"); s.value = "3";
                   s.dispatchEvent(new Event("change", {bubbles: true}));''')
    walk.until_says('has the priority 3')
    walk.press('resume')
    walk.until_says('running', '.title')
    walk.until_says('round 1:', '.log')
    browser.until(lambda: browser.has('#curves .curve'), 'a curve')
    walk.check('runs')
    walk.until_says('done', '.title')
    browser.until(lambda: browser.run('const i = document.querySelector("img.map"); return i && i.complete && '
                                      'i.naturalWidth > 300'), 'the picture of the map')
    walk.until_says('landmark_map.h5', '#result')
    size = browser.run('''const x = new XMLHttpRequest(); x.open("GET", document.querySelector("a[download]").href, false);
                          x.overrideMimeType("text/plain; charset=x-user-defined"); x.send();
                          return [x.response.length, x.response.slice(1, 4)];''')
    assert size[0] > 10000 and size[1] == 'HDF', size
    walk.check('done')
    browser.find('#result .links a').click()
    browser.until(lambda: 'Landmarks' in browser.text() or 'landmarks' in browser.text(), 'the report')
    assert browser.run('return origin') == 'null', 'a report is of the page\'s own origin'
    walk.no_errors('report')


def so_far(walk):
    """The map of a job that runs, in the viewer of its report, and the next one in its place, which is looked at as it was."""
    browser = walk.browser
    cairn('simulate', 'loop', '--difficulty', 'base', '--robots', '4', '--seed', '1', 'team.h5')  # of many rounds
    job = submit('landmark_map', 'team.h5', '--seed', '5', '--set', 'cell_m=0.35', '--name', EVIL)
    walk.go('/jobs/' + job)
    browser.until(lambda: browser.has('#sofar iframe'), 'a map of a job that runs')
    browser.until(lambda: browser.has('#times rect'), 'tasks on a time line')
    walk.press('pause')
    walk.until_says('paused by its owner')
    walk.until_says('It is no result')
    version = 'return document.querySelector("#sofar iframe").dataset.src'
    slider = 'input[aria-label="Iteration"]'
    where = 'dispatchEvent(new Event("pagehide")); return JSON.parse(window.name.slice(6))[0].perMetre'

    def resume_until(done):
        """A round at a time, as a test cannot be faster than a job."""
        walk.press('resume')
        browser.until(done, 'another map')
        walk.press('pause')
        browser.until(lambda: 'paused' in browser.text('.title'), 'a pause')

    def has_rounds():
        browser.into('#sofar iframe')
        there = browser.has(slider)
        browser.leave()
        return there

    def settled():
        before = browser.run(version)
        time.sleep(2)
        return browser.run(version) == before
    browser.until(settled, 'the map of the last round')
    while not has_rounds():  # a start that has begun only now may be the best
        before = browser.run(version)
        resume_until(lambda: browser.run(version) != before)
        browser.until(settled, 'the map of the last round')
    browser.into('#sofar iframe')
    assert 'still being made' in browser.text() and browser.run('return origin') == 'null', browser.text()
    browser.run(f'const s = document.querySelector(`{slider}`); s.value = 0; s.dispatchEvent(new Event("input")); '
                'document.querySelector(".viewer-tools button").click();')
    walk.until_says('1 of ', '.viewer')
    looked = browser.run(where)
    browser.leave()
    walk.check('so-far')
    cairn('results', job, '--so-far', '--out', 'so-far')
    (file,) = [name for name in os.listdir('so-far') if name.endswith('.h5')]
    assert 'no result' in cairn('inspect', 'so-far/' + file)
    refused = subprocess.run(['cairn', 'export', 'csv', 'so-far/' + file, 'tables'], capture_output=True, text=True)
    assert 'of which nothing is exported' in refused.stderr, refused
    refused = subprocess.run(['cairn', 'evaluate', 'so-far', '--truth', 'team.h5'], capture_output=True, text=True)
    assert refused.returncode == 2 and 'no result' in refused.stderr, refused
    before = browser.run(version)
    resume_until(lambda: browser.run(version) != before)
    browser.into('#sofar iframe')
    walk.until_says('1 of ', '.viewer')
    assert abs(browser.run(where) / looked - 1) < 0.01, 'it is looked at anew'
    browser.leave()
    another_of(walk, job)
    walk.go('/jobs/' + job)
    walk.press('cancel', sure=True)
    walk.until_says('cancelled', '.title')
    browser.until(lambda: not browser.has('#sofar iframe'), 'no map of what has ended')
    walk.no_errors('so far')
    cairn('delete', job)


# What is saved, in place of a file: a browser without a screen asks nobody where it goes.
SAVED = '''
const saved = [];
const make = URL.createObjectURL;
URL.createObjectURL = (blob) => { saved.push(blob); return make(blob); };
HTMLAnchorElement.prototype.click = () => {};
document.querySelector(arguments[0]).click();
URL.createObjectURL = make;
return saved[0].text();'''
POINTED = '''
const svg = document.querySelector("svg[data-values]"), box = svg.getBoundingClientRect();
svg.dispatchEvent(new PointerEvent("pointermove", {clientX: box.right - 20, clientY: box.top + 40, bubbles: true}));
return document.getElementById("tip").hidden ? "" : document.getElementById("tip").textContent;'''


def stages_and_cells(walk):
    """Stages that branch as a graph, the cells of a search with those that it held before, curves that say what they are."""
    browser = walk.browser
    cairn('simulate', 'loop', '--difficulty', 'paper', '--sonar', '--seed', '7', 'sonar.h5')
    with open('branches.yaml', 'w') as job:
        job.write('name: branches\nseed: 7\ninputs: {log: sonar.h5}\nstages:\n'
                  '  - {name: landmarks, pipeline: landmark_map, log: log, options: {starts: 1}}\n'
                  '  - {name: raw, pipeline: evidence_map, log: log, options: {cell_m: 0.5}}\n'
                  '  - {name: forward, pipeline: forward_map, log: log, poses: landmarks, options: {cell_m: 0.25}}\n')
    job = submit('branches.yaml')
    walk.go('/jobs/' + job)
    browser.until(lambda: browser.has('.graph .arrow'), 'a graph of the stages')
    assert 'forward' in browser.run('return document.querySelector(".graph svg").ariaLabel')
    browser.until(lambda: browser.has('#sofar iframe'), 'a map of a job that runs')
    slider = 'input[aria-label="Iteration"]'

    def slides():
        try:
            browser.into('#sofar iframe')
            return browser.has('.viewer') and 'The map that the search holds' in browser.text() and browser.has(slider)
        except RuntimeError:  # another map has just taken its place
            return False
        finally:
            browser.leave()
    browser.until(slides, 'a map of cells with those before it')
    walk.press('pause')
    walk.until_says('paused by its owner')
    browser.until(slides, 'the same')
    browser.run('document.querySelector("#sofar").scrollIntoView()')
    browser.into('#sofar iframe')
    browser.run(f'const s = document.querySelector(`{slider}`); s.value = 0; s.dispatchEvent(new Event("input"));')
    walk.until_says('1 of ', '.viewer')
    browser.leave()
    walk.check('branches')
    browser.until(lambda: re.match(r'round \d+: -?[\d.]+ nats', browser.run(POINTED)), 'what a curve says where one points')
    assert browser.run(SAVED, 'figure.chart button[data-save=SVG]').startswith('<svg'), 'no curve as a file'
    assert browser.run('return fetch(location.pathname + "/rounds.csv").then((answer) => answer.text())').startswith(
        'stage,round,tasks,figure,value,unit\nlandmarks,'), 'no figures as a file'
    walk.press('resume')
    walk.until_says('done', '.title')
    walk.no_errors('branches')
    cairn('delete', job)


def another_of(walk, job):
    """A job of another's log, which the coordinator has."""
    browser = walk.browser
    browser.find('a[href^="/new?job="]').click()
    browser.until(lambda: browser.run('return document.querySelector("[name=job]").value') == job, 'the job')
    walk.check('from-job')
    browser.find('form[action="/new/from-job"] button').click()
    walk.until_says('What to make of it')
    assert 'controls' in browser.text('.facts'), browser.text()
    browser.find('a[href$="/landmark_map"]').click()
    browser.find('[name="set.iterations"]').type('2')
    browser.find('[value=submit]').click()
    browser.until(lambda: '/jobs/' in browser.address(), 'the job')
    other = browser.address().rsplit('/', 1)[1]
    assert other != job
    walk.until_says('done', '.title')
    browser.open(walk.origin + '/new?job=' + other)
    browser.run('document.querySelector("[name=what]").value = "inputs"')
    browser.find('form[action="/new/from-job"] button').click()
    walk.until_says('are not kept any more')
    browser.errors()  # the browser calls an answer of 400 one
    browser.find('[name=job]').type(other)
    browser.run('document.querySelector("[name=what]").value = "results"')
    browser.find('form[action="/new/from-job"] button').click()
    walk.until_says('landmark_map.h5', 'h1')
    for button in ('Remove it from here',) * 2:
        walk.until_says(button)
        browser.find('main form[action$="/remove"] button').click()
        browser.until(lambda: browser.run('return location.pathname') == '/new', 'files')
        if browser.has('tbody a'):
            browser.find('tbody a').click()
    cairn('delete', other)


def fail_retry_delete(walk):
    with open('greedy.yaml', 'w') as job:
        job.write('name: greedy\nseed: 7\ninputs: {log: log.h5}\ntask_memory_mb: 1\nstages:\n'
                  '  - {name: landmark_map, pipeline: landmark_map, log: log}\n')
    job = submit('greedy.yaml')
    walk.go('/jobs/' + job)
    walk.until_says('failed', '.title')
    walk.until_says('Retry goes on from the last checkpoint')
    walk.until_says('Attempts that failed')
    walk.check('failed')
    walk.press('retry')
    walk.until_says(f'{job} is ', '#told')
    walk.until_says('failed', '.title')
    walk.press('delete', sure=True)
    walk.until_says('There is no such job: it was deleted')
    walk.until_says(f'{job} is deleted.', '#told')
    walk.no_errors('deleted')


def choose_file(walk, file):
    """By the form, whose file is chosen as a person does."""
    walk.browser.open(walk.origin + '/new')
    walk.browser.find('input[type=file]').type(os.path.abspath(file))
    walk.browser.find('#bring button').click()


def start_a_job(walk):
    """From a file to a job that runs, by forms."""
    browser = walk.browser
    walk.go('/')
    browser.until(lambda: browser.has('a[href="/new"]'), 'where jobs are started')
    evil = '<img src=x onerror=alert(1)>.h5'
    shutil.copy('log.h5', evil)
    choose_file(walk, evil)
    walk.until_says('What to make of it')
    assert browser.text('h1').startswith('_img_src_x_onerror'), browser.text('h1')
    assert 'controls' in browser.text('.facts'), browser.text()
    browser.run('document.querySelector("details").open = true')
    walk.check('new-file')
    here = browser.address()
    browser.open(walk.origin + '/new')
    walk.check('new')
    browser.open(here)
    browser.find('a[href$="/landmark_map"]').click()
    walk.until_says('cell_m')
    browser.find('[name=name]').type(EVIL)
    browser.find('[name=seed]').type('11')
    browser.find('[name="set.cell_m"]').type('1000')
    walk.check('new-options')
    browser.find('[value=submit]').click()
    assert not browser.run('return document.querySelector("[name=\\"set.cell_m\\"]").checkValidity()'), 'no range'
    browser.run('document.querySelector("form.order").noValidate = true')  # as a browser does that knows no ranges
    browser.find('[value=plan]').click()
    walk.until_says('--set cell_m=1000: ')
    browser.errors()  # the browser calls an answer of 400 one
    browser.run('document.querySelector("[name=\\"set.cell_m\\"]").value = "0.5"')
    browser.find('[value=plan]').click()
    browser.until(lambda: browser.has('#plan .facts'), 'an estimate')
    assert 'Memory of a worker' in browser.text('#plan'), browser.text('#plan')
    walk.check('new-plan')
    browser.find('[value=submit]').click()
    browser.until(lambda: '/jobs/' in browser.address(), 'the job')
    job = browser.address().rsplit('/', 1)[1]
    walk.go('/jobs/' + job)
    walk.until_says(EVIL, '.title')
    assert browser.run('return document.title') != 'evil', 'a name was run'
    walk.until_says('done', '.title')
    browser.open(here)
    browser.find('form button').click()
    walk.until_says('Start a job', 'h1')
    assert browser.run('return location.pathname') == '/new', browser.address()
    assert not browser.has('tbody'), 'it is still here'
    with open('not.h5', 'w') as file:
        file.write('FLASER 1 2 3\n')
    choose_file(walk, 'not.h5')
    walk.until_says('no file of Cairn')
    assert not browser.has('a[href$="/landmark_map"]'), 'a job is offered of what is no log'
    walk.no_errors('start a job')
    cairn('delete', job)


def compare(walk, job):
    """Two results, by the truth of a log that one brings: what differs, side by side and one over the other."""
    browser = walk.browser
    other = submit('landmark_map', 'log.h5', '--seed', '8', '--set', 'starts=1', '--set', 'refine=false', '--name', EVIL)
    choose_file(walk, 'log.h5')
    walk.until_says('What to make of it')
    walk.go('/jobs/' + other)
    walk.until_says('done', '.title')
    walk.go('/jobs/' + job)
    browser.until(lambda: browser.has(f'#others option[value="{other}"]'), 'the other job')
    walk.check('done-of-two')
    browser.find('[name=other]').type(other)
    browser.run('document.querySelector("[name=log]").selectedIndex = 1')
    browser.until(lambda: browser.run('return document.querySelector("[name=other]").value') == other, 'what was typed')
    browser.run('document.querySelector("[name=other]").form.requestSubmit()')
    browser.until(lambda: browser.has('.compared'), 'a comparison')
    assert browser.run('return origin') == 'null', 'a comparison is of the page\'s own origin'
    text = browser.text()
    assert job in text and other in text and 'refine: false' in text, text
    assert 'trajectory' in text.lower() and 'difference' in text.lower(), text
    assert 'Where they come from' in text, text
    assert browser.run('return document.querySelectorAll(".beside .viewer").length') >= 2, 'no maps side by side'
    browser.run('''const over = [...document.querySelectorAll('input[type=range]')].find((e) => e.ariaLabel === "The other over it");
                   over.value = 50; over.dispatchEvent(new Event("input"));''')
    walk.until_says('dashed and as squares')
    walk.check('compared')
    cairn('delete', other)


def another_deletes(walk):
    job = submit('landmark_map', 'log.h5', '--seed', '2')
    walk.go('/jobs/' + job)
    cairn('cancel', job)
    walk.until_says('cancelled', '.title')
    cairn('delete', job)
    walk.until_says('There is no such job: it was deleted')
    walk.no_errors('deleted by another')


def killed(walk, coordinator, job):
    walk.go('/')
    walk.until_says('1 job')
    walk.service.stop(coordinator)
    walk.until_says('The coordinator does not answer')
    assert job in walk.browser.text(), 'what was known is gone'
    walk.check('no-coordinator')
    coordinator = walk.service.coordinator()
    walk.browser.until(lambda: 'does not answer' not in walk.browser.text(), 'a page that is back')
    walk.browser.until(lambda: walk.browser.has(f'tr[data-key="{job}"]'), 'the job')
    walk.no_errors('restart')
    return coordinator


def find_by_keyboard(walk, first):
    with open('other.yaml', 'w') as job:
        job.write('name: other\nseed: 3\ninputs: {log: log.h5}\nstages:\n'
                  '  - {name: landmark_map, pipeline: landmark_map, log: log}\n')
    other = submit('other.yaml')
    browser = walk.browser
    walk.go('/')
    walk.until_says('2 jobs')
    browser.press('/')
    for key in 'other':
        browser.press(key)
    walk.until_says('1 job')
    assert browser.address().endswith('/?q=other'), browser.address()
    browser.until(lambda: not browser.has(f'tr[data-key="{first}"]'), 'what was searched alone')
    for _ in range(40):
        browser.press('\ue004')
        if browser.run('return document.activeElement.pathname') == '/jobs/' + other:
            break
    outline = browser.run('return getComputedStyle(document.activeElement).outlineWidth')
    assert outline == '3px', f'where one is does not show: {outline}'
    browser.press('\ue007')
    browser.until(lambda: browser.address().endswith('/jobs/' + other), 'the job, by the keyboard')
    walk.until_says('done', '.title')
    walk.go('/?state=running')
    walk.until_says('No job is like that')
    walk.go('/workers')
    walk.until_says('idle')
    walk.until_says(EVIL)
    row = walk.browser.run(SAVED, '#workers button[data-save=CSV]').split('\n')
    assert row[0].startswith('Worker,Name,"Host, process"') and 'Memory' in row[0] and ' MB,' in row[1], row
    assert walk.browser.run('return document.title') != 'evil', 'a name was run'
    walk.check('workers')
    walk.go('/')
    walk.check('jobs')
    walk.no_errors('filter')


def without_script(walk):
    walk.browser.command('Emulation.setScriptExecutionDisabled', value=True)
    walk.browser.open(walk.origin + '/')
    html = walk.browser.ask('GET', '/source')
    assert 'landmark_map</a>' in html and '<tbody' in html, 'without a script it says nothing'
    for action in ('pause', 'delete'):
        assert f'data-action="{action}"' not in html
    choose_file(walk, 'log.h5')
    html = until(lambda: (lambda text: text if 'What to make of it' in text else '')(walk.browser.ask('GET', '/source')),
                 'what is in a file, without a script')
    assert '/landmark_map"' in html, html
    walk.browser.command('Emulation.setScriptExecutionDisabled', value=False)


def keys(service):
    """Over TCP the page has its key's rights, and says so when that is taken off the list."""
    folder = os.path.expanduser('~/.config/cairn/')
    for name in ('coordinator', 'viewer', 'desk'):
        cairn('keys', 'new', name)
    cairn('keys', 'allow', folder + 'viewer.pub', '--as', 'viewer')
    cairn('keys', 'allow', folder + 'desk.pub', '--as', 'submitter')
    endpoint = f'tcp://127.0.0.1:{free_port()}'
    coordinator = service.coordinator('--listen', endpoint, '--store', 'store_of_keys', log='keys.log')
    options = ['--connect', endpoint, '--server-key', folder + 'coordinator.pub']
    job = submit('landmark_map', 'log.h5', *options, '--key', folder + 'desk.key')
    walk = Walk(service)
    walk.sign_in(service.page(*options, '--key', folder + 'viewer.key', log='viewer.log'))
    walk.go('/jobs/' + job)
    walk.until_says('queued', '.title')
    walk.until_says('desk', '.facts')
    assert not walk.browser.has('[data-action]'), 'a viewer is offered what he may not do'
    walk.browser.open(walk.origin + '/new')
    walk.until_says('start no job')
    walk.browser.errors()  # the browser calls an answer of 403 one
    walk.go('/')
    assert not walk.browser.has('a[href="/new"]'), 'a viewer is offered to start a job'
    walk.go('/jobs/' + job)
    cairn('keys', 'revoke', folder + 'viewer.pub')
    walk.until_says('does not let this page\'s key in')
    assert job in walk.browser.text(), 'what was known is gone'
    walk.no_errors('revoked')
    walk.browser.close()
    service.stop(coordinator, 'terminate')


def free_port():
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        return free.getsockname()[1]


def behind_proxy(service):
    """As docs/page.md says, with its configuration of nginx word by word, but for ports and files."""
    if not shutil.which('nginx') or not shutil.which('openssl'):
        return print('without nginx or openssl: what is behind a proxy was not looked at')
    port, here = free_port(), os.getcwd()
    with open('a.password', 'w') as file:
        file.write('correct horse\n')
    os.chmod('a.password', 0o600)
    service.page('--behind-proxy', 'https://maps.example.org', '--password-file', 'a.password', '--listen', str(port),
                 log='proxied.log')
    subprocess.run(['openssl', 'req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-keyout', 'tls.key',
                    '-out', 'tls.pem', '-subj', '/CN=maps.example.org'], check=True, capture_output=True)
    with open(os.environ['CAIRN_SOURCE'] + '/docs/page.md') as page:
        site = re.search(r'```nginx\n(.*?)```', page.read(), re.S)[1]
    tls = free_port()
    for told, here_is in (('listen 443 ssl', f'listen 127.0.0.1:{tls} ssl'), ('127.0.0.1:8080', f'127.0.0.1:{port}'),
                          ('/etc/ssl/maps.example.org.pem', f'"{here}/tls.pem"'),
                          ('/etc/ssl/private/maps.example.org.key', f'"{here}/tls.key"')):
        assert told in site, f'docs/page.md has lost {told}'
        site = site.replace(told, here_is)
    temporary = ''.join(f'{kind}_temp_path "{here}/nginx_{kind}";\n'
                        for kind in ('client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'))
    with open('nginx.conf', 'w') as file:
        file.write(f'daemon off;\nerror_log "{here}/nginx.log";\npid "{here}/nginx.pid";\nevents {{}}\n'
                   f'http {{\naccess_log off;\n{temporary}{site}}}\n')
    nginx = service.start('nginx', '-p', here, '-c', here + '/nginx.conf', log='nginx.out')
    browser = Browser([f'--host-resolver-rules=MAP maps.example.org:443 127.0.0.1:{tls}'])
    until(lambda: not socket.socket().connect_ex(('127.0.0.1', tls)), 'nginx')
    browser.open('https://maps.example.org/')
    browser.find('input[name=password]').type('wrong horse')
    browser.press('\ue007')
    browser.until(lambda: 'that is not the password' in browser.text(), 'a refusal')
    browser.errors()  # the browser calls an answer of 401 one
    browser.find('input[name=password]').type('correct horse')
    browser.press('\ue007')
    browser.until(lambda: browser.has('#parts'), 'the pages')
    walk = Walk(service, browser)
    walk.origin = 'https://maps.example.org'
    job = submit('landmark_map', 'log.h5', '--seed', '9')
    walk.until_says(job)
    walk.go('/jobs/' + job)
    walk.until_says('done', '.title')
    walk.press('delete', sure=True)
    walk.until_says('There is no such job: it was deleted')
    walk.no_errors('behind a proxy')
    browser.close()
    service.stop(nginx, 'terminate')


def main():
    with Service() as service:
        coordinator = service.coordinator()
        link = service.page()
        walk = Walk(service)
        strangers(walk, link)
        job = jobs_without_workers(walk)
        run_pause_resume(walk, job)
        so_far(walk)
        stages_and_cells(walk)
        fail_retry_delete(walk)
        another_deletes(walk)
        start_a_job(walk)
        compare(walk, job)
        coordinator = killed(walk, coordinator, job)
        find_by_keyboard(walk, job)
        without_script(walk)
        walk.browser.close()
        behind_proxy(service)
        keys(service)
    print('walked through all pages')


if __name__ == '__main__':
    sys.exit(main())
