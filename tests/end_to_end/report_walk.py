"""What the script of a report does, in the reports of report_in_browser_test.sh."""
import itertools
import pathlib
import sys

from browser import Browser

# The mean brightness of each square of 16 pixels of a viewer, after whatever it was asked to draw: a browser does not draw the same
# line with the same pixels each time.
LOOK = '''
const canvas = document.querySelectorAll('.viewer canvas')[arguments[0]], edge = 16;
return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const columns = Math.ceil(canvas.width / edge), sums = new Array(columns * Math.ceil(canvas.height / edge)).fill(0);
  for (let y = 0, i = 0; y < canvas.height; ++y)
    for (let x = 0; x < canvas.width; ++x, i += 4)
      sums[Math.floor(y / edge) * columns + Math.floor(x / edge)] += pixels[i + 3] * (3 * 255 - pixels[i] - pixels[i + 1] - pixels[i + 2]) / (3 * 255);
  done(sums.map((sum) => sum / edge / edge));
})));'''
PRESS = '''
const canvas = document.querySelectorAll('.viewer canvas')[arguments[0]];
for (const key of arguments[1]) canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));'''
MOVE = '''
const input = document.querySelectorAll('.viewer-time input')[arguments[0]];
input.value = arguments[1];
input.dispatchEvent(new Event('input'));
return input.parentElement.querySelector('output').textContent;'''
POINT = '''
const canvas = document.querySelector('.viewer canvas'), box = canvas.getBoundingClientRect();
for (let y = 4; y < box.height; y += 4)
  for (let x = 4; x < box.width; x += 4) {
    canvas.dispatchEvent(new PointerEvent('pointermove', {clientX: box.left + x, clientY: box.top + y}));
    const tip = document.querySelector('.viewer-tip');
    if (!tip.hidden && tip.textContent.startsWith(arguments[0]))
      return [tip.textContent, document.querySelector('.viewer-place').textContent];
  }
return null;'''
SAVE = '''
const saved = [];
const make = URL.createObjectURL;
URL.createObjectURL = (blob) => { saved.push(blob); return make(blob); };
HTMLAnchorElement.prototype.click = () => {};
const press = (selector) => document.querySelector(selector).click();
press('button[aria-label="Save this picture as SVG"]');
press('button[aria-label="Save this table as CSV"]');
press('button[aria-label="Save this picture as PNG"]');
return new Promise((done) => setTimeout(async () => {
  done([await saved[0].text(), await saved[1].text(), saved.map((blob) => blob.type)]);
}, 1500));'''


def same(one, other):
    return len(one) == len(other) and max(abs(a - b) for a, b in zip(one, other)) < 0.5


def open_page(browser, name):
    browser.open(pathlib.Path(name).resolve().as_uri())
    browser.until(lambda: browser.has('.viewer canvas'), 'a map to look around in')


def looks(browser):
    open_page(browser, 'one/report.html')
    seen = [browser.run(LOOK, 0)]
    for keys in (['+', '+'], ['ArrowLeft'], ['-']):
        browser.run(PRESS, 0, keys)
        seen.append(browser.run(LOOK, 0))
    assert not any(same(*pair) for pair in itertools.combinations(seen, 2)), 'a key changed nothing'
    browser.run(PRESS, 0, ['0'])
    assert same(browser.run(LOOK, 0), seen[0]), '0 does not show all again'
    for layer in browser.run('return [...document.querySelectorAll(".viewer-layers label")].map((e) => e.textContent)'):
        hide = f'document.querySelectorAll(".viewer-layers label")[{{}}].click()'
        index = browser.run('return [...document.querySelectorAll(".viewer-layers label")].findIndex('
                            '(e) => e.textContent === arguments[0])', layer)
        browser.run(hide.format(index))
        assert not same(browser.run(LOOK, 0), seen[0]), f'without {layer} it looks the same'
        browser.run(hide.format(index))
        assert same(browser.run(LOOK, 0), seen[0]), f'{layer} does not come back'


def slides(browser):
    whole = browser.run(LOOK, 0)
    assert browser.run(MOVE, 0, 500).endswith(' s'), 'no time'
    assert not same(browser.run(LOOK, 0), whole), 'the time changes nothing'
    assert browser.run(MOVE, 0, 1000) == 'all'
    assert browser.run(MOVE, 1, 0).startswith('1 of '), 'no first iteration'
    assert not same(browser.run(LOOK, 0), whole), 'the iteration changes nothing'
    assert browser.run(MOVE, 1, 10000) == 'this map'
    assert same(browser.run(LOOK, 0), whole), 'the map does not come back'


