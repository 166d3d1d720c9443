# The paper's numbers beside ours: what stands around the rows (paper.ftl).

validate-title = The paper's numbers beside ours
validate-disclaimer = Calculated, not measured.
validate-explained = Nothing unexplained
validate-unexplained = Some rows are out of tolerance
validate-remark = { $source }. Each number and claim stands as printed. Where it is a misprint, the correction is given and judged; where a claim does not hold, the row says what disproves it.
validate-count = { $count } rows: { $agrees } agree, { $corrected } agree with the correction, { $differs } differ with reason, { $out } out of tolerance.
validate-all-rows = The other rows agree as printed: --all shows them here, -o DIR a page.
validate-tested-by = Tolerance or test of { $names }: { $basis }.
validate-part-figures = Figures 4 and 5 again
validate-head-printed = Printed
validate-head-correct = Correct
validate-head-ours = Ours
validate-head-tolerance = Tolerance
validate-head-place = Place
validate-is-agrees = agrees
validate-is-corrected = agrees with the correction
validate-is-differs = differs, with reason
validate-is-out = OUT OF TOLERANCE
validate-told = { $what ->
    [paper] paper
    [correct] correct
   *[ours] ours
}: { $value }
validate-part-plant = Plant (sec. 2)
validate-part-feedback = Feedback control (sec. 3)
validate-part-time = Time-optimal control (sec. 5.1)
validate-part-structure = Structure of the control (sec. 5)
validate-part-bound = Bound on the tower's rate (sec. 5.2)
validate-part-damping = Damping-optimal control (sec. 6)
validate-part-vibration = Vibration (secs. 4 to 6)
validate-part-conclusion = Conclusion (sec. 7)
validate-stage-loops = feedback loops
validate-stage-switches = switches over the force
