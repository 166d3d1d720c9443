"""Record -> parameters in a control's own names, units and syntax: text only, to be verified.

``write.export_record`` picks the control, rounds the recommendation to numbers that it takes
(``rounding``), judges exactly these numbers in every corner (``subject``) and writes them down
(``numeric``, ``plc``, ``open_source``; layouts in ``control``). ``catalogue`` lists the controls;
nothing is imported here, so that it can do so without the libraries of the loop.
"""
