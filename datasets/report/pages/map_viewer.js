// Looking around in a map, which is drawn anew from its picture's own shapes.
class MapViewer {
  constructor(svg, figure) {
    this.svg = svg;
    this.figure = figure;
    const [left, top, width, height] = numbers(svg, "data-panel");
    const [xLow, xHigh, yLow, yHigh] = numbers(svg, "data-metres");
    this.panel = {left, top, width, height};
    this.metres = {perUnit: (xHigh - xLow) / width, x: xLow, y: yHigh, height: yHigh - yLow};
    this.layers = [...svg.querySelectorAll("g[data-layer]")].map((group) => ({
      name: group.getAttribute("data-layer"), shown: !group.classList.contains("off"),
      shapes: [...group.children].map(readShape).filter((shape) => shape)}));
    this.layers = this.layers.filter((layer) => layer.shapes.length > 0);
    this.readRounds();
    this.names = {name: "names", shown: true, shapes: []};
    this.looks = new Map();
    this.until = null;  // seconds: only what was until then
    this.strength = 1;  // how much of it shows
    this.over = 0;  // how much of the map beside it shows over it, and as much less of this one beyond the half
    this.build();
    this.reset();
    for (const shape of this.layers.flatMap((layer) => layer.shapes))
      if (shape.image) shape.image.onload = () => this.draw();
  }

  // -- Parts of the page.

