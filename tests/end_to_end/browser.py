"""A headless Chromium, driven by its driver over W3C WebDriver with Python's standard library alone."""
import atexit
import base64
import json
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

ELEMENT = 'element-6066-11e4-a52e-4f735466cecf'
PATIENCE_S = 120


def ask(address, method, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(address, data, {'Content-Type': 'application/json'}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return json.load(answer)['value']
    except urllib.error.HTTPError as error:
        raise RuntimeError(json.load(error)['value']['message']) from None


class Element:
    def __init__(self, browser, reference):
        self.browser, self.path = browser, '/element/' + reference[ELEMENT]
        self.reference = reference

    def text(self):
        return self.browser.ask('GET', self.path + '/text')

    def click(self):
        self.browser.ask('POST', self.path + '/click', {})

    def type(self, text):
        self.browser.ask('POST', self.path + '/value', {'text': text})


class Browser:
    """Ends with its process at the latest."""

    def __init__(self, arguments=(), width=1280, height=900):
        self.profile = tempfile.TemporaryDirectory(prefix='cairn-browser-', ignore_cleanup_errors=True)
        self.driver = subprocess.Popen(['chromedriver', '--port=0'], stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
        self.base = None  # until there is a session
        atexit.register(self.close)
        port = None
        for line in self.driver.stdout:
            if 'successfully on port ' in line:
                port = line.rsplit(' ', 1)[1].strip().rstrip('.')
                break
        driver = f'http://127.0.0.1:{port}/session'
        arguments = [*arguments, '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
                     '--disable-background-networking', '--disable-component-update', '--hide-scrollbars',
                     f'--user-data-dir={self.profile.name}', f'--window-size={width},{height}']
        capabilities = {'browserName': 'chrome', 'acceptInsecureCerts': True, 'goog:loggingPrefs': {'browser': 'ALL', 'performance': 'ALL'},
                        'goog:chromeOptions': {'args': arguments, 'binary': '/usr/bin/chromium'},
                        'unhandledPromptBehavior': 'ignore'}
        answer = ask(driver, 'POST', {'capabilities': {'alwaysMatch': capabilities}})
        self.base = driver + '/' + answer['sessionId']
        self.size(width, height)

    def ask(self, method, path, body=None):
        return ask(self.base + path, method, body)

    def command(self, name, **parameters):
        """Of Chromium's own protocol."""
        return self.ask('POST', '/goog/cdp/execute', {'cmd': name, 'params': parameters})

    def size(self, width, height, dark=None):
        self.command('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=1, mobile=False)
        if dark is not None:
            scheme = 'dark' if dark else 'light'
            self.command('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])

    def open(self, address):
        self.ask('POST', '/url', {'url': address})

    def address(self):
        return self.ask('GET', '/url')

    def run(self, script, *arguments):
        return self.ask('POST', '/execute/sync', {'script': script, 'args': list(arguments)})

    def find(self, selector):
        return Element(self, self.ask('POST', '/element', {'using': 'css selector', 'value': selector}))

    def into(self, selector):
        """What follows is within that frame, until leave()."""
        self.ask('POST', '/frame', {'id': self.find(selector).reference})

    def leave(self):
        self.ask('POST', '/frame', {'id': None})

    def has(self, selector):
        return bool(self.ask('POST', '/elements', {'using': 'css selector', 'value': selector}))

    def text(self, selector='body'):
        """What is to be read there; empty where there is no such element."""
        return self.run('const e = document.querySelector(arguments[0]); return e ? e.innerText : "";', selector)

    def until(self, condition, what):
        """Waits for it, as long as a test may; `what` names it where it never comes."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f'never came: {what}\n{self.text()[:3000]}')

    def accept(self):
        self.until(self._has_prompt, 'a question')
        self.ask('POST', '/alert/accept', {})

    def _has_prompt(self):
        try:
            self.ask('GET', '/alert/text')
            return True
        except RuntimeError:
            return False

    def press(self, *keys):
        """Keys of WebDriver: '\\ue004' is Tab, '\\ue007' Enter."""
        actions = [{'type': kind, 'value': key} for key in keys for kind in ('keyDown', 'keyUp')]
        self.ask('POST', '/actions', {'actions': [{'type': 'key', 'id': 'keys', 'actions': actions}]})

    def picture(self, file, whole=True):
        parameters = {'format': 'png'}
        if whole:
            height = self.run('return document.documentElement.scrollHeight')
            width = self.run('return innerWidth')
            parameters.update(captureBeyondViewport=True,
                              clip={'x': 0, 'y': 0, 'width': width, 'height': min(height, 6000), 'scale': 1})
        with open(file, 'wb') as out:
            out.write(base64.b64decode(self.command('Page.captureScreenshot', **parameters)['data']))

    def errors(self):
        """What the console has said since it was asked last that is no mere information."""
        log = self.ask('POST', '/se/log', {'type': 'browser'})
        return [line['message'] for line in log if line['level'] in ('SEVERE', 'WARNING')]

    def close(self):
        atexit.unregister(self.close)
        try:
            if self.base:
                self.ask('DELETE', '')
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.profile.cleanup()