def points(browser):
    landmark, place = browser.run(POINT, 'landmark ')
    assert 'seen' in landmark and '95% within' in landmark, landmark
    assert place.startswith('x ') and ' m, y ' in place, place
    assert ' s: x ' in browser.run(POINT, 'robot ')[0]
    svg, csv, types = browser.run(SAVE)
    assert types == ['image/svg+xml', 'text/csv', 'image/svg+xml', 'image/png'], types
    assert 'xmlns="http://www.w3.org/2000/svg"' in svg and 'var(' not in svg, svg[:300]
    assert csv.count('\n') > 1 and ',' in csv, csv


def earlier_maps(browser):
    """Of a search over cells the maps that it held before, and what the cells under the pointer are."""
    open_page(browser, 'forward/report.html')
    index = browser.run("""const viewers = [...document.querySelectorAll('.viewer')];
        return viewers.findIndex((viewer) => viewer.querySelector('input[aria-label="Iteration"]'));""")
    assert browser.run('return document.querySelectorAll(".viewer")[arguments[0]].closest("section").querySelector("h2").textContent',
                       index) == 'Most likely map'
    browser.run('document.querySelectorAll(".viewer")[arguments[0]].scrollIntoView()', index)
    last = browser.run(LOOK, index)
    slider = browser.run("""return [...document.querySelectorAll('.viewer-time input')].indexOf(
        document.querySelector('.viewer-time input[aria-label="Iteration"]'))""")
    assert browser.run(MOVE, slider, 0).startswith('1 of '), 'no first map'
    browser.until(lambda: not same(browser.run(LOOK, index), last), 'the first map of the search')
    assert browser.run(MOVE, slider, 10000) == 'this map'
    browser.until(lambda: same(browser.run(LOOK, index), last), 'the last map again')
    for viewer, said in ((index, ', occupied'), (index, ', free'), (index + 1, ' nat')):
        cells = POINT.replace("'.viewer canvas'", f"`[data-looked] canvas`").replace('.viewer-tip', '[data-looked] .viewer-tip')
        cells = cells.replace('.viewer-place', '[data-looked] .viewer-place').replace(
            '!tip.hidden && tip.textContent.startsWith(arguments[0])',
            'document.querySelector("[data-looked] .viewer-place").textContent.includes(arguments[0])')
        browser.run("""document.querySelectorAll('.viewer').forEach((viewer, i) => viewer.toggleAttribute('data-looked', i === arguments[0]));
                       document.querySelector('[data-looked]').scrollIntoView();""", viewer)
        browser.until(lambda: browser.run(cells, said), f'a cell that is{said}')


def main():
    browser = Browser()
    looks(browser)
    slides(browser)
    points(browser)
    for width in (380, 1280, 2560):
        browser.size(width, 900)
        assert browser.run('return document.documentElement.scrollWidth') <= width, f'wider than {width} pixels'
    browser.size(1280, 900)
    open_page(browser, 'hall/report.html')
    browser.run('document.querySelector(".viewer").scrollIntoView()')
    cell = browser.until(lambda: browser.run(POINT.replace('!tip.hidden && tip.textContent.startsWith(arguments[0])',
                                                           'document.querySelector(".viewer-place").textContent'
                                                           '.includes("p(occupied)")'), ''), 'a cell that is known')
    assert 0 <= float(cell[1].rsplit(' ', 1)[1]) <= 1, cell
    earlier_maps(browser)
    open_page(browser, 'one/comparison.html')
    before = [browser.run(LOOK, map) for map in (0, 1)]
    browser.run(PRESS, 1, ['+'])
    assert not any(same(browser.run(LOOK, map), before[map]) for map in (0, 1)), 'the maps are not looked at together'
    # One over the other: each shows its own, both, and the other alone, which is what it is in its own place.
    browser.run('document.querySelectorAll(".beside .viewer-tools button[aria-label=\\"Show all\\"]")[0].click()')
    over = browser.run('return [...document.querySelectorAll(".viewer-time input")].findIndex((e) => '
                       'e.ariaLabel === "The other over it")')
    own, other = browser.run(LOOK, 0), browser.run(LOOK, 1)
    assert '50%' in browser.run(MOVE, over, 50), 'how much shows is not said'
    both = browser.run(LOOK, 0)
    assert not same(both, own) and not same(both, other), 'the other is not laid over it'
    assert browser.run(MOVE, over, 0) == 'alone'
    assert not same(browser.run(LOOK, 0), both), 'it does not fade'
    assert browser.run(MOVE, over, 100) == 'not shown'
    assert same(browser.run(LOOK, 0), own), 'it does not go'
    assert same(browser.run(LOOK, 1), other), 'the other one is not as it was'
    # LOOK reads pixels, which the page does not do while it draws.
    errors = [line for line in browser.errors() if 'willReadFrequently' not in line]
    assert not errors, errors
    browser.close()
    print('looked around, slid, pointed, saved and compared')


if __name__ == '__main__':
    sys.exit(main())
