#!/usr/bin/env python3
"""Opens MCAP files in the viewers that people use, in a headless Chromium, and leaves pictures of what is seen there.

    npm install --prefix viewers @rerun-io/web-viewer@0.33.0 @foxglove/studio-base@1.48.0 react@17 react-dom@17
    cairn export mcap result seen
    tests/end_to_end/viewers.py viewers/node_modules pictures seen/map.mcap [--at X,Y,DISTANCE]

It fails where a viewer refuses a file, has a remark about it, or where Foxglove does not list each topic. What is drawn is for people to see;
--at says where Foxglove looks, in metres, and from how far (0,0,150).
"""
import argparse
import http.server
import json
import pathlib
import re
import sys
import threading
import time

from browser import Browser

RERUN = '''<body style="margin:0"><div id=viewer></div><script type=module>
import {WebViewer} from "/npm/@rerun-io/web-viewer/index.js";
const viewer = new WebViewer();
viewer.on("recording_open", () => { window.opened = true; });
await viewer.start(location.origin + "/map.mcap", document.getElementById("viewer"), {width: "1280px", height: "900px", render_backend: "webgl"});
</script>'''
FOXGLOVE = '''<meta charset=utf-8><style>html, body, #root { margin: 0; height: 100% }</style><div id=root></div>
<script>global = globalThis; process = {env: {}, browser: true, version: ""};</script>
<script src="/npm/react/umd/react.production.min.js"></script><script src="/npm/react-dom/umd/react-dom.production.min.js"></script>
<script>self["react"] = React; self["react-dom"] = ReactDOM;</script>
<script src="/npm/@foxglove/studio-base/assets/index.js"></script><script>
const topics = Object.fromEntries(TOPICS.map((topic) => [topic, {visible: true, ...(topic.endsWith("/path") ? {type: "line"} : {})}]));
const data = {configById: {"3D!1": {topics, followMode: "follow-none", layers: {},
                                    cameraState: {perspective: true, distance: DISTANCE, phi: 30, thetaOffset: 0, targetOffset: [TARGET, 0],
                                                  target: [0, 0, 0], targetOrientation: [0, 0, 0, 1], fovy: 45, near: 0.5, far: 5000}}},
              globalVariables: {}, userNodes: {}, playbackConfig: {speed: 1}, layout: "3D!1"};
const layout = {id: "one", name: "one", permission: "CREATOR_WRITE", baseline: {data, savedAt: new Date().toISOString()}};
const none = () => {};
localStorage.setItem("studio.profile-data", JSON.stringify({currentLayoutId: "one"}));
initI18n().then(() => ReactDOM.render(React.createElement(App, {
  deepLinks: [location.origin + "/?ds=remote-file&layoutId=one&ds.url=" + encodeURIComponent(location.origin + "/map.mcap")],
  appConfiguration: {get: (key) => key === "colorScheme" ? "light" : false, set: async () => {}, addChangeListener: none, removeChangeListener: none},
  layoutStorage: {list: async () => [layout], get: async () => layout, put: async (_, one) => one, delete: async () => {}, importLayouts: async () => {}},
  dataSources: [new RemoteDataSourceFactory()], extensionLoaders: [], enableGlobalCss: true,
}), document.getElementById("root")));
</script>'''
TYPES = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm'}


def serve(modules, pages):
    """Pages by name, the packages below /npm/; parts of files are served, as Foxglove asks for them. Returns the address."""
    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            name = self.path.partition('?')[0]
            file = modules / name.removeprefix('/npm/')
            if name.startswith('/npm/') and not file.suffix:
                file = file.with_suffix('.js')  # how one module of a package names another
            if name not in pages and not (name.startswith('/npm/') and file.is_file()):
                return self.send_error(404)
            body = pages[name] if name in pages else file.read_bytes()
            part = re.fullmatch(r'bytes=(\d+)-(\d*)', self.headers.get('Range', ''))
            self.send_response(206 if part else 200)
            if part:
                first, last = int(part[1]), min(int(part[2] or len(body)), len(body) - 1)
                self.send_header('Content-Range', f'bytes {first}-{last}/{len(body)}')
                body = body[first:last + 1]
            kind = '.html' if name in ('/rerun', '/foxglove') else file.suffix
            self.send_header('Content-Type', TYPES.get(kind, 'application/octet-stream'))
            self.send_header('Accept-Ranges', 'bytes')
            self.send_header('Content-Length', str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f'http://127.0.0.1:{server.server_port}'


def said(browser, pattern):
    return [line for line in browser.errors() if re.search(pattern, line)]


def in_rerun(browser, address, picture):
    browser.open(address + '/rerun')
    browser.until(lambda: browser.run('return window.opened === true'), 'Rerun opens it')
    time.sleep(20)  # without a graphics card it draws a few pictures a second
    browser.picture(picture, whole=False)
    return said(browser, r'WARN re_(?!renderer)|ERROR|[Pp]anick')


def in_foxglove(browser, address, picture, topics):
    browser.open(address + '/foxglove')
    browser.until(lambda: all(word in browser.text() for word in ('END TIME', 'Problems')), 'Foxglove opens it')
    time.sleep(20)
    browser.picture(picture, whole=False)
    listed = browser.text()
    remarks = [f'{topic} is not listed' for topic in topics if topic not in listed]
    browser.run("[...document.querySelectorAll('button[role=tab]')].find((tab) => tab.innerText.startsWith('Problems')).click()")
    browser.until(lambda: 'roblem' in browser.text(), 'the list of problems')
    if 'No problems found' not in browser.text():
        remarks.append(browser.text())
    return remarks


def main():
    parser = argparse.ArgumentParser()
    for name in ('modules', 'pictures'):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument('files', nargs='+')
    parser.add_argument('--at', default='0,0,150')
    given = parser.parse_args()
    modules, pictures = given.modules.resolve(), given.pictures
    target, _, distance = given.at.rpartition(',')
    pictures.mkdir(parents=True, exist_ok=True)
    remarks = []
    for number, file in enumerate(given.files):
        mcap = pathlib.Path(file).read_bytes()
        # The names of topics, from the channels of the summary.
        topics = sorted({name.decode() for name in re.findall(rb'/[A-Za-z0-9_/]+(?=\x08\x00\x00\x00protobuf)', mcap)})
        if not topics:
            raise SystemExit(f'{file}: no topics')
        foxglove = FOXGLOVE.replace('TOPICS', json.dumps(topics)).replace('TARGET', target).replace('DISTANCE', distance)
        pages = {'/map.mcap': mcap, '/rerun': RERUN.encode(), '/foxglove': foxglove.encode()}
        address = serve(modules, pages)
        for name, look in (('rerun', in_rerun), ('foxglove', lambda *to: in_foxglove(*to, topics))):
            browser = Browser(['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'])
            browser.ask('POST', '/timeouts', {'script': 110000})  # a page that draws without a graphics card is slow to answer
            found = look(browser, address, pictures / f'{name}_{number}.png')
            browser.close()
            print(f'{name}: {file}: {len(topics)} topics, {len(found)} remarks')
            remarks += found
    print(*remarks, sep='\n')
    return 1 if remarks else 0


sys.exit(main())
