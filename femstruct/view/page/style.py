"""How the page looks on a screen and on A4."""

from typing import Final

STYLE: Final = """
body { font: 15px/1.45 system-ui, "Noto Sans", sans-serif; margin: 2em auto; max-width: 64em; padding: 0 1em;
  color: #222; }
h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin: 1.6em 0 .3em; border-bottom: 2px solid #222; }
h3 { font-size: 1em; margin: 1em 0 .2em; font-weight: 600; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .92em; }
th, td { padding: .15em .7em; text-align: right; vertical-align: top; border-bottom: 1px solid #ddd; }
th { white-space: pre-line; vertical-align: bottom; } td { white-space: pre; } /* a number is not broken */
.key, .text { text-align: left; } th:first-child, td:first-child { padding-left: 0; }
td.text { white-space: pre-line; min-width: 14em; }
.wide { overflow-x: auto; } figure { margin: 1em 0; } img { max-width: 100%; }
.model img { max-height: 30em; } .paper { display: none; }
figcaption { color: #666; font-size: .9em; }
.severe { color: #b00020; } div.severe, p.severe { border-left: 4px solid #b00020; padding: .1em .8em; }
summary { font-size: 1.1em; font-weight: 600; cursor: pointer; padding: .4em 0; border-top: 1px solid #bbb; }
footer { color: #666; font-size: .85em; margin-top: 2em; }
@page { size: A4; margin: 16mm 14mm 18mm;
  @bottom-right { content: counter(page) " / " counter(pages); font: 8pt sans-serif; } }
@media print {
  body { font-size: 9.5pt; margin: 0; max-width: none; padding: 0; }
  details::details-content { content-visibility: visible; block-size: auto; } /* folds print open */
  summary { display: none; } .paper { display: block; } h2, h3 { break-after: avoid; }
  .wide { overflow: visible; } table { font-size: 8pt; } th, td { padding: .1em .45em; } td.text { min-width: 0; }
  thead { display: table-header-group; } tr { break-inside: avoid; }
  figure { display: inline-block; width: 100%; margin: .5em 0; } img { max-height: 225mm; }
  .model img { max-height: 110mm; }
  .sounds { display: none; }
}
"""
