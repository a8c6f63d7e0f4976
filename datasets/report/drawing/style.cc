#include "datasets/report/drawing/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

namespace cairn::datasets::report {
namespace {

struct NamedColour {
  std::string_view name;
  Rgb light, dark;
};

constexpr NamedColour kColours[] = {
    {"paper", kPaper, {18, 24, 31}},
    {"ink", kInk, {228, 234, 240}},
    {"soft", kSoft, {154, 169, 184}},
    {"line", {217, 224, 231}, {44, 57, 69}},
    {"grid", {233, 238, 242}, {32, 43, 53}},
    {"panel", kPaper, {22, 30, 38}},
    {"truth", {133, 147, 161}, {134, 150, 166}},
    {"raw", {194, 154, 12}, {214, 170, 60}},
    {"wall", {210, 96, 26}, {210, 96, 26}},
    {"accent", {31, 111, 181}, {109, 179, 242}},
    {"good", {26, 127, 75}, {95, 208, 154}},
    {"bad", {179, 38, 30}, {255, 138, 128}},
    {"r0", {31, 111, 181}, {109, 179, 242}},
    {"r1", {210, 96, 26}, {242, 151, 90}},
    {"r2", {22, 134, 92}, {85, 199, 154}},
    {"r3", {160, 79, 184}, {207, 147, 230}},
    {"r4", {14, 147, 166}, {79, 201, 218}},
    {"r5", {181, 54, 94}, {242, 127, 163}},
    {"r6", {138, 116, 17}, {209, 185, 74}},
    {"r7", {85, 96, 200}, {154, 164, 255}},
};

// "robot" is the colour of the class r0 to r7 beside it. Of two rows that speak of the same the later wins.
constexpr Look kLooks[] = {
    // The frame of a picture and its words.
    {.name = "tick", .fill = "soft", .font = 11.5},
    {.name = "axis", .fill = "soft"},
    {.name = "heading", .font = 14, .bold = true},
    {.name = "name", .stroke = "panel", .width = 3, .font = 11.5, .bold = true},
    {.name = "strong", .fill = "ink"},
    {.name = "middle", .anchor = "middle"},
    {.name = "end", .anchor = "end"},
    {.name = "panel", .fill = "panel"},
    {.name = "frame", .fill = "none", .stroke = "line", .width = 1},
    {.name = "grid", .stroke = "grid", .width = 1},
    {.name = "scale", .stroke = "ink", .width = 1.6},
    {.name = "swatch", .stroke = "soft", .width = 0.6},
    // Paths.
    {.name = "path", .fill = "none", .stroke = "robot", .stroke_opacity = 0.85, .width = 1.5},
    {.name = "dashed", .dashes = "6 4"},
    {.name = "faint", .stroke_opacity = 0.3, .width = 1},
    {.name = "area", .fill = "robot", .fill_opacity = 0.16},
    {.name = "truth-path", .fill = "none", .stroke = "truth", .stroke_opacity = 0.5, .width = 3.4},
    {.name = "raw-path", .fill = "none", .stroke = "raw", .width = 1.2, .dashes = "6 3"},
    {.name = "path-point", .fill = "robot"},
    {.name = "truth-path-point", .fill = "truth"},
    {.name = "raw-path-point", .fill = "raw"},
    {.name = "start", .fill = "robot", .stroke = "paper", .width = 1.5},
    {.name = "mark", .fill = "robot", .stroke = "paper", .width = 0.7},
    // What lies on a map.
    {.name = "landmark", .fill = "ink", .stroke = "paper", .width = 1},
    {.name = "ellipse",
     .fill = "ink",
     .stroke = "ink",
     .fill_opacity = 0.1,
     .stroke_opacity = 0.6,
     .width = 1},
    {.name = "truth-landmark", .fill = "none", .stroke = "truth", .width = 1.8},
    {.name = "moved", .fill = "none", .stroke = "bad", .width = 1.6, .dashes = "3 3"},
    {.name = "miss", .stroke = "bad", .width = 1.6},
    {.name = "wall", .stroke = "wall", .stroke_opacity = 0.8, .width = 1},
    {.name = "edge", .fill = "none", .stroke = "ink", .width = 2.4},
    {.name = "loop", .fill = "good"},
    {.name = "spurious", .fill = "bad"},
    // Charts.
    {.name = "curve", .fill = "none", .stroke = "accent", .width = 2},
    {.name = "point", .fill = "accent", .stroke = "accent", .width = 1.6},
    {.name = "part", .fill = "paper"},
    {.name = "bar", .fill = "accent", .fill_opacity = 0.8},
    {.name = "interval", .stroke = "robot", .width = 1},
    // Traces.
    {.name = "trace", .fill = "ink", .stroke = "ink", .width = 1},
    {.name = "recorded",
     .fill = "soft",
     .stroke = "soft",
     .fill_opacity = 0.5,
     .stroke_opacity = 0.5,
     .width = 1},
    {.name = "occupied", .width = 2},
    {.name = "sensed", .stroke = "bad", .width = 3.5},
    {.name = "ring", .fill = "none", .stroke = "ink", .width = 1.6},
    {.name = "wrong", .stroke = "bad"},
};

// Does one of the classes say so?
bool IsOf(std::string_view classes, std::string_view name) {
  for (const auto word : classes | std::views::split(' ')) {
    if (std::string_view(word.begin(), word.end()) == name) return true;
  }
  return false;
}

std::string CssColour(std::string_view name) {
  return name == "none" ? "none" : fmt::format("var(--{})", name);
}

std::string Rule(const Look& look) {
  std::string css;
  if (!look.fill.empty()) css += fmt::format(" fill:{};", CssColour(look.fill));
  if (look.fill_opacity) css += fmt::format(" fill-opacity:{};", *look.fill_opacity);
  if (!look.stroke.empty()) css += fmt::format(" stroke:{};", CssColour(look.stroke));
  if (look.stroke_opacity) css += fmt::format(" stroke-opacity:{};", *look.stroke_opacity);
  if (look.width) css += fmt::format(" stroke-width:{}px;", *look.width);
  if (!look.dashes.empty()) css += fmt::format(" stroke-dasharray:{};", look.dashes);
  if (look.font) css += fmt::format(" font-size:{}px;", *look.font);
  if (look.bold) css += " font-weight:600;";
  if (!look.anchor.empty()) css += fmt::format(" text-anchor:{};", look.anchor);
  return fmt::format(".{} {{{} }}\n", look.name, css);
}

}  // namespace

Look LookOf(std::string_view classes) {
  Look all{.name = classes, .width = 1, .font = 12};
  for (const Look& look : kLooks) {
    if (!IsOf(classes, look.name)) continue;
    const auto take = [](const auto& from, auto* to) {
      if (from != std::remove_cvref_t<decltype(from)>{}) *to = from;
    };
    take(look.fill, &all.fill);
    take(look.stroke, &all.stroke);
    take(look.fill_opacity, &all.fill_opacity);
    take(look.stroke_opacity, &all.stroke_opacity);
    take(look.width, &all.width);
    take(look.font, &all.font);
    take(look.dashes, &all.dashes);
    take(look.anchor, &all.anchor);
    take(look.bold, &all.bold);
  }
  return all;
}

std::optional<Rgb> ColourOf(std::string_view name, std::string_view classes) {
  if (name.empty() || name == "none") return std::nullopt;
  for (const NamedColour& colour : kColours) {
    const bool is_robots = colour.name.size() == 2;  // r0 to r7
    if (name == "robot" ? is_robots && IsOf(classes, colour.name) : colour.name == name) return colour.light;
  }
  return kSoft;  // a robot of no colour
}

namespace {

// "--ink:#1c2733; …"
std::string ColoursCss(bool dark) {
  std::string css;
  for (const auto& [name, light, night] : kColours) {
    const Rgb& c = dark ? night : light;
    css += fmt::format(" --{}:#{:02x}{:02x}{:02x};", name, c[0], c[1], c[2]);
  }
  return css;
}

// The table, a line a row.
std::string LooksCss() {
  std::string css =
      "svg text { fill:var(--ink); font-size:12px; } .name { paint-order:stroke; }\n"
      ".path, .truth-path { stroke-linejoin:round; } .edge { stroke-linecap:round; }\n";
  for (const Look& look : kLooks) css += Rule(look);
  for (std::size_t robot = 0; robot < kRobotColours; ++robot)
    css += fmt::format(".r{0} {{ --robot:var(--r{0}); }}\n", robot);
  return css;
}

// Of words and tables on a screen, narrow or wide.
constexpr char kPageRules[] = R"css(* { box-sizing:border-box; }
body { margin:0; background:var(--paper); color:var(--ink);
  font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif; }
main { max-width:1104px; margin:0 auto; padding:34px 32px 60px; }
h1 { font-size:27px; line-height:1.2; margin:0 0 4px; letter-spacing:-.01em; }
h2 { font-size:18px; margin:40px 0 8px; } h3 { font-size:14px; margin:18px 0 4px; }
.lead, figcaption { color:var(--soft); } .lead { margin:0 0 22px; }
.stage { font-size:23px; margin:44px 0 4px; padding-top:14px; border-top:2px solid var(--line); }
.stage small { color:var(--soft); font-size:15px; font-weight:400; } nav { margin:0 0 20px; } nav a { margin-right:18px; }
a { color:var(--accent); } .verdict b { font-weight:600; }
.narrow { display:none; } .narrow > svg { max-width:640px; margin:0 auto; }
figure { margin:0; } figcaption { font-size:13.5px; margin-top:6px; max-width:100ch; }
svg { --robot:var(--soft); display:block; width:100%; height:auto; overflow:visible; }
.tiles { display:grid; grid-template-columns:repeat(auto-fit,minmax(150px,1fr)); gap:12px; margin:0 0 8px; }
.tile { border:1px solid var(--line); border-radius:8px; padding:11px 14px 10px; }
.tile b { display:block; font-size:23px; font-weight:600; line-height:1.25; letter-spacing:-.01em; }
.tile span { color:var(--soft); font-size:13px; } .good b { color:var(--good); } .bad b { color:var(--bad); }
.legend { display:flex; flex-wrap:wrap; gap:4px 20px; margin:0 0 8px; padding:0; list-style:none; font-size:13.5px; }
.legend li { display:flex; align-items:center; gap:7px; } .legend svg { width:26px; height:14px; flex:none; }
table { border-collapse:collapse; font-size:14px; margin:6px 0 0; }
th, td { text-align:right; padding:3px 14px 3px 0; border-bottom:1px solid var(--grid); font-variant-numeric:tabular-nums; }
th { font-weight:500; color:var(--soft); } th:first-child, td:first-child { text-align:left; } td { white-space:nowrap; }
.scroll { overflow-x:auto; } summary { cursor:pointer; color:var(--accent); margin-top:8px; }
pre { background:var(--panel); border:1px solid var(--line); border-radius:8px; padding:12px 14px; overflow-x:auto;
  font:13px/1.45 ui-monospace,"SF Mono",Menlo,Consolas,monospace; }
footer { margin-top:46px; padding-top:10px; border-top:1px solid var(--line); color:var(--soft); font-size:13px; }
)css";
constexpr char kViewerRules[] =
    R"css(.viewer-box { position:relative; max-height:72vh; min-height:240px; width:100%; border:1px solid var(--line);
  border-radius:6px; overflow:hidden; background:var(--panel); }
