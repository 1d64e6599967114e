#include "runner/report/report_style.h"

namespace jnd {

namespace {

// --c0..--c6: the conditions (Okabe and Ito 2008), lighter on dark paper. The figures' classes follow below.
constexpr std::string_view kStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #ffffff; --ink: #1a1a1a; --muted: #595959; --line: #d4d4d4; --grid: #e3e3e3; --band: #f3f3f3;
  --axis: #4d4d4d; --faint: #b5b5b5; --link: #0b57a4; --within: #5c5c5c; --published: #8a5a00;
  --alert-paper: #fff4e5; --alert-line: #c05600; --stripe: #f7f7f7;
  --c0: #0072b2; --c1: #d55e00; --c2: #009e73; --c3: #cc79a7; --c4: #e69f00; --c5: #56b4e9; --c6: #5c5c5c;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --paper: #15181c; --ink: #e8e8e6; --muted: #a9adb3; --line: #3a4048; --grid: #2a2f36; --band: #1f242a;
    --axis: #9aa0a8; --faint: #4f5862; --link: #7db9f5; --within: #b4b8be; --published: #e6b35a;
    --alert-paper: #33240f; --alert-line: #f0a04b; --stripe: #1b1f24;
    --c0: #4aa8e0; --c1: #f2884b; --c2: #33c79b; --c3: #e6a3c8; --c4: #f2b938; --c5: #8fd0f5; --c6: #b4b4b4;
  }
}
* { box-sizing: border-box; }
html { background: var(--paper); }
body {
  margin: 0 auto; padding: 1.5rem clamp(1rem, 3vw, 2.5rem) 3rem; max-width: 66rem;
  background: var(--paper); color: var(--ink);
  font: 16px/1.55 Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif;
  overflow-wrap: break-word;
}
h1, h2, h3, h4 { line-height: 1.25; text-wrap: balance; }
h1 { font-size: 1.7rem; margin: 0.3rem 0 0.4rem; }
h2 { font-size: 1.3rem; margin: 2.6rem 0 0.8rem; padding-bottom: 0.25rem; border-bottom: 2px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.6rem 0 0.5rem; }
p, li, dd { max-width: 48rem; }
a { color: var(--link); }
code, .hash { font-family: "DejaVu Sans Mono", "Liberation Mono", Menlo, Consolas, monospace; font-size: 0.85em; }
.hash { overflow-wrap: anywhere; }
.eyebrow { margin: 0; color: var(--muted); font-size: 0.9rem; }
.kind { display: inline-block; padding: 0 0.5em; border: 1px solid currentColor; border-radius: 0.3em; }
.lead { font-size: 1.05rem; }
.note, figcaption, .footnotes { color: var(--muted); font-size: 0.88rem; }
.skip { position: absolute; left: -999rem; }
.skip:focus { left: 1rem; top: 1rem; padding: 0.5rem 1rem; background: var(--paper); border: 2px solid var(--link); }
.alert { margin: 1.2rem 0; padding: 0.6rem 1.1rem; background: var(--alert-paper); border-left: 5px solid var(--alert-line); }
.alert h2 { border: 0; margin: 0 0 0.2rem; padding: 0; font-size: 1rem; }
.alert ul { margin: 0.2rem 0; padding-left: 1.2rem; font-size: 0.95rem; }
nav ol { columns: 2; column-gap: 2.5rem; padding-left: 1.3rem; margin: 0.5rem 0; font-size: 0.92rem; }
nav h2 { font-size: 1rem; margin: 1.6rem 0 0.2rem; border: 0; padding: 0; }
figure { margin: 1.8rem 0 2.2rem; }
figure svg { display: block; max-width: 100%; height: auto; margin: 0 auto; }
.narrow-only { display: none; }
figcaption { margin: 0.6rem auto 0; max-width: 50rem; }
figcaption strong { color: var(--ink); }
.table { margin: 1.8rem 0; }
summary { font-weight: bold; cursor: pointer; }
summary .note { font-weight: normal; }
summary:focus-visible { outline: 2px solid var(--link); }
details[open] summary { margin-bottom: 0.8rem; }
.scroll { overflow-x: auto; }
.scroll:focus-visible { outline: 2px solid var(--link); }
table { border-collapse: collapse; font-size: 0.86rem; line-height: 1.4; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: bold; font-size: 1rem; padding-bottom: 0.4rem; }
caption .note { display: block; font-weight: normal; max-width: min(48rem, calc(100vw - 2.5rem)); }
th, td { padding: 0.22rem 0.7rem 0.22rem 0; text-align: left; vertical-align: top; }
th:first-child, td:first-child { padding-left: 0.4rem; }
thead th { border-top: 2px solid var(--axis); border-bottom: 1px solid var(--axis); vertical-align: bottom; }
tbody th { font-weight: normal; }
tbody tr:nth-child(even) { background: var(--stripe); }
tbody tr:last-child > * { border-bottom: 2px solid var(--axis); }
.number { text-align: right; white-space: nowrap; }
.wide table { font-size: 0.78rem; }
.wide th, .wide td { padding-right: 0.45rem; }
tbody th, tbody td:not(:last-child) { white-space: nowrap; }
.footnotes { margin: 0.5rem 0 0; padding-left: 1.2rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.25rem 1.2rem; font-size: 0.92rem; }
dt { color: var(--muted); }
dd { margin: 0; }
footer { margin-top: 3rem; padding-top: 0.6rem; border-top: 1px solid var(--line); color: var(--muted); font-size: 0.85rem; }

