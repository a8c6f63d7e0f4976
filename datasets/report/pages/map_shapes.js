// What a picture with data-panel and data-metres is made of, to be drawn anew at any scale.
const numbers = (element, name) => (element.getAttribute(name) || "").trim().split(/[\s,]+/).map(Number);

// The looks of a class, as the page's style has them.
const looksOf = (svg, cache, tag, classes) => {
  const key = tag + classes;
  if (!cache.has(key)) {
    const probe = document.createElementNS(svgNs, tag);
    probe.setAttribute("class", classes);
    svg.append(probe);
    const css = getComputedStyle(probe);
    cache.set(key, {
      fill: css.fill, fillOpacity: +css.fillOpacity, stroke: css.stroke, strokeOpacity: +css.strokeOpacity,
      width: parseFloat(css.strokeWidth), dash: css.strokeDasharray === "none" ? [] :
        css.strokeDasharray.split(/[\s,]+/).map(parseFloat)});
    probe.remove();
  }
  return cache.get(key);
};

const pngOf = (base64, then) => {
  const image = new Image();
  image.onload = then;
  image.src = `data:image/png;base64,${base64}`;
  return image;
};

// What the colour of a cell says of a difference of log-likelihoods (cell_picture.h): its root is the share of the full colour.
const differenceOf = (red, green, blue) => {
  const [free, occupied] = [(208 - red) / (208 - 31), (208 - blue) / (208 - 30)];
  if (Math.max(red, green, blue) - Math.min(red, green, blue) < 3) return ", the data do not tell";
  const share = red < blue ? free : occupied, nats = 10 * share ** 2;
  return `, ${red < blue ? "−" : "+"}${nats.toFixed(1)}${share > 0.99 ? " nat or more" : " nat"}`;
};

const readShape = (element) => {
  const shape = {tag: element.tagName, classes: element.getAttribute("class") || "",
    tip: element.querySelector("title")?.textContent || "", name: element.getAttribute("data-name")};
  const number = (name) => +element.getAttribute(name);
  if (shape.tag === "polyline" || shape.tag === "polygon") {
    shape.points = Float64Array.from(numbers(element, "points"));
    if (element.hasAttribute("data-time")) shape.times = Float64Array.from(numbers(element, "data-time"));
  } else if (shape.tag === "line") {
    shape.points = Float64Array.from(["x1", "y1", "x2", "y2"].map(number));
  } else if (shape.tag === "path") {
    shape.path = new Path2D(element.getAttribute("d"));
  } else if (shape.tag === "circle" && !/\bellipse\b/.test(shape.classes)) {
    Object.assign(shape, {x: number("cx"), y: number("cy"), r: number("r")});
  } else if (shape.tag === "circle") {
    shape.path = new Path2D();
    shape.path.arc(number("cx"), number("cy"), number("r"), 0, 7);
  } else if (shape.tag === "ellipse") {
    const [x, y, degrees] = element.getAttribute("transform").match(/-?[\d.]+/g).map(Number);
    shape.path = new Path2D();
    shape.path.ellipse(x, y, number("rx"), number("ry"), degrees * Math.PI / 180, 0, 7);
  } else if (shape.tag === "image") {
    Object.assign(shape, {x: number("x"), y: number("y"), width: number("width"), height: number("height"),
      image: new Image()});
    shape.image.src = element.getAttribute("href");
  } else {
    return null;  // texts are placed anew
  }
  shape.isCourse = shape.tag === "polyline" && shape.points.length > 1000;  // drawn as far as it is seen
  if (shape.points && !shape.isCourse) {
    shape.path = new Path2D();
    for (let i = 0; i < shape.points.length; i += 2) shape.path.lineTo(shape.points[i], shape.points[i + 1]);
    if (shape.tag === "polygon") shape.path.closePath();
  }
  return shape;
};

