// The report's style sheet: colours by class, for light and dark schemes and for print.
#pragma once

namespace cairn::datasets::report {

inline constexpr char kStyle[] = R"css(
:root { color-scheme: light dark;
  --paper:#fff; --ink:#1c2733; --soft:#5b6b7b; --line:#d9e0e7; --grid:#e9eef2; --panel:#fbfcfd; --plate:#ffffffd9;
  --truth:#8593a1; --raw:#c29a0c; --accent:#1f6fb5; --good:#1a7f4b; --bad:#b3261e;
  --r0:#1f6fb5; --r1:#d2601a; --r2:#16865c; --r3:#a04fb8; --r4:#0e93a6; --r5:#b5365e; --r6:#8a7411; --r7:#5560c8; }
@media (prefers-color-scheme: dark) { :root {
  --paper:#12181f; --ink:#e4eaf0; --soft:#9aa9b8; --line:#2c3945; --grid:#202b35; --panel:#161e26; --plate:#12181fd9;
  --truth:#8696a6; --raw:#d6aa3c; --accent:#6db3f2; --good:#5fd09a; --bad:#ff8a80;
  --r0:#6db3f2; --r1:#f2975a; --r2:#55c79a; --r3:#cf93e6; --r4:#4fc9da; --r5:#f27fa3; --r6:#d1b94a; --r7:#9aa4ff; } }
* { box-sizing:border-box; }
body { margin:0; background:var(--paper); color:var(--ink);
  font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif; }
main { max-width:1104px; margin:0 auto; padding:34px 32px 60px; }
h1 { font-size:27px; line-height:1.2; margin:0 0 4px; letter-spacing:-.01em; }
h2 { font-size:18px; margin:40px 0 8px; } h3 { font-size:14px; margin:18px 0 4px; }
.lead, figcaption { color:var(--soft); } .lead { margin:0 0 22px; }
.stage { font-size:23px; margin:44px 0 4px; padding-top:14px; border-top:2px solid var(--line); }
.stage small { color:var(--soft); font-size:15px; font-weight:400; } nav { margin:0 0 20px; } nav a { margin-right:18px; }
a { color:var(--accent); } .confidence b { font-weight:600; }
.narrow { display:none; } .narrow > svg { max-width:640px; margin:0 auto; }
figure { margin:0; } figcaption { font-size:13.5px; margin-top:6px; max-width:100ch; }
svg { display:block; width:100%; height:auto; overflow:visible; }
.tiles { display:grid; grid-template-columns:repeat(auto-fit,minmax(150px,1fr)); gap:12px; margin:0 0 8px; }
.tile { border:1px solid var(--line); border-radius:8px; padding:11px 14px 10px; }
.tile b { display:block; font-size:23px; font-weight:600; line-height:1.25; letter-spacing:-.01em; }
.tile span { color:var(--soft); font-size:13px; } .good b { color:var(--good); } .bad b { color:var(--bad); }
.legend { display:flex; flex-wrap:wrap; gap:4px 20px; margin:0 0 8px; padding:0; list-style:none; font-size:13.5px; }
.legend li { display:flex; align-items:center; gap:7px; } .legend svg { width:26px; height:14px; flex:none; }
table { border-collapse:collapse; font-size:14px; margin:6px 0 0; }
th, td { text-align:right; padding:3px 14px 3px 0; border-bottom:1px solid var(--grid); font-variant-numeric:tabular-nums; }
th { font-weight:500; color:var(--soft); } th:first-child, td:first-child { text-align:left; }
.scroll { overflow-x:auto; } .scroll img { display:block; background:#fff; } summary { cursor:pointer; color:var(--accent); margin-top:8px; }
pre { background:var(--panel); border:1px solid var(--line); border-radius:8px; padding:12px 14px; overflow-x:auto;
  font:13px/1.45 ui-monospace,"SF Mono",Menlo,Consolas,monospace; }
footer { margin-top:46px; padding-top:10px; border-top:1px solid var(--line); color:var(--soft); font-size:13px; }
svg text { fill:var(--ink); font-size:12px; } .tick { fill:var(--soft) !important; font-size:11.5px !important; }
.axis { fill:var(--soft) !important; } .heading { font-size:14px !important; font-weight:600; }
.middle { text-anchor:middle; } .end { text-anchor:end; } .strong { fill:var(--ink) !important; }
.panel { fill:var(--panel); } .grid { stroke:var(--grid); stroke-width:1; } .plate { fill:var(--plate); }
.frame { fill:none; stroke:var(--line); stroke-width:1; } .scale { stroke:var(--ink); stroke-width:1.6; }
.path { fill:none; stroke:var(--robot); stroke-width:1.5; stroke-linejoin:round; stroke-opacity:.85; }
.path.faint { stroke-width:1; stroke-opacity:.3; } .area { fill:var(--robot); fill-opacity:.16; }
.truth-path { fill:none; stroke:var(--truth); stroke-width:3.4; stroke-opacity:.5; stroke-linejoin:round; }
.landmark { fill:var(--ink); stroke:var(--paper); stroke-width:1; } .spurious { fill:var(--bad); }
.truth-landmark { fill:none; stroke:var(--truth); stroke-width:1.8; } .miss { stroke:var(--bad); stroke-width:1.6; }
.ellipse { fill:var(--ink); fill-opacity:.1; stroke:var(--ink); stroke-opacity:.6; stroke-width:1; }
.name { font-size:11.5px !important; font-weight:600; paint-order:stroke; stroke:var(--panel); stroke-width:3px; }
.start { fill:var(--robot,var(--soft)); stroke:var(--paper); stroke-width:1.5; } .mark { fill:var(--robot); stroke:var(--paper); stroke-width:.7; }
.curve { fill:none; stroke:var(--accent); stroke-width:2; } .point { fill:var(--accent); stroke:var(--accent); stroke-width:1.6; }
.point.part { fill:var(--paper); } .bar { fill:var(--accent); fill-opacity:.8; } .wall { stroke:#d2601a; stroke-width:1; stroke-opacity:.8; }
.edge { fill:none; stroke:var(--ink); stroke-width:2.4; stroke-linecap:round; } .loop { fill:var(--good); }
.truth-path-point { fill:var(--truth); } .path-point { fill:var(--robot); }
.raw-path { fill:none; stroke:var(--raw); stroke-width:1.2; stroke-dasharray:6 3; } .raw-path-point { fill:var(--raw); }
.swatch { stroke:var(--soft); stroke-width:.6; }
.r0{--robot:var(--r0)} .r1{--robot:var(--r1)} .r2{--robot:var(--r2)} .r3{--robot:var(--r3)}
.r4{--robot:var(--r4)} .r5{--robot:var(--r5)} .r6{--robot:var(--r6)} .r7{--robot:var(--r7)}
@media screen and (max-width:860px) { main { padding:22px 12px 40px; } .wide { display:none; } .narrow { display:block; } }
@media print { :root { color-scheme: light;
  --paper:#fff; --ink:#1c2733; --soft:#5b6b7b; --line:#d9e0e7; --grid:#e9eef2; --panel:#fff; --plate:#ffffffd9;
  --truth:#8593a1; --raw:#c29a0c; --accent:#1f6fb5; --good:#1a7f4b; --bad:#b3261e;
  --r0:#1f6fb5; --r1:#d2601a; --r2:#16865c; --r3:#a04fb8; --r4:#0e93a6; --r5:#b5365e; --r6:#8a7411; --r7:#5560c8; }
  body { font-size:11.5px; } main { max-width:none; padding:0; } h1 { font-size:21px; } h2 { font-size:14px;
  margin:20px 0 6px; break-after:avoid; } .lead { margin-bottom:12px; } table, .legend, figcaption { font-size:11px; }
  .tiles { grid-template-columns:repeat(6,1fr); gap:8px; } .tile { padding:6px 9px; } .tile b { font-size:16px; }
  .tile span { font-size:10.5px; } figure svg { max-height:135mm; } figure, .tiles, tr { break-inside:avoid; } }
)css";

}  // namespace cairn::datasets::report
