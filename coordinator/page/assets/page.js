// Makes the page live: parts of it that change come by server-sent events, and are put in place without losing the
// focus, the selection or what is unfolded. Without it the page shows how things stood when it was loaded.
'use strict';

const $ = (id) => document.getElementById(id);

// What `html` says takes the place of what is within `element`, node by node.
function put(element, html) {
  const wanted = document.createElement('template');
  wanted.innerHTML = html;
  morph(element, wanted.content);
}

const keyOf = (node) => node.nodeType === 1 ? node.getAttribute('data-key') || node.id || null : null;

function morph(old, wanted) {
  const keyed = new Map();
  for (const node of old.childNodes) if (keyOf(node)) keyed.set(keyOf(node), node);
  let at = old.firstChild;
  for (const next of [...wanted.childNodes]) {
    const key = keyOf(next);
    let here = key ? keyed.get(key) : at;
    if (here && !key && keyOf(here)) here = null;
    if (here && (here.nodeType !== next.nodeType || here.nodeName !== next.nodeName)) here = null;
    if (!here) {
      old.insertBefore(next, at);
      continue;
    }
    if (here === at) at = at.nextSibling;
    else old.insertBefore(here, at);
    update(here, next);
  }
  while (at) {
    const gone = at;
    at = at.nextSibling;
    gone.remove();
  }
}

function update(here, next) {
  if (here.nodeType !== 1) {
    if (here.nodeValue !== next.nodeValue) here.nodeValue = next.nodeValue;
    return;
  }
  if (here.isEqualNode(next)) return;
  for (const {name} of [...here.attributes]) if (!next.hasAttribute(name)) here.removeAttribute(name);
  // Another page in a frame is no place to go back to.
  if (here.nodeName === 'IFRAME' && next.dataset.src !== here.dataset.src) here.contentWindow.location.replace(next.dataset.src);
  if (here.nodeName === 'IFRAME') next.setAttribute('src', here.getAttribute('src'));
  for (const {name, value} of [...next.attributes]) if (here.getAttribute(name) !== value) here.setAttribute(name, value);
  if (here.nodeName === 'SELECT' && here === document.activeElement) return;  // somebody chooses
  morph(here, next);
  if (here.nodeName === 'SELECT') here.value = next.value;
}

let telling = 0;

// What is good news stays for a while, what is not until something else is told.
function tell(text, good) {
  clearTimeout(telling);
  if (good) telling = setTimeout(() => tell(''), 10000);
  const line = document.createElement('p');
  line.textContent = text;
  if (good) line.className = 'good';
  $('told').replaceChildren(...(text ? [line] : []));
}

// Parts in their order; those that are not named are gone.
function show({order, parts}) {
  if ('notice' in parts) put($('notice'), parts.notice);
  const main = $('parts');
  if (!main) return;
  let at = main.firstElementChild;
  for (const id of order) {
    if (id === 'notice') continue;
    let section = $(id);
    if (!section) {
      section = document.createElement('section');
      section.id = id;
    }
    if (section === at) at = at.nextElementSibling;
    else main.insertBefore(section, at);
    if (id in parts) put(section, parts[id]);
  }
  while (at) {
    const gone = at;
    at = at.nextElementSibling;
    gone.remove();
  }
}

let events = null;
let lost = false;

function listen(address) {
  if (events) events.close();
  events = new EventSource(address);
  events.addEventListener('open', () => {
    $('live').textContent = 'live';
    if (lost) tell('');
    lost = false;
  });
  events.addEventListener('parts', (event) => show(JSON.parse(event.data)));
  events.addEventListener('over', (event) => {
    events.close();
    $('live').textContent = 'over';
    tell(event.data);
  });
  events.addEventListener('error', () => {
    if (events.readyState === EventSource.CLOSED) {
      $('live').textContent = 'not live';
      tell('This page is not let in any more: “cairn page” was started again, or too many look on. ' +
           'Open the link that it printed, or load this page again.');
      return;
    }
    lost = true;
    $('live').textContent = 'not live';
    tell('“cairn page” does not answer. Shown is what it said last; this page tries again by itself.');
  });
}

// What is chosen above the jobs holds at once, and is in the address.
function followFilter(form) {
  let wait = 0;
  const choose = () => {
    const query = new URLSearchParams();
    for (const [name, value] of new FormData(form)) if (value) query.set(name, value);
    const text = query.toString();
    history.replaceState(null, '', text ? '/?' + text : '/');
    listen('/events?for=/' + (text ? '&' + text : ''));
  };
  form.addEventListener('input', () => {
    clearTimeout(wait);
    wait = setTimeout(choose, 120);
  });
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    clearTimeout(wait);
    choose();
  });
}