svg .paper { fill: var(--paper); }
svg .ink { fill: var(--ink); }
svg .muted { fill: var(--muted); }
svg .axis { stroke: var(--axis); }
svg .grid { stroke: var(--grid); }
svg .rule { stroke: var(--axis); }
svg .band { fill: var(--band); }
svg .faint { stroke: var(--faint); }
svg .ink-line { stroke: var(--ink); }
svg .ink-fill { fill: var(--ink); stroke: var(--paper); }
svg .bar { stroke: var(--paper); }
svg .on-bar { fill: #1a1a1a; }
svg .within { stroke: var(--within); }
svg .published { fill: var(--paper); stroke: var(--published); }
svg .f0 { fill: var(--c0); } svg .s0 { stroke: var(--c0); } svg .h0 { fill: var(--paper); stroke: var(--c0); }
svg .f1 { fill: var(--c1); } svg .s1 { stroke: var(--c1); } svg .h1 { fill: var(--paper); stroke: var(--c1); }
svg .f2 { fill: var(--c2); } svg .s2 { stroke: var(--c2); } svg .h2 { fill: var(--paper); stroke: var(--c2); }
svg .f3 { fill: var(--c3); } svg .s3 { stroke: var(--c3); } svg .h3 { fill: var(--paper); stroke: var(--c3); }
svg .f4 { fill: var(--c4); } svg .s4 { stroke: var(--c4); } svg .h4 { fill: var(--paper); stroke: var(--c4); }
svg .f5 { fill: var(--c5); } svg .s5 { stroke: var(--c5); } svg .h5 { fill: var(--paper); stroke: var(--c5); }
svg .f6 { fill: var(--c6); } svg .s6 { stroke: var(--c6); } svg .h6 { fill: var(--paper); stroke: var(--c6); }

@media screen and (max-width: 40rem) {
  nav ol { columns: 1; }
  dl { grid-template-columns: 1fr; }
  .wide-only { display: none; }
  .narrow-only { display: block; }
  /* One that has no form of its own for this width keeps its size, so that it can be read, and is scrolled. */
  .picture { overflow-x: auto; }
  .picture:not(.narrow-only) svg { max-width: none; }
}
@page { margin: 16mm 14mm; }
@media print {
  :root { color-scheme: light; }
  body { max-width: none; padding: 0; font-size: 10pt; line-height: 1.4; }
  h1 { font-size: 16pt; }
  h2 { font-size: 12.5pt; margin-top: 16pt; }
  h2, h3, h4 { break-after: avoid; }
  nav, .skip { display: none; }
  a { color: inherit; text-decoration: none; }
  figure, tr, .alert, .short { break-inside: avoid; }
  tbody tr:nth-child(-n+3) { break-before: avoid; }
  figure { margin: 10pt 0 14pt; }
  figure svg { max-width: min(100%, 150mm); max-height: 210mm; }
  figure:is(#fig-sensitivity, #fig-behaviour) svg { max-width: 100%; }
  figure[id^="fig-slopes"] svg { max-width: 166mm; }
  /* Two of them on a page. */
  figure:is(#fig-jnd, #fig-threshold, #fig-outcome, #fig-time, #fig-combination, #fig-people, #fig-roc) svg,
  figure:is([id^="fig-parameter"], [id^="fig-rating-"]) svg { max-height: 98mm; }
  figcaption, .note, .footnotes { font-size: 8.5pt; }
  thead { display: table-header-group; }
  /* Room for some rows below it, or it goes to the next page with them: break-after does nothing within a table. */
  caption { break-inside: avoid; }
  caption::after { content: ""; display: block; height: 30mm; margin-bottom: -30mm; }
  .scroll { overflow: visible; }
  table { font-size: 8pt; }
  tbody th, tbody td:not(:last-child) { white-space: normal; }
  .wide table { font-size: 6.8pt; }
  .wide th, .wide td { padding-right: 3pt; }
  .widest table { font-size: 5.6pt; }
  .widest th, .widest td { padding-right: 2pt; }
  th, td { padding-top: 1pt; padding-bottom: 1pt; }
  .alert, tbody tr:nth-child(even), .kind { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";

}  // namespace

std::string_view report_style() noexcept {
  return kStyle;
}

}  // namespace jnd
