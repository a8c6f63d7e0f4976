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
  if (shape.points) {
    shape.path = new Path2D();
    for (let i = 0; i < shape.points.length; i += 2) shape.path.lineTo(shape.points[i], shape.points[i + 1]);
    if (shape.tag === "polygon") shape.path.closePath();
  }
  return shape;
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