async function act(element, action, body) {
  const job = element.closest('[data-job]').dataset.job;
  const buttons = element.closest('[data-job]').querySelectorAll('button');
  for (const button of buttons) button.disabled = true;
  try {
    const answer = await fetch(job + '/' + action, {
      method: 'POST', headers: {'X-Cairn': 'page', 'Content-Type': 'application/x-www-form-urlencoded'}, body});
    const said = await answer.json();
    tell(said.text, said.ok);
  } catch (error) {
    tell('“cairn page” does not answer: whether the job was told is not known.');
  }
  for (const button of buttons) button.disabled = false;
}

// A file on its way shows how far it has come; one that is too large is not sent.
function bring(form, event) {
  const file = form.querySelector('input[type=file]').files[0];
  if (!file) return;
  event.preventDefault();
  if (file.size > Number(form.dataset.most)) {
    tell('“' + file.name + '” is larger than there is room for here: “cairn submit” takes it.');
    return;
  }
  const button = form.querySelector('button'), bar = form.querySelector('progress');
  const end = (text) => {
    bar.hidden = true;
    button.disabled = false;
    if (text) tell(text);
  };
  const request = new XMLHttpRequest();
  request.upload.addEventListener('progress', (at) => { bar.value = at.total ? at.loaded / at.total : 0; });
  request.addEventListener('error', () => end('The file did not get here: “cairn page” does not answer, or there is no room for it.'));
  request.addEventListener('load', () => {
    if (request.status === 200 && request.responseURL !== form.action) return location.assign(request.responseURL);
    const answer = new DOMParser().parseFromString(request.responseText, 'text/html').getElementById('main');
    end(answer ? '' : 'The file was not taken.');
    if (answer) put($('main'), answer.innerHTML);
  });
  bar.hidden = false;
  button.disabled = true;
  tell('');
  request.open('POST', form.action);
  request.send(new FormData(form));
}

// What a curve says where one points at it.
function point(event) {
  const svg = event.target.closest('svg[data-values]');
  $('tip').hidden = !svg;
  if (!svg) return;
  const values = svg.dataset.values.split(' ').map((pair) => pair.split(',').map(Number)), box = svg.getBoundingClientRect();
  const from = Number(svg.dataset.from), to = Number(svg.dataset.to), first = values[0][0], last = Math.max(values.at(-1)[0], first + 1);
  const at = (event.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
  const round = first + (at - from) / (to - from) * (last - first);
  const [x, y] = values.reduce((a, b) => Math.abs(b[0] - round) < Math.abs(a[0] - round) ? b : a);
  $('tip').textContent = `round ${x}: ${y}${svg.dataset.unit}`;
  $('tip').style.left = Math.min(event.clientX + 14, innerWidth - $('tip').offsetWidth - 6) + 'px';
  $('tip').style.top = event.clientY + 18 + 'px';
}

// The picture of its figure, or the picture or table of its section.
function saveBeside(button) {
  const around = button.closest('figure, section');
  if (button.dataset.save === 'SVG') saveSvg(around.querySelector('svg[role=img]'));
  else saveCsv(around.querySelector('table'));
}

document.documentElement.classList.add('has-script');
document.addEventListener('pointermove', point);
document.addEventListener('submit', (event) => event.target.id === 'bring' && bring(event.target, event));
document.addEventListener('click', (event) => {
  const saves = event.target.closest('button[data-save]');
  if (saves) return saveBeside(saves);
  const button = event.target.closest('button[data-action]');
  if (!button) return;
  if (button.dataset.sure && !confirm(button.dataset.sure)) return;
  act(button, button.dataset.action, '');
});
document.addEventListener('change', (event) => {
  const choice = event.target.closest('select[data-action]');
  if (choice) act(choice, choice.dataset.action, 'priority=' + encodeURIComponent(choice.value));
});
document.addEventListener('keydown', (event) => {
  const search = document.querySelector('#filter input');
  const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.nodeName);
  if (event.key !== '/' || typing || !search) return;
  event.preventDefault();
  search.focus();
});
if ($('filter')) followFilter($('filter'));
if (document.body.dataset.events) listen(document.body.dataset.events);
addEventListener('pagehide', () => events && events.close());
addEventListener('pageshow', (event) => event.persisted && location.reload());
