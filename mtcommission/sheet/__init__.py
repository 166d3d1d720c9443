"""The commissioning sheet: record -> neutral document -> HTML, PDF.

content.py    the door: a record composed (four pages and an appendix) and printed
              (verdict, responses, loop, measurements; limits, identified, appendix)
document.py   what a document consists of
tables.py     the printing kit: a table is quantities and items
plots.py      curves in SI -> plots; figures.py draws them for print
html.py       document -> one offline page (page.html, page.css, page.js); kit.js draws every plot
what_if.py    what a page lets one try (what_if.html, .css, .js); engine.js runs the loop
pdf.py        document -> PDF (sheet.typ)
"""
