#include "client/report/html_page.h"

#include <fmt/format.h>

#include "client/picture/class_colours.h"
#include "client/report/cells.h"
#include "common/messages/names.h"

namespace mortise {

namespace {

// "--real: #c62828; ..." on light or dark ground.
std::string class_variables(std::uint32_t ClassColours::*ground) {
  std::string css;
  for (const auto c : {CollisionClass::kReal, CollisionClass::kPotential, CollisionClass::kFake})
    css += fmt::format("--{}: #{:06x}; ", name_of(c), class_colours(c).*ground);
  return css;
}

constexpr char kOnPaper[] =
    R"(@media print { :root { --ink: #000; --dim: #444; --line: #bbb; --page: #fff; --band: #eee; }
  body { margin: 0; max-width: none; font-size: 10pt; } .filters { display: none; }
  .wide, figure { overflow: visible; } .more::before { display: none; }
  .wide > svg { min-width: 0; max-width: none; } table { font-size: 7pt; } #clashes, #pairs { min-width: 0; }
  th, td { padding: .15rem .25rem; } .wide td { overflow-wrap: anywhere; } td.n { white-space: normal; }
  #clashes col:nth-child(1) { width: 4%; }
  #clashes col:nth-child(2), #clashes col:nth-child(6), #clashes col:nth-child(7) { width: 9%; }
  #clashes col:nth-child(3) { width: 19%; } #clashes col:nth-child(4), #clashes col:nth-child(5) { width: 11%; }
  .card { min-width: 0; padding: .3rem .8rem; } h2 + p { break-after: avoid; }
  dl, dt, dd { display: inline; margin: 0; } dt::after { content: ": "; } dd:not(:last-child)::after { content: "; "; }
  summary { display: none; } .wide td:first-child { min-width: 7em; }
  figure > svg { width: 100%; min-width: 0; } .parts { grid-template-columns: 1fr 1fr; }
  th { position: static; } tr { break-inside: avoid; } h2 { break-after: avoid; } }
)";

}  // namespace

std::string page_begin(const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>{0}</title><style>{1}</style></head><body>\n"
      "<main>\n<h1>{0}</h1>\n",
      escaped(title), report_style());
}

// A box whose table is wider than the window says so, and takes the keys that scroll it.
std::string page_end() {
  return R"(</main><script>
const wide = new ResizeObserver(entries => {
  for (const { target: box } of entries) {
    const more = box.scrollWidth > box.clientWidth + 1;
    box.classList.toggle('more', more);
    const said = [['tabindex', '0'], ['aria-label', 'scrolls sideways'], ...(box.tagName === 'FIGURE' ? [] : [['role', 'group']])];
    for (const [name, value] of said) more ? box.setAttribute(name, value) : box.removeAttribute(name);
  }
});
for (const box of document.querySelectorAll('.wide, figure')) wide.observe(box);
addEventListener('beforeprint', () => { for (const d of document.querySelectorAll('details')) d.open = true; });
</script></body></html>
)";
}

std::string report_style() {
  const std::string light = class_variables(&ClassColours::light);
  return ":root { " + light + "} @media (prefers-color-scheme: dark) { :root { " +
         class_variables(&ClassColours::dark) + "} } @media print { :root { " + light + "} }" +
         R"(
:root { --ink: #1d2329; --dim: #5b6670; --line: #d5dbe1; --page: #ffffff; --band: #f4f6f8; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --dim: #9aa6b1; --line: #38424b; --page: #14181c; --band: #1c2228; } }
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--page);
       max-width: 76rem; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
p.dim, .dim { color: var(--dim); }
.cards { display: flex; flex-wrap: wrap; gap: .8rem; }
.card { border: 1px solid var(--line); border-radius: 6px; padding: .6rem 1rem; min-width: 7rem; }
.card b { display: block; font-size: 1.6rem; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .87rem; }
th, td { text-align: left; vertical-align: top; padding: .35rem .55rem;
         border-bottom: 1px solid var(--line); }
th { background: var(--band); position: sticky; top: 0; }
th.n, td.n { text-align: right; } td.n { font-variant-numeric: tabular-nums; white-space: nowrap; }
td { overflow-wrap: break-word; } #clashes td { overflow-wrap: anywhere; }
#clashes { table-layout: fixed; min-width: 58rem; }
#clashes col:nth-child(1) { width: 3rem; } #clashes col:nth-child(2) { width: 7rem; }
#clashes col:nth-child(3) { width: 20%; } #clashes col:nth-child(4) { width: 12%; } #clashes col:nth-child(5) { width: 6.5rem; }
#clashes col:nth-child(6) { width: 5.5rem; } #clashes col:nth-child(7) { width: 6rem; } #clashes svg { width: 100%; max-width: 124px; height: auto; }
#pairs { table-layout: fixed; min-width: 52rem; } #pairs td { overflow-wrap: anywhere; white-space: pre-line; }
#pairs th:nth-child(1) { width: 16%; } #pairs th:nth-child(2) { width: 9%; } #pairs th:nth-child(3) { width: 12%; }
#pairs th:nth-child(4) { width: 11%; } #pairs th:nth-child(5) { width: 13%; } #pairs th:nth-child(6) { width: 7%; }
details { margin-top: .3rem; color: var(--dim); } dl { margin: .3rem 0; } dt { font-weight: 600; } dd { margin: 0 0 .2rem 1rem; }
.real { color: var(--real); } .potential { color: var(--potential); } .fake { color: var(--fake); }
.letter { display: inline-block; width: 1.5em; text-align: center; font-weight: 700;
          border: 1.5px solid currentColor; }
.letter.real { border-radius: 0; } .letter.potential { border-radius: 50%; }
.letter.fake { border-style: dotted; }
.filters { display: flex; flex-wrap: wrap; gap: 1rem; margin: .6rem 0; }
.wide svg text { font: 11px system-ui, sans-serif; fill: var(--ink); }
.wide, figure { overflow-x: auto; }
@media (min-width: 64rem) { .wide:has(> #clashes) { overflow: visible; } }
.more::before { content: "Wider than the window: scroll sideways \2192"; position: sticky; left: 0;
  display: block; width: max-content; max-width: 100%; font-size: .8rem; color: var(--dim); }
.wide > svg { width: 100%; min-width: 50rem; max-width: 1100px; height: auto; }
figure { margin: 1.2rem 0; break-inside: avoid; }
figure > svg, figure > img { box-sizing: border-box; max-width: 100%; height: auto; border: 1px solid var(--line); background: #fff; }
figure > svg { min-width: 36rem; }
figcaption { font-size: .87rem; color: var(--dim); }
.parts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(24rem, 100%), 1fr)); gap: 1rem; }
tr.now td { font-weight: 700; background: var(--band); }
td a { color: inherit; }
)" + kOnPaper;
}

std::string_view filter_script() {
  return R"(<script>
const rows = [...document.querySelectorAll('#clashes tbody tr')];
const boxes = [...document.querySelectorAll('.filters input[type=checkbox]')];
const search = document.getElementById('search'), shown = document.getElementById('shown');
function filter() {
  const on = new Set(boxes.filter(b => b.checked).map(b => b.value));
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const row of rows) {
    const text = row.textContent.toLowerCase();
    const keep = on.has(row.dataset.class) && on.has(row.dataset.status) && words.every(w => text.includes(w));
    row.hidden = !keep;
    count += keep;
  }
  shown.textContent = count + ' of ' + rows.length + ' shown';
}
document.querySelector('.filters').hidden = false;
for (const box of boxes) box.addEventListener('change', filter);
search.addEventListener('input', filter);
filter();
</script>)";
}

}  // namespace mortise
