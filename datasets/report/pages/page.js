// What a page can do beyond being read. It loads nothing and sends nothing; without it the page is the same to read.
const viewers = new Map();
for (const figure of document.querySelectorAll("figure")) {
  const svg = figure.querySelector(".wide svg") || figure.querySelector("svg");
  if (!svg) continue;
  figure.append(make("p", {class: "save"}, button("SVG", "Save this picture as SVG", () => saveSvg(svg)),
    button("PNG", "Save this picture as PNG", () => savePng(svg))));
  if (svg.hasAttribute("data-panel")) viewers.set(figure, new MapViewer(svg, figure));
}
// In a frame of the page of a job that runs the next map takes this one's place: where one looked is where one looks.
if (window !== window.top) {
  const mark = "cairn ", all = [...viewers.values()];
  if (window.name.startsWith(mark)) {
    const kept = JSON.parse(window.name.slice(mark.length));
    all.forEach((viewer, i) => kept[i] && viewer.look(kept[i]));
  }
  addEventListener("pagehide", () => { window.name = mark + JSON.stringify(all.map((viewer) => viewer.looking())); });
}
for (const pair of document.querySelectorAll(".beside")) {
  const [left, right] = [...pair.children].map((side) => [...side.querySelectorAll("figure")].filter((f) => viewers.has(f)));
  left.forEach((figure, i) => right[i] && viewers.get(figure).link(viewers.get(right[i])));
}
for (const table of document.querySelectorAll("table"))
  table.parentElement.after(make("p", {class: "save"}, button("CSV", "Save this table as CSV", () => saveCsv(table))));
