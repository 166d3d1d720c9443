"""Record -> parameters in a control's own names, units and syntax: text only, to be verified.

``write.export_record`` fills in the control's rows, writes them, reads the text back and judges
what it holds in every corner; ``choose`` finds numbers that the control takes and that keep what
the record promises. ``catalogue`` lists the controls; nothing is imported here, so that it can do
so without the libraries of the loop.
"""
