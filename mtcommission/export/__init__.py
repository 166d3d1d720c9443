"""Record -> parameters in a control's own names, units and syntax: text only, to be verified.

``export_record`` picks the control, rounds the recommendation to numbers that it takes
(``rounding``), judges exactly these numbers in every corner (``subject``) and writes them down
(``numeric``, ``plc``, ``open_source``; layouts in ``control``).
"""

from mtcommission.export.write import (
    Export,
    control_keys,
    describe_controls,
    export_record,
    parameter_list,
)

__all__ = ["Export", "control_keys", "describe_controls", "export_record", "parameter_list"]