// Of a course the points that matter: none of the others lies farther off than that from the line through these (Douglas and
// Peucker, on pieces of it, so that it takes no longer than so many passes).
const thinned = (points, off) => {
  const last = points.length / 2 - 1, block = 1024, keep = new Uint8Array(last + 1), kept = [], stack = [];
  for (let from = 0; from < last; from += block) stack.push(from, Math.min(from + block, last));
  while (stack.length > 0) {
    const to = stack.pop(), from = stack.pop();
    keep[from] = keep[to] = 1;
    const ax = points[2 * from], ay = points[2 * from + 1], bx = points[2 * to] - ax, by = points[2 * to + 1] - ay;
    const square = bx * bx + by * by;
    let farthest = off * off, at = -1;
    for (let i = from + 1; i < to; ++i) {
      const dx = points[2 * i] - ax, dy = points[2 * i + 1] - ay;
      const share = square > 0 ? Math.min(1, Math.max(0, (dx * bx + dy * by) / square)) : 0;
      const away = (dx - share * bx) ** 2 + (dy - share * by) ** 2;
      if (away > farthest) [farthest, at] = [away, i];
    }
    if (at >= 0) stack.push(from, at, at, to);
  }
  keep.forEach((is, i) => is && kept.push(i));
  return Int32Array.from(kept);
};

// The same at a scale, to a pixel at most, in pieces with the box that each lies in; made once for scales that differ by less
// than two.
const levelOf = (shape, scale) => {
  const octave = Math.ceil(Math.log2(scale)), {points} = shape, size = 64;
  shape.levels ||= new Map();
  if (shape.levels.has(octave)) return shape.levels.get(octave);
  const kept = thinned(points, 1 / 2 ** octave), pieces = [];
  for (let from = 0; from + 1 < kept.length; from += size) {
    const piece = {from, to: Math.min(from + size, kept.length - 1), x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity};
    for (let i = piece.from; i <= piece.to; ++i) {
      const x = points[2 * kept[i]], y = points[2 * kept[i] + 1];
      piece.x0 = Math.min(piece.x0, x);
      piece.x1 = Math.max(piece.x1, x);
      piece.y0 = Math.min(piece.y0, y);
      piece.y1 = Math.max(piece.y1, y);
    }
    pieces.push(piece);
  }
  shape.levels.set(octave, {kept, pieces});
  return shape.levels.get(octave);
};

// So much of a course as there is to see of it in a box, up to a time: a path for each piece, for one of very many points takes a
// browser far longer than they do.
const courseIn = (shape, scale, box, until = Infinity) => {
  const {kept, pieces} = levelOf(shape, scale), {points, times} = shape, paths = [];
  for (const piece of pieces) {
    if (piece.x1 < box.x0 || piece.x0 > box.x1 || piece.y1 < box.y0 || piece.y0 > box.y1) continue;
    if (until < Infinity && times[kept[piece.from]] > until) break;
    const path = new Path2D();
    for (let i = piece.from; i <= piece.to && !(until < Infinity && times[kept[i]] > until); ++i)
      path.lineTo(points[2 * kept[i]], points[2 * kept[i] + 1]);
    paths.push(path);
  }
  return paths;
};

// Round steps of about `pixels` each.
const stepFor = (perMetre, pixels) => {
  const least = pixels / perMetre, ten = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((m) => m * ten).find((step) => step >= least);
};
const decimals = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
const clock = (s) => `${s.toFixed(1)} s`;

// Where who follows the path is at a time; null before and after it.
const placeAt = (shape, time) => {
  const {times, points} = shape;
  if (time < times[0] || time > times.at(-1)) return null;
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = low + high >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  const share = times[high] > times[low] ? (time - times[low]) / (times[high] - times[low]) : 0;
  return {x: points[2 * low] + share * (points[2 * high] - points[2 * low]),
    y: points[2 * low + 1] + share * (points[2 * high + 1] - points[2 * low + 1]),
    angle: Math.atan2(points[2 * high + 1] - points[2 * low + 1], points[2 * high] - points[2 * low])};
};