.viewer canvas { width:100%; height:100%; display:block; cursor:grab; touch-action:none; }
.viewer canvas:active { cursor:grabbing; }
button { font:13px/1 inherit; color:var(--ink); background:var(--paper); border:1px solid var(--line); border-radius:5px;
  padding:6px 9px; min-width:32px; cursor:pointer; } button:hover { border-color:var(--accent); color:var(--accent); }
:focus-visible { outline:2px solid var(--accent); outline-offset:2px; } .viewer canvas:focus-visible { outline-offset:-2px; }
.viewer-tools { position:absolute; top:10px; right:10px; display:flex; gap:6px; }
.viewer-tip { position:absolute; max-width:min(46ch,90%); background:var(--paper); border:1px solid var(--line); border-radius:5px;
  padding:4px 8px; font-size:13px; pointer-events:none; }
.viewer-place { position:absolute; top:10px; left:10px; padding:2px 7px; border-radius:4px; background:var(--paper); opacity:.9;
  font-size:12.5px; color:var(--soft); font-variant-numeric:tabular-nums; pointer-events:none; }
.viewer-place:empty { display:none; }
g.off { display:none; }
.viewer-layers { display:flex; flex-wrap:wrap; gap:2px 18px; list-style:none; margin:0 0 8px; padding:0; font-size:13.5px; }
.viewer-layers label, .viewer-time { display:flex; align-items:center; gap:6px; }
.viewer-time { font-size:13.5px; margin:8px 0 0; gap:2px 12px; flex-wrap:wrap; }
.viewer-time input { flex:1 1 16ch; min-width:0; }
.viewer-time span { min-width:8ch; }
.viewer-time output { min-width:21ch; text-align:right; font-variant-numeric:tabular-nums; } input { accent-color:var(--accent); }
.beside { display:grid; grid-template-columns:minmax(0,1fr) minmax(0,1fr); gap:0 28px; } main:has(.beside) { max-width:1760px; }
.compared td { white-space:normal; text-align:left; vertical-align:top; } .compared th { text-align:left; }
.beside .wide { display:none; } .beside .narrow { display:block; }
.save { display:flex; gap:6px; margin:6px 0 0; } .save button { font-size:12px; padding:4px 8px; color:var(--soft); }
@media screen and (max-width:700px) { .beside { grid-template-columns:minmax(0,1fr); }
.viewer-time output { min-width:0; } }
@media screen { .has-viewer > .wide, .has-viewer > .narrow { display:none; } }
@media print { .viewer, .save { display:none; } }
)css";
constexpr char kNarrowRules[] = R"css(@media screen and (max-width:860px) { main { padding:22px 12px 40px; }
.wide { display:none; } .narrow { display:block; } }
)css";
constexpr char kPrintRules[] =
    R"css(body { font-size:11.5px; } main { max-width:none; padding:0; } h1 { font-size:21px; } h2 { font-size:14px;
  margin:20px 0 6px; break-after:avoid; } .lead { margin-bottom:12px; } table, .legend, figcaption { font-size:11px; }
  .tiles { grid-template-columns:repeat(6,1fr); gap:8px; } .tile { padding:6px 9px; } .tile b { font-size:16px; }
  .tile span { font-size:10.5px; } figure svg { max-height:135mm; } figure, .tiles, tr { break-inside:avoid; }
)css";

}  // namespace

std::string PageCss() {
  return fmt::format(
      "\n:root {{ color-scheme:light dark;{} }}\n@media (prefers-color-scheme:dark) {{ :root {{{} }} "
      "}}\n{}{}{}{}"
      "@media print {{ :root {{ color-scheme:light;{} }}\n{}}}\n",
      ColoursCss(false), ColoursCss(true), kPageRules, LooksCss(), kNarrowRules, kViewerRules,
      ColoursCss(false), kPrintRules);
}

}  // namespace cairn::datasets::report