  build() {
    this.canvas = make("canvas", {tabindex: "0", role: "img",
      "aria-label": `${this.svg.getAttribute("aria-label")}. Arrow keys move it, plus and minus change its scale, 0 shows all.`});
    this.tip = make("div", {class: "viewer-tip", hidden: ""});
    this.place = make("output", {class: "viewer-place", "aria-live": "off"});
    const tools = make("div", {class: "viewer-tools"},
      button("+", "Closer", () => this.zoom(1.5)), button("−", "Farther", () => this.zoom(1 / 1.5)),
      button("All", "Show all", () => this.reset()));
    this.box = make("div", {class: "viewer-box"}, this.canvas, tools, this.tip, this.place);
    this.box.style.aspectRatio = `${this.panel.width} / ${this.panel.height}`;
    this.root = make("div", {class: "viewer"}, this.layerList(), this.box, ...this.timeLine(),
      ...this.roundLine());
    this.svg.closest("figure").prepend(this.root);
    this.figure.classList.add("has-viewer");
    this.listen();
    new ResizeObserver(() => this.resize()).observe(this.box);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.looks.clear();
      this.draw();
    });
  }

  layerList() {
    if (this.layers.length < 2) return "";
    const list = make("ul", {class: "viewer-layers"});
    const named = this.layers.some((layer) => layer.shapes.some((shape) => shape.name));
    for (const layer of named ? [...this.layers, this.names] : this.layers) {
      const check = make("input", {type: "checkbox"});
      check.checked = layer.shown;
      check.addEventListener("change", () => {
        layer.shown = check.checked;
        this.draw();
      });
      list.append(make("li", {}, make("label", {}, check, layer.name)));
    }
    return list;
  }

  // The maps that came before this one: of the layer that has them, its circles are this one's.
  readRounds() {
    const group = this.svg.querySelector("[data-rounds]");
    const name = group?.closest("g[data-layer]").getAttribute("data-layer");
    this.roundsLayer = this.layers.find((layer) => layer.name === name);
    const cells = this.roundsLayer?.shapes.find((shape) => shape.image);
    this.rounds = (group?.getAttribute("data-rounds") || "").split(";").filter((text) => text).map((round) => {
      if (cells) return [{...cells, pixels: null, image: pngOf(round, () => this.draw())}];
      return round.split(" ").map((place) => {
        const [x, y] = place.split(",").map(Number);
        return {tag: "circle", classes: group.getAttribute("class"), tip: "", name: null, x, y, r: 3.2};
      });
    });
    this.round = null;  // of `rounds`; null: this one
  }
  shapesOf(layer) {
    return this.round !== null && layer === this.roundsLayer ? this.rounds[this.round] : layer.shapes;
  }

  roundLine() {
    if (this.rounds.length < 2) return [];
    const last = this.rounds.length;
    return [this.slider("Iteration", last, (value) => {
      this.round = value < last ? value : null;
      if (value === last) return "this map";
      const of = this.rounds[value];
      return `${value + 1} of ${last}` + (of[0]?.image ? "" : `, ${of.length} landmarks`);
    })];
  }

  slider(title, last, at) {
    const input = make("input", {type: "range", min: "0", max: `${last}`, value: `${last}`, "aria-label": title});
    const text = make("output", {}, at(last));
    input.addEventListener("input", () => {
      text.textContent = at(+input.value);
      input.setAttribute("aria-valuetext", text.textContent);
      this.draw();
    });
    return make("label", {class: "viewer-time"}, make("span", {}, title), input, text);
  }

  // A slider over the time that the robots' paths take.
  timeLine() {
    const timed = this.layers.flatMap((layer) => layer.shapes).filter((shape) => shape.times && /^path /.test(shape.classes));
    if (timed.length === 0) return [];
    this.timed = timed;
    const first = Math.min(...timed.map((s) => s.times[0])), last = Math.max(...timed.map((s) => s.times.at(-1)));
    if (!(last > first)) return [];
    const steps = 1000;
    return [this.slider("Time", steps, (value) => {
      this.until = value < steps ? first + value / steps * (last - first) : null;
      return this.until === null ? "all" : clock(this.until);
    })];
  }

  // -- Where one looks: scale is in pixels for one of the picture's units, (x, y) the unit at the box's corner.

  get size() { return {width: this.canvas.clientWidth, height: this.canvas.clientHeight}; }
  reset() {
    const {width, height} = this.size, p = this.panel;
    this.scale = Math.min(width / p.width, height / p.height);
    this.x = p.left - (width / this.scale - p.width) / 2;
    this.y = p.top - (height / this.scale - p.height) / 2;
    this.least = this.scale / 4;
    this.whole = true;  // and stays so when the page changes its width
    this.draw();
  }
  zoom(factor, at = {x: this.size.width / 2, y: this.size.height / 2}) {
    const scale = Math.min(Math.max(this.scale * factor, this.least), this.least * 4000);
    this.x += at.x / this.scale - at.x / scale;
    this.y += at.y / this.scale - at.y / scale;
    this.scale = scale;
    this.whole = false;
    this.draw();
  }
  move(dx, dy) {
    this.x -= dx / this.scale;
    this.y -= dy / this.scale;
    this.whole = false;
    this.draw();
  }
  resize() {
    const {width, height} = this.size, ratio = devicePixelRatio || 1;
    if (width === this.width && height === this.height) return;
    Object.assign(this, {width, height});
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    if (this.whole) this.reset(); else this.draw();
  }
  // What look() takes in a picture of the same place; the last iteration is the last there, too.
  looking() {
    return {...this.toMetres({x: this.size.width / 2, y: this.size.height / 2}), whole: this.whole,
      perMetre: this.scale / this.metres.perUnit, round: this.round, hidden: [...this.layers, this.names].filter((l) => !l.shown).map((l) => l.name)};
  }
  look(at) {
    for (const check of this.root.querySelectorAll(".viewer-layers input"))
      if (at.hidden.includes(check.parentElement.textContent) === check.checked) check.click();
    const slider = this.root.querySelector('input[aria-label="Iteration"]');
    if (slider && at.round !== null) {
      slider.value = at.round;
      slider.dispatchEvent(new Event("input"));
    }
    if (at.whole || !(at.perMetre > 0)) return;
    const there = this.toUnits(at.x, at.y), {width, height} = this.size;
    this.scale = at.perMetre * this.metres.perUnit;
    this.x = there.x - width / 2 / this.scale;
    this.y = there.y - height / 2 / this.scale;
    this.whole = false;
    this.draw();
  }
  toMetres(at) {
    const m = this.metres, p = this.panel;
    return {x: m.x + (this.x + at.x / this.scale - p.left) * m.perUnit,
      y: m.y - (this.y + at.y / this.scale - p.top) * m.perUnit};
  }
  toUnits(x, y) {
    const m = this.metres, p = this.panel;
    return {x: p.left + (x - m.x) / m.perUnit, y: p.top + (m.y - y) / m.perUnit};
  }
  toPixels(x, y) { return {x: (x - this.x) * this.scale, y: (y - this.y) * this.scale}; }

  listen() {
    const pointers = new Map(), canvas = this.canvas;
    const at = (event) => {
      const box = canvas.getBoundingClientRect();
      return {x: event.clientX - box.left, y: event.clientY - box.top};
    };
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return {middle: {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2}, apart: Math.hypot(a.x - b.x, a.y - b.y)};
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, at(event));
    });
    canvas.addEventListener("pointermove", (event) => {
      const now = at(event), before = pointers.get(event.pointerId);
      if (!before) return this.point(now);
      if (pointers.size === 1) this.move(now.x - before.x, now.y - before.y);
      const old = pointers.size === 2 ? spread() : null;
      pointers.set(event.pointerId, now);
      if (!old) return;
      const next = spread();
      this.move(next.middle.x - old.middle.x, next.middle.y - old.middle.y);
      this.zoom(next.apart / Math.max(old.apart, 1), next.middle);
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("pointerleave", () => this.point(null));
    canvas.addEventListener("wheel", (event) => {
      // A page that is scrolled past the map goes on: the map takes the wheel once it was clicked, or with Ctrl.
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / (event.deltaMode ? 20 : 400)), at(event));
    }, {passive: false});
    canvas.addEventListener("dblclick", (event) => this.zoom(2, at(event)));
    canvas.addEventListener("keydown", (event) => {
      const step = 60, keys = {ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
      if (keys[event.key]) this.move(...keys[event.key]);
      else if (event.key === "+" || event.key === "=") this.zoom(1.25);
      else if (event.key === "-") this.zoom(1 / 1.25);
      else if (event.key === "0") this.reset();
      else return;
      event.preventDefault();
    });
  }

  // Two maps beside each other are looked at together; each can be laid over the other.
  link(other) {
    this.linked = other;
    other.linked = this;
    for (const [below, above] of [[this, other], [other, this]])
      below.root.append(below.slider("The other over it", 100, (value) => {
        below.over = (100 - value) / 100;
        below.draw();
        return value === 100 ? "not shown" : value === 0 ? "alone" : `${100 - value}%, dashed and as squares`;
      }));
  }
  // The other as it lies here: at this one's place and scale.
  ghost() {
    const ghost = Object.create(this.linked), middle = this.toMetres({x: this.size.width / 2, y: this.size.height / 2});
    const there = ghost.toUnits(middle.x, middle.y);
    ghost.canvas = this.canvas;
    ghost.scale = this.scale / this.metres.perUnit * ghost.metres.perUnit;
    ghost.x = there.x - this.size.width / 2 / ghost.scale;
    ghost.y = there.y - this.size.height / 2 / ghost.scale;
    ghost.until = this.until;
    ghost.strength = Math.min(1, 2 * this.over);
    ghost.share = this.over;
    ghost.isGhost = true;
    return ghost;
  }
  lead() {
    if (!this.linked?.scale) return;
    const from = this.metres, to = this.linked.metres, middle = this.toMetres({x: this.size.width / 2, y: this.size.height / 2});
    const there = this.linked.toUnits(middle.x, middle.y), {width, height} = this.linked.size;
    this.linked.scale = this.scale / from.perUnit * to.perUnit;
    this.linked.x = there.x - width / 2 / this.linked.scale;
    this.linked.y = there.y - height / 2 / this.linked.scale;
    this.linked.whole = this.whole;
    this.linked.drawAlone();
  }

  // -- Drawing.

  draw() {
    this.lead();
    this.drawAlone();
  }
  drawAlone() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = 0;
      this.paint();
    });
  }

  paint() {
    const {width, height} = this.size, ratio = devicePixelRatio || 1, context = this.canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const lines = this.paintGrid(context, width, height);
    this.strength = Math.min(1, 2 - 2 * this.over);
    this.paintLayers(context, ratio);
    if (this.over > 0) this.ghost().paintLayers(context, ratio);
    context.globalAlpha = 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (this.names.shown) this.paintNames(context, width, height);
    for (const {at, value} of lines) this.haloed(context, `${value} m`, at.x, at.y);
    if (this.until !== null) this.paintRobots(context);
    this.paintScale(context, width, height);
  }

  paintLayers(context, ratio) {
    for (const layer of this.layers) {
      if (!layer.shown || !this.strength) continue;
      for (const shape of this.shapesOf(layer)) this.paintShape(context, shape, ratio);
    }
  }

  inWorld(context, ratio) {
    const s = this.scale * ratio;
    context.setTransform(s, 0, 0, s, -this.x * s, -this.y * s);
  }

  paintShape(context, shape, ratio) {
    if (shape.image) {
      this.inWorld(context, ratio);
      context.imageSmoothingEnabled = false;
      context.globalAlpha = this.isGhost ? this.share : this.strength;  // one that covers all hides what is below
      if (shape.image.complete) context.drawImage(shape.image, shape.x, shape.y, shape.width, shape.height);
      return;
    }
    const looks = looksOf(this.svg, this.looks, shape.tag, shape.classes);
    let path = shape.r ? null : this.pathOf(shape), scale = this.scale;
    if (shape.r) {
      const at = this.toPixels(shape.x, shape.y);
      if (at.x < -20 || at.y < -20 || at.x > this.size.width + 20 || at.y > this.size.height + 20) return;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      path = new Path2D();
      if (this.isGhost) path.rect(at.x - shape.r, at.y - shape.r, 2 * shape.r, 2 * shape.r);
      else path.arc(at.x, at.y, shape.r, 0, 7);
      scale = 1;
    } else {
      this.inWorld(context, ratio);
      if (this.until !== null && shape.times && /^path /.test(shape.classes)) path = this.faintThenPart(context, shape, looks);
    }
    if (looks.fill !== "none" && shape.tag !== "line") {
      context.globalAlpha = looks.fillOpacity * this.strength;
      context.fillStyle = looks.fill;
      context.fill(path);
    }
    if (looks.stroke !== "none") this.stroke(context, path, looks, scale, looks.strokeOpacity);
    context.globalAlpha = 1;
  }
  pathOf(shape, until) {
    if (!shape.isCourse) return shape.path;
    const spare = 10 / this.scale, {width, height} = this.size;
    return courseIn(shape, this.scale, {x0: this.x - spare, y0: this.y - spare, x1: this.x + width / this.scale + spare,
      y1: this.y + height / this.scale + spare}, until);
  }
  stroke(context, path, looks, scale, opacity) {
    context.globalAlpha = opacity * this.strength;
    context.strokeStyle = looks.stroke;
    context.lineWidth = looks.width / scale;
    context.lineJoin = context.lineCap = "round";
    context.setLineDash((this.isGhost ? [7, 5] : looks.dash).map((length) => length / scale));
    for (const part of [path].flat()) context.stroke(part);
    context.setLineDash([]);
  }

  // The whole path faint, and of it what was until the slider's time.
  faintThenPart(context, shape, looks) {
    this.stroke(context, this.pathOf(shape), looks, this.scale, 0.18);
    if (shape.isCourse) return this.pathOf(shape, this.until);
    const part = new Path2D(), at = placeAt(shape, this.until);
    for (let i = 0; i < shape.times.length && shape.times[i] <= this.until; ++i)
      part.lineTo(shape.points[2 * i], shape.points[2 * i + 1]);
    if (at) part.lineTo(at.x, at.y);
    return part;
  }

  paintRobots(context) {
    for (const layer of this.layers) {
      if (!layer.shown) continue;
      for (const shape of layer.shapes) {
        const there = this.timed?.includes(shape) ? placeAt(shape, this.until) : null;
        if (!there) continue;
        const at = this.toPixels(there.x, there.y), looks = looksOf(this.svg, this.looks, shape.tag, shape.classes);
        context.save();
        context.translate(at.x, at.y);
        context.rotate(there.angle);
        context.beginPath();
        context.moveTo(11, 0);
        context.lineTo(-7, 6);
        context.lineTo(-7, -6);
        context.closePath();
        context.fillStyle = looks.stroke;
        context.strokeStyle = this.colour("--paper");
        context.lineWidth = 1.5;
        context.fill();
        context.stroke();
        context.restore();
      }
    }
  }

  colour(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }
  font(px, weight = 400) { return `${weight} ${px}px system-ui, sans-serif`; }

  haloed(context, text, x, y, colour = "--soft", font = this.font(11)) {
    context.font = font;
    context.lineJoin = "round";
    context.lineWidth = 3;
    context.strokeStyle = this.colour("--panel");
    context.strokeText(text, x, y);
    context.fillStyle = this.colour(colour);
    context.fillText(text, x, y);
  }

  // Names beside their landmarks, where they cover none that came before.
  paintNames(context, width, height) {
    context.font = this.font(11.5, 600);
    const taken = [];
    const clear = (box) => taken.every((t) => box.x1 < t.x0 || box.x0 > t.x1 || box.y1 < t.y0 || box.y0 > t.y1);
    for (const layer of this.layers) {
      if (!layer.shown) continue;
      for (const shape of this.shapesOf(layer)) {
        if (!shape.name) continue;
        const at = this.toPixels(shape.x, shape.y);
        if (at.x < 0 || at.y < 0 || at.x > width || at.y > height) continue;
        const long = context.measureText(shape.name).width;
        for (const [dx, dy] of [[7, -8], [7, 8], [-7 - long, -8], [-7 - long, 8]]) {
          const box = {x0: at.x + dx, x1: at.x + dx + long, y0: at.y + dy - 7, y1: at.y + dy + 7};
          if (!clear(box)) continue;
          taken.push(box);
          this.haloed(context, shape.name, box.x0, at.y + dy + 4, "--ink", this.font(11.5, 600));
          break;
        }
      }
    }
  }

  // Lines at round metres; where their numbers go, which lie over all else.
  paintGrid(context, width, height) {
    const step = stepFor(this.scale / this.metres.perUnit, 90), digits = decimals(step), lines = [];
    const low = this.toMetres({x: 0, y: height}), high = this.toMetres({x: width, y: 0});
    const text = (value) => (Math.abs(value) < step / 2 ? 0 : value).toFixed(digits);
    context.strokeStyle = this.colour("--grid");
    context.lineWidth = 1;
    context.beginPath();
    for (let x = Math.ceil(low.x / step) * step; x <= high.x; x += step) {
      const at = Math.round(this.toPixels(this.toUnits(x, 0).x, 0).x) + 0.5;
      context.moveTo(at, 0);
      context.lineTo(at, height);
      lines.push({at: {x: at + 3, y: height - 5}, value: text(x)});
    }
    for (let y = Math.ceil(low.y / step) * step; y <= high.y; y += step) {
      const at = Math.round(this.toPixels(0, this.toUnits(0, y).y).y) + 0.5;
      context.moveTo(0, at);
      context.lineTo(width, at);
      if (at < height - 24 && at > 40) lines.push({at: {x: 5, y: at - 3}, value: text(y)});
    }
    context.stroke();
    return lines;
  }

  paintScale(context, width, height) {
    const perMetre = this.scale / this.metres.perUnit, step = stepFor(perMetre, 70), long = step * perMetre;
    const right = width - 16, y = height - 24, text = `${step.toFixed(decimals(step))} m`;
    context.globalAlpha = 0.85;
    context.fillStyle = this.colour("--paper");
    context.fillRect(right - long - 8, y - 20, long + 16, 30);
    context.globalAlpha = 1;
    context.strokeStyle = context.fillStyle = this.colour("--ink");
    context.lineWidth = 1.6;
    context.beginPath();
    for (const [x0, y0, x1, y1] of [[right - long, y, right, y], [right - long, y - 4, right - long, y + 4], [right, y - 4, right, y + 4]]) {
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
    }
    context.stroke();
    context.font = this.font(11.5);
    context.fillText(text, right - long / 2 - context.measureText(text).width / 2, y - 7);
  }

  // -- What lies under the pointer.

  point(at) {
    if (!at) {
      this.tip.hidden = true;
      this.place.textContent = "";
      return;
    }
    const metres = this.toMetres(at), found = this.nearest(at);
    const digits = Math.min(3, Math.max(1, Math.ceil(Math.log10(this.scale / this.metres.perUnit))));
    this.place.textContent = `x ${metres.x.toFixed(digits)} m, y ${metres.y.toFixed(digits)} m${this.cellAt(at)}`;
    this.tip.hidden = !found;
    if (!found) return;
    this.tip.textContent = found;
    const {width} = this.size, long = this.tip.offsetWidth;
    this.tip.style.left = `${Math.max(4, Math.min(at.x + 14, width - long - 4))}px`;
    this.tip.style.top = `${at.y + 18}px`;
  }

  nearest(at) {
    const reach = 9;
    let best = reach, text = "";
    for (const layer of this.layers) {
      if (!layer.shown) continue;
      for (const shape of this.shapesOf(layer)) {
        if (!shape.tip || shape.r === undefined) continue;
        const there = this.toPixels(shape.x, shape.y), apart = Math.hypot(there.x - at.x, there.y - at.y);
        if (apart < best) [best, text] = [apart, shape.tip];
      }
    }
    if (text) return text;
    for (const layer of this.layers) {
      if (!layer.shown) continue;
      for (const shape of layer.shapes) {
        if (!shape.times) continue;
        const on = this.onPath(shape, at);
        if (on && on.apart < best) [best, text] = [on.apart, `${layer.name}, ${clock(on.time)}: x ${on.x.toFixed(3)} m, y ${on.y.toFixed(3)} m`];
      }
    }
    return text;
  }

  // The place of a path that is nearest to a pixel.
  onPath(shape, at) {
    const {points, times} = shape, x = this.x + at.x / this.scale, y = this.y + at.y / this.scale;
    let best = Infinity, found = null;
    for (let i = 0; i + 1 < times.length; ++i) {
      const ax = points[2 * i], ay = points[2 * i + 1], bx = points[2 * i + 2] - ax, by = points[2 * i + 3] - ay;
      const square = bx * bx + by * by;
      const share = square > 0 ? Math.min(1, Math.max(0, ((x - ax) * bx + (y - ay) * by) / square)) : 0;
      const off = (ax + share * bx - x) ** 2 + (ay + share * by - y) ** 2;
      if (off >= best) continue;
      best = off;
      found = {x: ax + share * bx, y: ay + share * by, time: times[i] + share * (times[i + 1] - times[i])};
    }
    if (!found) return null;
    const metres = this.toMetres(this.toPixels(found.x, found.y));
    return {...metres, time: found.time, apart: Math.sqrt(best) * this.scale};
  }

  // Of a picture of cells: what a cell's colour says.
  cellAt(at) {
    const cells = this.layers.findLast((layer) => layer.shown && layer.shapes[0].image);
    const shape = cells && this.shapesOf(cells)[0];
    const label = cells?.name === "cells" ? this.svg.getAttribute("aria-label") : cells?.name;
    if (!shape) return "";
    if (!shape.pixels) {
      if (!shape.image.complete) return "";
      const canvas = make("canvas", {width: shape.image.width, height: shape.image.height});
      const context = canvas.getContext("2d", {willReadFrequently: true});
      context.drawImage(shape.image, 0, 0);
      shape.pixels = context;
    }
    const column = Math.floor((this.x + at.x / this.scale - shape.x) / shape.width * shape.image.width);
    const row = Math.floor((this.y + at.y / this.scale - shape.y) / shape.height * shape.image.height);
    if (column < 0 || row < 0 || column >= shape.image.width || row >= shape.image.height) return "";
    const [red, green, blue] = shape.pixels.getImageData(column, row, 1, 1).data;
    if (/difference/.test(label)) return differenceOf(red, green, blue);
    if (!/probability|map so far|most likely map/i.test(label)) return "";
    if (red !== blue) return ", nothing known";
    if (!/probability/i.test(label)) return red < 128 ? ", occupied" : ", free";
    const probability = red >= 220 ? (255 - red) / 70 : (1 - red / 220) / 2 + 0.5;
    return `, p(occupied) ${probability.toFixed(2)}`;
  }
}
