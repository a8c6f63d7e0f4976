// Elements of a page, and its pictures and tables as files.
const svgNs = document.createRange().createContextualFragment("<svg/>").firstChild.namespaceURI;
const make = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};
const button = (text, title, act) => {
  const element = make("button", {type: "button", title, "aria-label": title}, text);
  element.addEventListener("click", act);
  return element;
};
const save = (blob, name) => {
  const link = make("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};
const fileName = (element, ending) => {
  const title = element.closest("section")?.querySelector("h2")?.textContent || document.title;
  return title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") + ending;
};

const styled = ["display", "fill", "fill-opacity", "stroke", "stroke-opacity", "stroke-width", "stroke-dasharray",
  "stroke-linejoin", "stroke-linecap", "font-size", "font-weight", "font-family", "text-anchor", "paint-order"];
// A copy that looks the same outside of its page.
const standalone = (svg) => {
  const copy = svg.cloneNode(true);
  const from = [svg, ...svg.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
  from.forEach((element, i) => {
    const looks = getComputedStyle(element);
    for (const name of styled) to[i].setAttribute(name, looks.getPropertyValue(name));
    to[i].removeAttribute("class");
  });
  for (const unseen of copy.querySelectorAll("[data-rounds], g[display=none]")) unseen.remove();
  const [, , width, height] = svg.getAttribute("viewBox").split(" ");
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  copy.style.background = getComputedStyle(document.body).backgroundColor;
  return new Blob([new XMLSerializer().serializeToString(copy)], {type: "image/svg+xml"});
};
const saveSvg = (svg) => save(standalone(svg), fileName(svg, ".svg"));
const savePng = (svg) => {
  const image = new Image(), url = URL.createObjectURL(standalone(svg));
  image.onload = () => {
    const scale = 2, canvas = make("canvas", {width: image.width * scale, height: image.height * scale});
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => save(blob, fileName(svg, ".png")));
    URL.revokeObjectURL(url);
  };
  image.src = url;
};
// A text that a spreadsheet would take for a formula is marked as one that is none.
const plain = (text) => /^[=+@\t\r-]/.test(text) && !/^[+-]?[\d.,]+(e[+-]?\d+)?( ?[%a-z]*)$/i.test(text) ? `'${text}` : text;
const quoted = (text) => /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
const saveCsv = (table) => {
  const lines = [...table.rows].map((row) => [...row.cells].map((cell) => quoted(plain(cell.textContent))).join(","));
  save(new Blob([lines.join("\n") + "\n"], {type: "text/csv"}), fileName(table, ".csv"));
};
